//! The pairs of a model: stages that make a double-helical pair, and single-helical ones.

use super::model::{Handle, Model};
use super::position::{FacePlace, face};
use super::view::View;
use crate::report::StageKind;
use crate::unit::Quantity;

/// Most cylindrical stages of a model.
pub(super) const MAX_STAGES: usize = 200;
/// Largest difference of the helix angles of two halves, degrees.
const SAME_ANGLE_DEG: f64 = 1e-3;

/// A cylindrical stage with two external gears on shafts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stage {
    pub stage: Handle,
    /// Gear with fewer teeth (gear_1 with equal numbers), and its mate.
    pub pinion: Handle,
    pub wheel: Handle,
    pub pinion_shaft: Handle,
    pub wheel_shaft: Handle,
    pub teeth: [u32; 2],
    module_mm: Option<f64>,
    pressure_angle_deg: Option<f64>,
    /// Helix angle of the pinion, positive for a right hand.
    helix_angle_deg: Option<f64>,
    faces: [Option<FacePlace>; 2],
}

/// One or two stages that a document can be made of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub kind: StageKind,
    /// The stages, that of the left half first.
    pub halves: Vec<Stage>,
}

/// What the stages of a model are.
#[derive(Debug, Default)]
pub(super) struct Stages {
    /// Double-helical pairs first.
    pub candidates: Vec<Candidate>,
    /// Why stages, or two of them, are none.
    pub reasons: Vec<(String, String)>,
}

impl Stage {
    /// Name, teeth, module and helix angle, for people.
    pub(super) fn describe(&self, model: &Model) -> String {
        let mut text = format!("{}, z {}/{}", model.name(self.stage), self.teeth[0], self.teeth[1]);
        if let Some(module_mm) = self.module_mm {
            text.push_str(&format!(", m_n {module_mm} mm"));
        }
        if let Some(angle_deg) = self.helix_angle_deg {
            text.push_str(&format!(", β {}°", angle_deg.abs()));
        }
        text
    }

    /// What the teeth are, as gear engineers say it.
    pub(super) fn kind_of_teeth(&self) -> &'static str {
        if self.helix_angle_deg == Some(0.0) { "spur" } else { "single-helical" }
    }
}

impl Candidate {
    pub(super) fn label(&self, model: &Model) -> String {
        self.halves.iter().map(|half| model.name(half.stage)).collect::<Vec<_>>().join(" + ")
    }

    pub(super) fn ids(&self, model: &Model) -> Vec<i64> {
        self.halves.iter().map(|half| model.id(half.stage)).collect()
    }
}

/// Sorts the stages of a model.
pub(super) fn find(view: &View) -> Stages {
    let model = view.model;
    let mut found = Stages::default();
    let mut stages = Vec::new();
    for stage in model.of_kind("cylindrical_stage") {
        match read(view, stage) {
            Ok(stage) => stages.push(stage),
            Err(reason) => found.reasons.push((model.name(stage), reason)),
        }
    }
    let mut is_half = vec![false; stages.len()];
    let mut doubles = Vec::new();
    for first in 0..stages.len() {
        for second in first + 1..stages.len() {
            match double(model, &stages[first], &stages[second]) {
                Some(Ok(halves)) => {
                    is_half[first] = true;
                    is_half[second] = true;
                    doubles.push(Candidate { kind: StageKind::DoubleHelical, halves });
                }
                Some(Err(reason)) => {
                    let names = [first, second].map(|index| model.name(stages[index].stage));
                    found.reasons.push((names.join(" + "), reason));
                }
                None => {}
            }
        }
    }
    let singles = stages.into_iter().zip(is_half).filter(|(_, is_half)| !is_half);
    let singles = singles.map(|(stage, _)| Candidate { kind: StageKind::SingleHelical, halves: vec![stage] });
    found.candidates = doubles.into_iter().chain(singles).collect();
    found
}

