//! The design guide: maps of the source's pair, and the regions in which contact is lost.

use crate::Study;
use crate::ask::{Outcome, number};
use crate::documents::{contact, with};
use crate::front::Verdict;
use crate::maps::{Map, Solved, Upwards, spaced};
use crate::page::sig;
use serde_json::{Value, json};

pub(crate) fn write(study: &mut Study) -> Outcome<()> {
    study.page.say("## Design guide: maps\n\nContact in the equations, halves of one body. Contact ratio by face width (50 to 120 mm per half) to the right, one other input upwards; everything else as `examples/contact.json` (800 N·m, 2000 r/min) unless said. Each map is one sweep (`kind: \"sweep\"`, two axes). White dots: the lowest RMS of each row.");
    let base = contact()?;
    torque(study, &base)?;
    speed(study, &base)?;
    relief(study, &base)?;
    stagger(study, &base)?;
    apex(study, &base)
}

/// Columns and rows of maps whose every point has a contact analysis of its own.
const COLUMNS: usize = 24;
const ROWS: usize = 15;
/// Total contact ratio of the example pair.
const EXAMPLE_RATIO: f64 = 3.1424;

/// The tips of both gears relieved by 15 µm.
fn relieved(base: &Value) -> Value {
    let relief = || json!({"amount_um": 15.0, "length_mm": 6.0, "shape": "parabolic"});
    with(base, &[("/design/pinion/tip_relief", relief()), ("/design/gear/tip_relief", relief())])
}

