//! The source's main claim with the contact in the equations: is there a best contact ratio, and what makes it?

use crate::Study;
use crate::ask::{Outcome, number};
use crate::contact::Answer;
use crate::documents::{contact, table1, with, with_contact, without_corner_contact};
use crate::mechanisms::{Curve, lowest};
use crate::page::sig;
use crate::ways::WAYS;
use herringbone_tools::plot::{BLACK, BLUE, Field, GREEN, GREY, ORANGE, Scale, Sheet, Style};
use serde_json::{Value, json};

/// One way of changing the contact ratio with the contact in the equations.
#[derive(Default)]
struct Curves {
    one_body: Curve,
    free_halves: Curve,
    without_corners: Curve,
    factor: Curve,
    source: Curve,
    /// First harmonic of the transmission error, µm.
    error: Curve,
    /// Largest relative change of the RMS without backlash.
    without_play: f64,
    /// Motions that do not repeat every mesh period or lose contact.
    unquiet: usize,
}

pub(crate) fn write(study: &mut Study) -> Outcome<()> {
    study.page.say("### Is there a best contact ratio?\n\nThe same three ways as above, contact in the equations: halves of one body (`examples/contact.json`), the source's free halves, and one body whose tip corners do not touch.");
    let steps: [Vec<f64>; 3] = [
        (0..=12).map(|step| 0.70 + 0.04 * f64::from(step)).chain([1.2, 1.21, 1.22, 1.24, 1.265]).collect(),
        (0..=35).map(|step| 50.0 + 2.0 * f64::from(step)).collect(),
        (0..=26).map(|step| 14.0 + f64::from(step)).collect(),
    ];
    let [base, source] = [contact()?, table1()?];
    let mut found = Vec::new();
    for (way, values) in WAYS.iter().zip(&steps) {
        let mut curves = Curves::default();
        for (index, value) in values.iter().enumerate() {
            one(study, &(way.make)(&base, *value), &(way.make)(&source, *value), index % 6 == 0, &mut curves)?;
        }
        found.push(curves);
    }
    figure(study, &found);
    let rows: Vec<_> = WAYS
        .iter()
        .zip(&found)
        .map(|(way, curves)| {
            let cell = |curve: &Curve| {
                let ((ratio, value), inside) = lowest(curve);
                let most = curve.iter().map(|point| point.1).fold(0.0, f64::max);
                let end = if inside { "" } else { " (end of the range)" };
                format!("{} m/s² at ε {}{end}; {} at most", sig(value, 3), sig(ratio, 3), sig(most, 3))
            };
            vec![
                way.name.into(),
                cell(&curves.one_body),
                cell(&curves.free_halves),
                cell(&curves.without_corners),
                format!("{:.0e}", curves.without_play).replace('-', "−"),
            ]
        })
        .collect();
    study.page.table("by | lowest RMS, one body | free halves | one body without corner contact | backlash 0: largest relative change", &rows);
    conclusions(study, &found)
}

fn one(study: &mut Study, document: &Value, source: &Value, tight: bool, curves: &mut Curves) -> Outcome<()> {
    let result = study.bench.result(document)?;
    let ratio = number(&result, "/geometry/total_contact_ratio")?;
    let answer = Answer::of(&result)?;
    curves.one_body.push((ratio, answer.rms[0]));
    curves.factor.push((ratio, answer.factor));
    curves.unquiet += usize::from(!answer.is_quiet());
    curves.error.push((ratio, number(&result, "/mesh/transmission_error_harmonics_um/0")?));
    let mut ask = |document: &Value| -> Outcome<f64> { Ok(Answer::of(&study.bench.result(document)?)?.rms[0]) };
    curves.source.push((ratio, ask(source)?));
    curves.free_halves.push((ratio, ask(&with_contact(source))?));
    curves.without_corners.push((ratio, ask(&without_corner_contact(document))?));
    if tight {
        let change = (ask(&with(document, &[("/design/backlash_um", json!(0.0))]))? / answer.rms[0] - 1.0).abs();
        curves.without_play = curves.without_play.max(change);
    }
    Ok(())
}