/// Reads a stage, or the reason why it is none of two external gears on shafts.
fn read(view: &View, stage: Handle) -> Result<Stage, String> {
    let model = view.model;
    let planetary = ["assembly", "ordered_assembly"]
        .iter()
        .flat_map(|kind| model.related(kind, stage, "part", "assembly"))
        .any(|parent| model.kind(parent) == "planetary_stage");
    let roles = ["gear_1", "gear_2"].map(|role| model.related("stage", stage, "stage", role).first().copied());
    let [Some(gear_1), Some(gear_2)] = roles else {
        return Err("has no relation \"stage\" to two gears".to_owned());
    };
    if planetary || [gear_1, gear_2].iter().any(|gear| model.kind(*gear) == "ring_gear") {
        return Err(
            "is part of a planetary stage, or has a ring gear: internal and planetary gears are not calculated"
                .to_owned(),
        );
    }
    if let Some(other) = [gear_1, gear_2].into_iter().find(|gear| model.kind(*gear) != "cylindrical_gear") {
        return Err(format!("has {} in it, not two cylindrical gears", model.label(other)));
    }
    if gear_1 == gear_2 {
        return Err(format!("has {} in both places", model.label(gear_1)));
    }
    let teeth = |gear: Handle| match view.number(gear, "number_of_teeth", Quantity::Number) {
        Some(reading) if (1.0..=10_000.0).contains(&reading.value.abs()) && reading.value.fract() == 0.0 => {
            Ok(reading.value.abs() as u32)
        }
        Some(reading) => Err(format!("has {} teeth ({})", reading.value, reading.from())),
        None => Err(match view.reason(gear, "number_of_teeth") {
            Some(reason) => format!("{}.number_of_teeth {reason}", model.label(gear)),
            None => format!("{}.number_of_teeth is missing", model.label(gear)),
        }),
    };
    let shaft = |gear: Handle| {
        model.shaft_of(gear).ok_or_else(|| format!("has {} on no shaft (relation \"assembly\")", model.label(gear)))
    };
    let numbers = [teeth(gear_1)?, teeth(gear_2)?];
    let (pinion, wheel, teeth) = match numbers[1] < numbers[0] {
        true => (gear_2, gear_1, [numbers[1], numbers[0]]),
        false => (gear_1, gear_2, numbers),
    };
    let (pinion_shaft, wheel_shaft) = (shaft(pinion)?, shaft(wheel)?);
    if pinion_shaft == wheel_shaft {
        return Err(format!("has both gears on {}", model.label(pinion_shaft)));
    }
    let angles: Vec<f64> = flanks_of(model, pinion)
        .iter()
        .filter_map(|(_, flank)| view.number(*flank, "normal_pressure_angle", Quantity::Angle))
        .map(|reading| reading.value)
        .collect();
    // Asymmetric teeth are refused with the pair.
    let pressure_angle_deg = angles.first().copied().filter(|first| angles.iter().all(|angle| angle == first));
    Ok(Stage {
        stage,
        pinion,
        wheel,
        pinion_shaft,
        wheel_shaft,
        teeth,
        module_mm: view.number(pinion, "normal_module", Quantity::Length).map(|reading| reading.value),
        pressure_angle_deg,
        helix_angle_deg: view
            .number(pinion, "helix_angle_reference_diameter", Quantity::Angle)
            .map(|reading| reading.value),
        faces: [face(view, pinion, pinion_shaft), face(view, wheel, wheel_shaft)],
    })
}

/// The flanks of a gear, with the side that each is on.
pub(super) fn flanks_of(model: &Model, gear: Handle) -> Vec<(&'static str, Handle)> {
    ["left", "right"]
        .into_iter()
        .filter_map(|side| Some((side, *model.related("flank", gear, "gear", side).first()?)))
        .collect()
}

