//! Gear pairs, loads and modifications that the ladder is measured on, with their references.

use herringbone_physics::compliance::BodyHold;
use herringbone_physics::gear::{GearSpec, Pair, PairSpec, ReliefShape, TipRelief};
use serde_json::Value;

/// Reference values of a case.
#[derive(Debug, Clone)]
pub(crate) struct Reference {
    pub tangent_n_per_m: f64,
    pub secant_n_per_m: f64,
    pub first_harmonic_m: f64,
    /// Path of a pair in base pitches and its part of the force.
    pub shares: Vec<(f64, f64)>,
}

/// One pair under one load.
#[derive(Clone)]
pub(crate) struct Case {
    /// The teeth: cases of the same name and hold share their finite elements.
    pub teeth: &'static str,
    pub variant: &'static str,
    pub pair: Pair,
    pub hold: BodyHold,
    pub corner_contact: bool,
    /// Torque of the pinion on one half.
    pub torque_nm: f64,
    /// Stored finite elements of another program; where there are none, `Resolution::Fine` is the reference.
    pub published: Option<Reference>,
}

/// A pair before its modifications. Lengths in mm.
struct Teeth {
    name: &'static str,
    module: f64,
    /// Normal pressure angle and helix angle.
    angles_deg: [f64; 2],
    face_width: f64,
    /// Teeth and bore radius of pinion and gear.
    members: [(u32, f64); 2],
    /// Addendum, dedendum and tip radius of the rack.
    rack: [f64; 3],
}

/// Rack of all pairs but the stub one.
const RACK: [f64; 3] = [1.0, 1.25, 0.38];

/// Modifications of the pinion's loaded flank (and of the gear's tip).
#[derive(Clone, Copy, PartialEq)]
enum Variant {
    Unmodified,
    /// Linear gap over the face width, zero at the end that enters first.
    Slope(f64),
    /// Both tips relieved parabolically from two thirds of the way from pitch point to tip.
    TipRelief(f64),
}

const REFERENCE: Teeth = Teeth {
    name: "helical 29/67, β 30°, b 11 m",
    module: 4.0,
    angles_deg: [20.0, 30.0],
    face_width: 45.0,
    members: [(29, 25.0), (67, 60.0)],
    rack: RACK,
};

/// The source paper's pair: 20° in the transverse section are 18.334° in the normal one.
const SOURCE: Teeth = Teeth {
    name: "source 17/44, β 24°, b 13 m",
    module: 6.0,
    angles_deg: [18.334_317, 24.43],
    face_width: 75.0,
    members: [(17, 25.0), (44, 60.0)],
    rack: RACK,
};

const SPUR: Teeth = Teeth {
    name: "spur 25/75, b 10 m",
    module: 3.0,
    angles_deg: [20.0, 0.0],
    face_width: 30.0,
    members: [(25, 14.0), (75, 50.0)],
    rack: RACK,
};

const STUB: Teeth = Teeth {
    name: "stub 21/33, α 25°, β 15°, b 3 m",
    module: 5.0,
    angles_deg: [25.0, 15.0],
    face_width: 15.0,
    members: [(21, 20.0), (33, 30.0)],
    rack: [0.8, 1.05, 0.3],
};

/// The gear's rim is one and a half normal modules thick below the root circle.
const THIN_RIM: Teeth = Teeth {
    name: "thin rim 24/90, β 25°, b 12 m",
    module: 3.0,
    angles_deg: [20.0, 25.0],
    face_width: 36.0,
    members: [(24, 15.0), (90, 140.7)],
    rack: RACK,
};

/// Place of the source paper's unmodified pair, held at the rim, in [`cases`].
pub(crate) const SOURCE_CASE: usize = 4;