fn conclusions(study: &mut Study, found: &[Curves]) -> Outcome<()> {
    let [height, width, helix] = [&found[0], &found[1], &found[2]];
    let [((tallest, low), inside), ((widest, wide), _), ((steepest, steep), _)] =
        [height, width, helix].map(|curves| lowest(&curves.one_body));
    let end = |curve: &Curve| curve[curve.len() - 1].1;
    let at = |curve: &Curve, ratio: f64| {
        curve.iter().min_by(|a, b| (a.0 - ratio).abs().total_cmp(&(b.0 - ratio).abs())).map_or(0.0, |point| point.1)
    };
    let unquiet: usize = found.iter().map(|curves| curves.unquiet).sum();
    let play = found.iter().map(|curves| curves.without_play).fold(0.0, f64::max);
    study.page.claim(
        inside && (tallest - 3.30).abs() > 0.1 && widest > 3.6 && unquiet == 0 && play < 1e-6 && end(&height.one_body) < 0.2 * end(&height.source),
        format!(
            "**There are best places, none of them at 3.30, and none by backlash.** By tooth height the lowest RMS is {} m/s² at ε {} ({} at 3.30), by face width {} at ε {}, by helix angle {} at ε {}, the end of the range. Contact is kept and every mesh period is like the one before in all of these; a backlash of 0 changes nothing (largest relative change {}). The rise by undercut \
             that makes the source's model prefer 3.40 ({} m/s² at an addendum of 1.265) is not there: {} m/s². It was the pulse's.",
            sig(low, 3), sig(tallest, 3), sig(at(&height.one_body, 3.30), 2), sig(wide, 3), sig(widest, 3), sig(steep, 3), sig(steepest, 3), format!("{play:.0e}").replace('-', "−"), sig(end(&height.source), 3), sig(end(&height.one_body), 2),
        ),
    );
    // ε_α = 1.497 for all face widths: overlap 2 at a total of 3.497, half way between at 2.997.
    let [at_whole, between] = [3.497, 2.997].map(|ratio| at(&width.error, ratio));
    let factors = |pick: fn(f64, f64) -> f64, from| {
        found.iter().flat_map(|curves| &curves.factor).map(|point| point.1).fold(from, pick)
    };
    let result = study.bench.result(&contact()?)?;
    let mesh = number(&result, "/geometry/mesh_frequency_hz")?;
    let modes = result["response"]["natural_modes"].as_array().ok_or("no modes")?;
    let mode = modes.iter().find(|mode| mode["name"] == "mesh mode, meshes in phase").ok_or("no mesh mode")?;
    let mode = number(mode, "/frequency_hz")?;
    study.page.claim(
        (5.5..7.5).contains(&(mode / mesh)) && at_whole < 0.5 * between && factors(f64::max, 1.0) < 1.15,
        format!(
            "What decides is the transmission error, order by order, and which of its orders meets the mesh mode. Its first harmonic nearly vanishes at a whole overlap ratio ({} µm at ε_β = 2, {} half way to 1), where the dynamic factor, which the low orders make, is least (over all of these {} to {}). The RMS of an acceleration weighs the high orders: at 2000 r/min those from the fourth to the seventh, on which the mesh mode lies ({} Hz, order {}), and which have whole numbers of their own. \
             At other speeds it is another: see the map of speeds.",
            sig(at_whole, 2), sig(between, 2), sig(factors(f64::min, f64::INFINITY), 3), sig(factors(f64::max, 1.0), 3), sig(mode, 3), sig(mode / mesh, 2)
        ),
    );
    study.under_contact(
        "There is a best contact ratio",
        format!(
            "by tooth height {}, by face width {}, by helix none; backlash changes nothing",
            sig(tallest, 3),
            sig(widest, 3)
        ),
        "in other places, for another reason",
    );
    Ok(())
}

fn figure(study: &mut Study, found: &[Curves]) {
    let mut sheet = Sheet::white(900.0, 400.0);
    let styles = [
        Style::line(GREEN),
        Style::line(ORANGE),
        Style::line(GREEN).thin().dashed(),
        Style::line(BLUE).thin(),
        Style::dots(BLACK).hollow(),
    ];
    for (index, (way, curves)) in WAYS.iter().zip(found).enumerate() {
        let field = Field {
            place: [60.0 + 290.0 * index as f64, 34.0, 235.0, 270.0],
            x: Scale::linear(2.5, 4.2),
            y: Scale::logarithmic(1.0, 300.0),
        };
        let name = if index == 0 { "circumferential RMS, m/s²" } else { "" };
        field.axes(&mut sheet, &format!("By {}", way.name), "contact ratio", name);
        for (curve, style) in
            [&curves.one_body, &curves.free_halves, &curves.without_corners, &curves.source].into_iter().zip(styles)
        {
            field.draw(&mut sheet, curve, style);
        }
        field.draw(&mut sheet, &[lowest(&curves.one_body).0], styles[4]);
    }
    let names = [
        "contact, one body",
        "contact, free halves",
        "one body, no corner contact",
        "source's model",
        "lowest, one body",
    ];
    for (index, (name, style)) in names.iter().zip(styles).enumerate() {
        sheet.key(60.0 + 170.0 * index as f64, 374.0, &style, name);
    }
    let note = format!("<tspan fill=\"{GREY}\">Mesh circumferential acceleration, 800 N·m, 2000 r/min.</tspan>");
    sheet.text(60.0, 394.0, "start", 11.0, &note);
    study.figure("best_contact", sheet, "Vibration over the contact ratio with the contact in the equations.");
}