pub(crate) fn map([name, title]: [&'static str; 2], document: Value, columns: usize, upwards: Upwards) -> Map {
    Map { name, title, document, widths_mm: spaced(50.0, 120.0, columns, false), upwards }
}

/// Draws a map and writes the sentences about it.
pub(crate) fn show(study: &mut Study, map: Map) -> Outcome<Solved> {
    let solved = map.solve(study)?;
    eprintln!("{}: {:.1} s", solved.map.name, solved.seconds);
    solved.draw(study);
    let [rms, factor] = [&solved.rms, &solved.factor].map(|table| Solved::extremes(table));
    study.maps.push((solved.map.title.to_owned(), solved.count(), solved.seconds));
    let unsolved = match solved.unsolved() {
        0 => String::new(),
        count => format!(
            " ({count} of them without an answer: their motion was not found within the solver's budget of steps)"
        ),
    };
    study.page.claim(20 * solved.unsolved() < solved.count(), format!(
        "{} operating points{}. RMS {} to {} m/s², dynamic factor {} to {}. The ridge: {}. Contact is not kept in {} points; {} do not repeat every mesh period.",
        solved.count(), unsolved, sig(rms.0, 3), sig(rms.1, 3), sig(factor.0, 3), sig(factor.1, 3), solved.ridge_words(), solved.separated(), solved.other_regimes()
    ));
    Ok(solved)
}

fn torque(study: &mut Study, base: &Value) -> Outcome<()> {
    study.page.say("### Torque");
    let upwards = Upwards {
        pointer: "/operation/pinion_torque_nm",
        also: &[],
        values: spaced(10.0, 4000.0, ROWS, true),
        name: "pinion torque, N·m",
        logarithmic: true,
    };
    let bare = show(study, map(["map_torque", "Torque"], base.clone(), COLUMNS, upwards.clone()))?;
    let quiet =
        show(study, map(["map_torque_relieved", "Torque, tips relieved by 15 µm"], relieved(base), COLUMNS, upwards))?;
    let column = bare.nearest(EXAMPLE_RATIO);
    let last = ROWS - 1;
    let part = |row: usize| quiet.rms[column][row] / bare.rms[column][row];
    let growth = (bare.rms[column][last] / bare.rms[column][0]).ln() / 400f64.ln();
    study.page.claim(
        bare.separated() == 0 && quiet.separated() == 0 && bare.factor_swing() < 0.1 && part(0) > 1.1 && part(last) < 0.9 && (0.8..1.05).contains(&growth),
        format!(
            "**Contact is never lost**, from 10 to 4000 N·m, relieved or not: everything that moves the teeth shrinks with the load (at ε {} the RMS goes with its power of {}), so that the dynamic factor of perfect flanks stays what it is (it moves by {} at most along a column). Relief does not shrink with the load: made for one, it is \
             too much for a lighter one. At ε {} the relieved pair has {} times the RMS of the unrelieved at 10 N·m, and {} of it at 4000 N·m.",
            sig(bare.ratios[column], 3), sig(growth, 2), sig(bare.factor_swing(), 1), sig(bare.ratios[column], 3), sig(part(0), 2), sig(part(last), 2)
        ),
    );
    study.under_contact("A load too small", "never, 10 to 4000 N·m, relieved or not".into(), "no");
    Ok(())
}

fn speed(study: &mut Study, base: &Value) -> Outcome<()> {
    study.page.say("### Speed");
    let upwards = Upwards {
        pointer: "/operation/pinion_speed_rpm",
        also: &[],
        values: spaced(500.0, 8000.0, 61, false),
        name: "pinion speed, r/min",
        logarithmic: false,
    };
    let bare = show(study, map(["map_speed", "Speed"], base.clone(), 41, upwards.clone()))?;
    let quiet = show(study, map(["map_speed_relieved", "Speed, tips relieved by 15 µm"], relieved(base), 41, upwards))?;
    // The transverse contact ratio is the same for all widths: overlap two lies at this total.
    let whole = number(&study.bench.result(base)?, "/geometry/transverse_contact_ratio")? + 2.0;
    let row = |rpm: f64| {
        let distance = |row: &usize| (bare.map.upwards.values[*row] - rpm).abs();
        (0..bare.map.upwards.values.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    };
    let (mut least, mut most) = (f64::INFINITY, 0f64);
    for column in &quiet.ridge()[row(5000.0)..] {
        (least, most) = (least.min(quiet.ratios[*column]), most.max(quiet.ratios[*column]));
    }
    let top = bare.map.upwards.values.len() - 1;
    let fastest = bare.ratios[bare.ridge()[top]];
    let [narrow, valley] = [bare.nearest(EXAMPLE_RATIO), bare.nearest(0.5 * (least + most))];
    let mut second = [0.0; 2];
    for (value, document) in second.iter_mut().zip([base.clone(), relieved(base)]) {
        *value = number(&study.bench.result(&document)?, "/mesh/transmission_error_harmonics_um/1")?;
    }
    let part = |column: usize, rpm: f64| quiet.rms[column][row(rpm)] / bare.rms[column][row(rpm)];
    study.page.claim(
        second[1] > 3.0 * second[0] && least > whole - 0.1 && most < whole + 0.1 && (fastest - whole).abs() < 0.15 && part(narrow, 2000.0) < 0.8 && part(narrow, 7000.0) > 1.2 && part(valley, 7000.0) < 0.8,
        format!(
            "**A best contact ratio appears at high speed, and it is a whole overlap ratio.** Relieved, from 5000 r/min on the lowest vibration lies at ε {} (ε_β = 2 is {}), although faces up to a third wider are in the map; unrelieved the valley is the same at 8000 r/min (ε {}), while at lower speeds the widest face is as good. There the first two orders of the mesh decide, the second on its way through the mesh mode, and both nearly vanish at a whole overlap ratio; at low speed it is the higher orders (the bands that bend with the contact ratio), and a longer contact lowers them one and all. **What relief does depends on the same.** At ε {} it leaves {} of the RMS at 2000 r/min, but makes {} times as much at 7000, because it raises the second harmonic of the transmission error (from {} to {} µm), whose order meets the mesh mode there; at the whole overlap ratio it leaves {} there too.",
            if most - least < 0.005 { sig(least, 3) } else { format!("{} to {}", sig(least, 3), sig(most, 3)) }, sig(whole, 3), sig(fastest, 3),
            sig(bare.ratios[narrow], 3), sig(part(narrow, 2000.0), 2), sig(part(narrow, 7000.0), 2), sig(second[0], 2), sig(second[1], 2), sig(part(valley, 7000.0), 2)
        ),
    );
    study.verdicts.push(Verdict {
        source: "(not asked: high speeds, relieved tips)",
        here: "–".into(),
        holds: "–",
        contact: format!("above 5000 r/min a best contact ratio at ε {}", sig(0.5 * (least + most), 3)),
        survives: "–",
        why: "The first orders of the mesh decide, and they vanish at a whole overlap ratio.",
    });
    Ok(())
}

fn relief(study: &mut Study, base: &Value) -> Outcome<()> {
    study
        .page
        .say("### Tip relief of both gears\n\nParabolic, over 6 mm of roll from the tip, the same on both gears.");
    let none = || json!({"amount_um": 0.0, "length_mm": 6.0, "shape": "parabolic"});
    let document = with(base, &[("/design/pinion/tip_relief", none()), ("/design/gear/tip_relief", none())]);
    let upwards = Upwards {
        pointer: "/design/pinion/tip_relief/amount_um",
        also: &["/design/gear/tip_relief/amount_um"],
        values: spaced(0.0, 28.0, ROWS, false),
        name: "tip relief of both gears, µm",
        logarithmic: false,
    };
    let solved = show(study, map(["map_relief", "Tip relief of both gears"], document, COLUMNS, upwards))?;
    let rows = ROWS;
    let best =
        |column: usize| (0..rows).min_by(|a, b| solved.rms[column][*a].total_cmp(&solved.rms[column][*b])).unwrap_or(0);
    let last = solved.ratios.len() - 1;
    let amount = |column: usize| solved.map.upwards.values[best(column)];
    let part = |column: usize| solved.rms[column][best(column)] / solved.rms[column][0];
    let from = solved.nearest(2.95);
    let (mut least, mut most, mut parts) = (f64::INFINITY, 0f64, (f64::INFINITY, 0f64));
    for column in from..=last {
        (least, most) = (least.min(amount(column)), most.max(amount(column)));
        parts = (parts.0.min(part(column)), parts.1.max(part(column)));
    }
    let mean = number(&study.bench.result(base)?, "/mesh/transmission_error_mean_um")?;
    let far = (from..=last).map(|column| solved.rms[column][rows - 1] / solved.rms[column][best(column)]);
    let far = far.fold(f64::INFINITY, f64::min);
    study.page.claim(
        least > 0.5 * mean && most < 4.0 * mean && parts.1 < 0.95 && far > 1.0,
        format!(
            "There is a best relief: from ε {} on it is {} to {} µm, from about the mean deflection ({} µm) to a few times that, and leaves {} to {} % of the unrelieved RMS at 2000 r/min. Beyond it the teeth lose contact ratio, and the vibration rises again (at 28 µm by a factor of {} or more).",
            sig(solved.ratios[from], 3), sig(least, 2), sig(most, 2), sig(mean, 2), sig(100.0 * parts.0, 2), sig(100.0 * parts.1, 2), sig(far, 2)
        ),
    );
    Ok(())
}

fn stagger(study: &mut Study, base: &Value) -> Outcome<()> {
    study.page.say("### Stagger of the halves\n\nAs a fraction of the transverse pitch.");
    let upwards = Upwards {
        pointer: "/design/half_stagger",
        also: &[],
        values: spaced(0.0, 0.5, ROWS, false),
        name: "half stagger",
        logarithmic: false,
    };
    let solved = show(study, map(["map_stagger", "Stagger of the halves"], base.clone(), COLUMNS, upwards))?;
    let column = solved.nearest(EXAMPLE_RATIO);
    let [rms, axial] = [&solved.rms[column], &solved.axial[column]];
    let half = ROWS - 1;
    let worst = solved.axial.iter().flatten().fold(0f64, |a, b| a.max(*b));
    let plain = solved.axial.iter().map(|column| column[0]).fold(0f64, f64::max);
    study.page.claim(
        rms[half] > 0.5 * rms[0] && rms[half] < rms[0] && axial[half] > 2.0 * axial[0] && worst > 5.0 * plain,
        format!(
            "On one body the halves' odd orders cancel in torsion at half a pitch; the even ones stay (here the fourth and the sixth, near the mesh mode), and with them most of the circumferential RMS: at ε {} {} of {} m/s². What is taken from the torsion shakes the pinion along its axis (there {} m/s² without stagger, {} at half a pitch; over the map up to {} instead of {}). Of the source's free halves each keeps its own vibration, whatever the other does.",
            sig(solved.ratios[column], 3), sig(rms[half], 2), sig(rms[0], 2), sig(axial[0], 2), sig(axial[half], 2), sig(worst, 2), sig(plain, 2)
        ),
    );
    Ok(())
}

/// No map: nothing depends on it.
fn apex(study: &mut Study, base: &Value) -> Outcome<()> {
    study.page.say("### Apex offset\n\nThe halves' apexes do not meet, by so much; with a misalignment of 12 µm in the plane of action, so that the halves differ.");
    let document = with(base, &[("/design/assembly/in_plane_misalignment_um", json!(12.0))]);
    let (mut least, mut most) = (f64::INFINITY, 0f64);
    for offset in [-50.0, -20.0, 0.0, 20.0, 50.0] {
        let result = study.bench.result(&with(&document, &[("/design/assembly/apex_offset_um", json!(offset))]))?;
        let [rms, _] = crate::table3::rms(&result)?;
        (least, most) = (least.min(rms), most.max(rms));
    }
    let split = number(&study.bench.result(base)?, "/mesh/apex_sensitivity/load_split_percent_per_um")?;
    study.page.claim(
        most / least < 1.02,
        format!(
            "Nothing: the pinion floats and moves by the offset instead (from −50 to 50 µm the RMS changes by {} %). Held fast it would take {} % of the load from one half to the other per µm (`mesh.apex_sensitivity`), so that {} µm would leave one half without load at 800 N·m.",
            sig(100.0 * (most / least - 1.0), 1), sig(split, 2), sig(100.0 / split, 2)
        ),
    );
    Ok(())
}