/// Whether two stages are the halves of a double-helical pair, left half first; `None` for stages that have nothing to
/// do with each other, or the reason why two that have are none.
fn double(model: &Model, first: &Stage, second: &Stage) -> Option<Result<Vec<Stage>, String>> {
    let shared: Vec<Handle> =
        [first.pinion, first.wheel].into_iter().filter(|gear| [second.pinion, second.wheel].contains(gear)).collect();
    if let Some(gear) = shared.first() {
        let alike = first.teeth == second.teeth && (first.pinion == second.pinion || first.wheel == second.wheel);
        return alike.then(|| {
            Err(format!(
                "share {}: the widths of that gear are not those of a half; give each half a gear of its own",
                model.label(*gear)
            ))
        });
    }
    let same_teeth = first.teeth == second.teeth;
    let mut second = second.clone();
    if first.pinion_shaft == second.wheel_shaft && first.wheel_shaft == second.pinion_shaft && same_teeth {
        // Equal numbers of teeth, with the gears named the other way round.
        if first.teeth[0] != first.teeth[1] {
            return None;
        }
        std::mem::swap(&mut second.pinion, &mut second.wheel);
        std::mem::swap(&mut second.pinion_shaft, &mut second.wheel_shaft);
        second.faces.swap(0, 1);
        second.helix_angle_deg = second.helix_angle_deg.map(|angle| -angle);
    }
    if !same_teeth {
        return None;
    }
    if first.pinion_shaft != second.pinion_shaft || first.wheel_shaft != second.wheel_shaft {
        let tied = |one: Handle, other: Handle| {
            one == other || model.connections(one).iter().any(|(_, beyond)| *beyond == other)
        };
        let tied = tied(first.pinion_shaft, second.pinion_shaft) && tied(first.wheel_shaft, second.wheel_shaft);
        return tied.then(|| {
            Err("stand on shafts that are tied by couplings: two components are not merged into one shaft".to_owned())
        });
    }
    let same = |one: Option<f64>, other: Option<f64>| match (one, other) {
        (Some(one), Some(other)) => (one - other).abs() <= 1e-6 * one.abs(),
        _ => true,
    };
    if !same(first.module_mm, second.module_mm) {
        return Some(Err("have different normal modules".to_owned()));
    }
    if !same(first.pressure_angle_deg, second.pressure_angle_deg) {
        return Some(Err("have different pressure angles".to_owned()));
    }
    let (Some(one), Some(other)) = (first.helix_angle_deg, second.helix_angle_deg) else {
        return Some(Err("stand on the same shafts, but the helix angle of one is missing".to_owned()));
    };
    if one == 0.0 || other == 0.0 {
        return Some(Err("are spur gears, without a helix angle: no halves of a double-helical pair".to_owned()));
    }
    if one * other > 0.0 {
        return Some(Err("have equal hands: two helical pairs side by side, not a double-helical one".to_owned()));
    }
    if (one.abs() - other.abs()).abs() > SAME_ANGLE_DEG {
        let detail = format!("have helix angles of different size: {}° and {}°", one.abs(), other.abs());
        return Some(Err(detail));
    }
    let ([Some(one), _], [Some(other), _]) = (&first.faces, &second.faces) else {
        return Some(Err(
            "are alike, but the place of a pinion on its shaft is not known (u_coordinate_on_shaft, face_width)"
                .to_owned(),
        ));
    };
    let (left, right) = if one.middle_mm <= other.middle_mm { (first, &second) } else { (&second, first) };
    let [ends, next] = [left, right].map(|half| half.faces[0].as_ref().map(FacePlace::ends_mm));
    if let ([Some(wheel_left), Some(wheel_right)], Some(ends), Some(next)) =
        ([&left.faces[1], &right.faces[1]], ends, next)
    {
        let wheels = [wheel_left.ends_mm(), wheel_right.ends_mm()];
        let wheel_overlap = wheels[0][1].min(wheels[1][1]) - wheels[0][0].max(wheels[1][0]);
        let overlap = (ends[1] - next[0]).max(wheel_overlap);
        if overlap > 1e-6 {
            return Some(Err(format!("have faces that overlap by {overlap:.3} mm: no halves side by side")));
        }
    }
    Some(Ok(vec![left.clone(), right.clone()]))
}