/// All cases.
pub(crate) fn cases() -> Vec<Case> {
    use BodyHold::{Bore, Rim};
    let published = [
        ("unmodified, path only", "nominal_rim_clamped", Rim, Variant::Unmodified),
        ("unmodified", "nominal_ext", Bore, Variant::Unmodified),
        ("tip relief 15 µm, path only", "tip_relief", Bore, Variant::TipRelief(15e-6)),
        ("misaligned 8 µm, path only", "lead_zero_at_mesh_in_end", Bore, Variant::Slope(8e-6)),
    ]
    .map(|(name, stored, hold, variant)| Case {
        teeth: REFERENCE.name,
        variant: name,
        pair: pair(&REFERENCE, variant),
        hold,
        corner_contact: stored == "nominal_ext",
        torque_nm: 250.0,
        published: Some(stored_reference(stored, 250.0)),
    });
    let own = [
        (&SOURCE, 400.0, "misaligned 20 µm", Variant::Slope(20e-6)),
        (&SPUR, 150.0, "tip relief 20 µm", Variant::TipRelief(20e-6)),
        (&STUB, 120.0, "misaligned 10 µm", Variant::Slope(10e-6)),
        (&THIN_RIM, 250.0, "tip relief 15 µm", Variant::TipRelief(15e-6)),
    ]
    .into_iter()
    .flat_map(|(teeth, torque_nm, name, variant)| {
        [("unmodified", Rim, Variant::Unmodified), (name, Rim, variant), ("unmodified", Bore, Variant::Unmodified)].map(
            |(name, hold, variant)| Case {
                teeth: teeth.name,
                variant: name,
                pair: pair(teeth, variant),
                hold,
                corner_contact: true,
                torque_nm,
                published: None,
            },
        )
    });
    published.into_iter().chain(own).collect()
}

fn pair(teeth: &Teeth, variant: Variant) -> Pair {
    let [addendum, dedendum, fillet_radius] = teeth.rack;
    let members = teeth.members.map(|(z, bore_radius)| {
        let bore_radius_m = bore_radius * 1e-3;
        GearSpec { addendum, dedendum, fillet_radius, bore_radius_m, ..GearSpec::plain(z) }
    });
    let angles = teeth.angles_deg.map(f64::to_radians);
    let mut spec = PairSpec::plain(teeth.module * 1e-3, angles, teeth.face_width * 1e-3, members);
    let plain = feasible(&spec);
    match variant {
        Variant::Unmodified => return plain,
        Variant::Slope(amount_m) => spec.pinion.flanks[0].helix_slope_m = amount_m,
        Variant::TipRelief(amount_m) => {
            let relief = |length_m| TipRelief { amount_m, length_m, shape: ReliefShape::Parabolic };
            let pitch = plain.pitch_point_m();
            spec.pinion.flanks[0].tip_relief = relief((plain.pinion.tip_roll_m() - pitch) / 3.0);
            spec.gear.flanks[0].tip_relief = relief((plain.gear.tip_roll_m() - (plain.line_of_action_m - pitch)) / 3.0);
        }
    }
    feasible(&spec)
}

fn feasible(spec: &PairSpec) -> Pair {
    match Pair::new(spec) {
        Ok((pair, _)) => pair,
        Err(reasons) => panic!("the pair cannot run: {reasons:?}"),
    }
}

fn stored_reference(variant: &str, torque_nm: f64) -> Reference {
    let text = include_str!("../../../../tests/data/fe_pair_29_67.json");
    let stored: Value = serde_json::from_str(text).expect("the reference file is JSON");
    let all = stored["cases"].as_array().expect("cases");
    let case = all
        .iter()
        .find(|case| case["variant"] == variant && case["torque_nm"].as_f64() == Some(torque_nm))
        .expect("the stored case");
    let number = |value: &Value| value.as_f64().expect("a number");
    Reference {
        tangent_n_per_m: number(&case["tangent_n_per_m"]),
        secant_n_per_m: number(&case["secant_n_per_m"]),
        first_harmonic_m: number(&case["te_harmonic_1_um"]) * 1e-6,
        shares: case["share"]
            .as_array()
            .expect("shares")
            .iter()
            .map(|entry| (number(&entry[0]), number(&entry[1])))
            .collect(),
    }
}
