//! The source's tables with the contact in the equations: its halves as they are, and halves of one body.

use crate::Study;
use crate::ask::{Outcome, number};
use crate::documents::{contact, load, on_one_body, table1, with_contact, without_corner_contact, without_impact};
use crate::page::sig;
use crate::source::PRINTED;
use crate::table3::rms;
use herringbone_tools::plot::{BLACK, BLUE, Field, GREEN, GREY, ORANGE, Scale, Sheet, Style};
use serde_json::Value;

/// Headline numbers of the result of one document.
#[derive(Clone)]
pub(crate) struct Answer {
    /// RMS accelerations, m/s²: mesh circumferential, pinion axial.
    pub rms: [f64; 2],
    pub factor: f64,
    /// First harmonic of the transmission error, µm.
    pub error_um: f64,
    pub regime: String,
    pub contact: String,
}

impl Answer {
    pub(crate) fn of(result: &Value) -> Outcome<Self> {
        let word = |name: &str| result["response"][name].as_str().unwrap_or_default().to_owned();
        Ok(Self {
            rms: rms(result)?,
            factor: number(result, "/response/dynamic_factor")?,
            error_um: number(result, "/mesh/transmission_error_harmonics_um/0")?,
            regime: word("regime"),
            contact: word("contact"),
        })
    }

    /// Teeth stay in contact, and every mesh period is like the one before.
    pub(crate) fn is_quiet(&self) -> bool {
        self.contact == "continuous" && self.regime == "period-1"
    }
}

/// One document by all models.
pub(crate) struct Models {
    /// The source's: stiffness and impact.
    pub source: Answer,
    /// The source's without its impact.
    pub without_impact: Answer,
    /// Contact in the equations, on the source's halves and supports.
    pub free_halves: Answer,
    /// Contact in the equations, halves of one body.
    pub one_body: Answer,
    /// The same, tip corners that do not touch early or late.
    pub without_corners: Answer,
}

impl Models {
    pub(crate) fn of(study: &mut Study, document: &Value) -> Outcome<Self> {
        let mut ask = |document: &Value| Answer::of(&study.bench.result(document)?);
        let one_body = on_one_body(document);
        Ok(Self {
            source: ask(document)?,
            without_impact: ask(&without_impact(document))?,
            free_halves: ask(&with_contact(document))?,
            one_body: ask(&one_body)?,
            without_corners: ask(&without_corner_contact(&one_body))?,
        })
    }
}

pub(crate) fn write(study: &mut Study) -> Outcome<()> {
    study.page.say("## The same tables with the contact in the equations\n\nThe loaded contact already holds what an impact force describes: tip corners touch before the theoretical start, and the pair takes up its load over the approach. A pulse on top of it counts the entry a second time. \
        `model.mesh_force: \"contact\"`, the service's default, puts that contact into the equations as it is, a force over approach and phase for each half, and no pulse (docs/DESIGN.md). Table 2's impacts are then numbers that are reported, not forces that act.");
    ladder(study)?;
    let mut ours = Vec::new();
    for printed in &PRINTED {
        ours.push(Models::of(study, &load(printed.document)?)?);
    }
    table(study, &ours);
    conclusions(study, &ours);
    figure(study, &ours);
    Ok(())
}

/// Table 1's pair, one step after the other from the source's model to the service's default.
fn ladder(study: &mut Study) -> Outcome<()> {
    let source = table1()?;
    if on_one_body(&source)["design"] != contact()?["design"] || on_one_body(&source)["model"] != contact()?["model"] {
        return Err("examples/contact.json is not Table 1's pair on one body".into());
    }
    let models = Models::of(study, &source)?;
    study.page.say("Table 1's pair (ε 3.14), from the source's model to the default, one step at a time; the last line leaves out what an impact would describe:");
    let row = |name: &str, document: &str, answer: &Answer| {
        vec![name.into(), document.into(), sig(answer.rms[0], 3), sig(answer.rms[1], 3), sig(answer.factor, 3)]
    };
    study.page.table(
        "in the equations | document | mesh circumferential, RMS m/s² | pinion axial, RMS m/s² | dynamic factor",
        &[
            row("stiffness and impact, free halves: the source's", "`examples/table1.json`", &models.source),
            row("stiffness alone, free halves", "the same, `impact.source: \"none\"`", &models.without_impact),
            row("contact, free halves", "`table1.json`, `mesh_force: \"contact\"`", &models.free_halves),
            row("contact, halves of one body: the default", "`examples/contact.json`", &models.one_body),
            row(
                "the same, tip corners do not touch",
                "`contact.json`, `corner_contact: false`",
                &models.without_corners,
            ),
        ],
    );
    let Models { source, without_impact, free_halves, one_body, without_corners } = &models;
    let [pulsed, plain, free, body, cut] =
        [source, without_impact, free_halves, one_body, without_corners].map(|answer| answer.rms[0]);
    study.page.claim(
        pulsed > 5.0 * body && (free / plain - 1.0).abs() < 0.1 && (body / free - 1.0).abs() < 0.4 && cut > 1.1 * body,
        format!(
            "**The pulse was nine tenths of the answer.** Without it the source's equations give {} m/s², the contact in the same equations {}: while the teeth stay together and the load is the one that the stiffness was made for, k(t) f(s) *is* the contact, to {} %. Halves of one body add {} % to the circumferential vibration and take away \
             more than half of the axial one, {} instead of {} m/s²: the free halves' soft axial spring is gone. And the early contact of the corners, which the impact was to describe, does not shake this pair but calms it: without it the RMS is {} m/s² (at other contact ratios more or less, see below).",
            sig(plain, 3), sig(free, 3), sig(100.0 * (free / plain - 1.0).abs(), 1), sig(100.0 * (body / free - 1.0), 2), sig(one_body.rms[1], 2), sig(free_halves.rms[1], 2), sig(cut, 3)
        ),
    );
    Ok(())
}

fn table(study: &mut Study, ours: &[Models]) {
    study.page.say("The documents of Tables 2 and 3 likewise; the source's printed RMS in brackets. *One body*: couplings between the halves from the gear bodies, bearings assumed after the size of the pair (600 N/µm laterally, 200 axially; a result names them in its block `supports`), inertias as printed.");
    let row = |(printed, own): (&crate::source::Printed, &Models)| {
        let [free, body] = [&own.free_halves, &own.one_body];
        vec![
            format!("{:.2}", printed.ratio),
            format!("{} ({})", sig(own.source.rms[0], 3), printed.rms.map_or("–".into(), |rms| sig(rms[0], 3))),
            sig(own.without_impact.rms[0], 3),
            sig(free.rms[0], 3),
            sig(free.rms[1], 3),
            sig(free.factor, 3),
            sig(body.rms[0], 3),
            sig(body.rms[1], 3),
            sig(body.factor, 3),
            sig(own.without_corners.rms[0], 3),
            body.contact.clone(),
        ]
    };
    study.page.say("<!-- headline: table 3, contact -->");
    study.page.table(
        "ε | source's model, circumferential | without impact | contact, free halves: circumferential | axial | dynamic factor | one body: circumferential | axial | dynamic factor | one body without corner contact: circumferential | contact",
        &PRINTED.iter().zip(ours).map(row).collect::<Vec<_>>(),
    );
}

fn conclusions(study: &mut Study, ours: &[Models]) {
    let body = |row: usize| ours[row].one_body.rms;
    let circumferential: Vec<f64> = ours.iter().map(|own| own.one_body.rms[0]).collect();
    let quiet = ours.iter().all(|own| own.one_body.is_quiet() && own.free_halves.is_quiet());
    study.page.claim(
        quiet && body(2)[0] < 0.8 * body(0)[0] && ours.iter().all(|own| own.one_body.error_um <= ours[1].one_body.error_um),
        format!(
            "**What survives.** Vibration falls from 2.72 to 3.30 (printed: by {}; here by {}), the motion repeats every mesh period and the teeth stay together. In between, at 2.91, it is {} m/s²: of the five, that design's transmission error has the largest first harmonic ({} µm).",
            sig(32.7 / 15.8, 2), sig(body(0)[0] / body(2)[0], 2), sig(body(1)[0], 3), sig(ours[1].one_body.error_um, 2)
        ),
    );
    let over: Vec<f64> =
        PRINTED.iter().zip(&circumferential).filter_map(|(row, own)| Some(row.rms?[0] / own)).collect();
    let largest_factor = ours.iter().map(|own| own.one_body.factor).fold(0.0, f64::max);
    let source_factor = ours.iter().map(|own| own.source.factor).fold(f64::INFINITY, f64::min);
    let corners: Vec<f64> = ours.iter().map(|own| own.without_corners.rms[0] / own.one_body.rms[0]).collect();
    let range = |values: &[f64]| values.iter().fold((f64::INFINITY, 0f64), |(a, b), v| (a.min(*v), b.max(*v)));
    let ((least, most), (low, high)) = (range(&over), range(&corners));
    study.page.claim(
        body(4)[0] < body(3)[0] && (0..5).all(|row| PRINTED[row].rms.is_none_or(|rms| (0.2..5.0).contains(&(rms[1] / body(row)[1])))) && least > 1.5 && largest_factor < 1.15 && source_factor > 1.3 && low > 0.5 && high < 2.0,
        format!(
            "**What does not.** At 4.07 nothing rises: {} m/s², the least of all. The printed circumferential levels lie between both: {} to {} times those of the contact, while the source's model gives 1.5 to 4.1 times the printed ones. The printed axial ones (2.07, 1.02, 2.56) are of the size found here ({}, {}, {}), without anything having been done for it. The dynamic factor is {} at most, where the source's model, counting its pulse, has {} or more. \
             Without corner contact the circumferential RMS is {} to {} times as large: what the corners do is now a difference of tens of per cent, in either direction, not a factor of ten.",
            sig(body(4)[0], 3), sig(least, 2), sig(most, 2), sig(body(0)[1], 3), sig(body(2)[1], 3), sig(body(4)[1], 2), sig(largest_factor, 3), sig(source_factor, 2), sig(low, 2), sig(high, 2)
        ),
    );
    study.under_contact("The pairs in mesh", "a number that is reported: no pulse acts".into(), "as a number");
    study.under_contact("The impact falls", "a number that is reported: no pulse acts".into(), "–");
    study.under_contact(
        "Vibration halves",
        format!("falls from {} to {} m/s², linear and periodic", sig(body(0)[0], 3), sig(body(2)[0], 3)),
        "in direction",
    );
    study.under_contact("At 4.07", format!("falls on, to {} m/s², period 1, contact kept", sig(body(4)[0], 3)), "no");
}

fn figure(study: &mut Study, ours: &[Models]) {
    let mut sheet = Sheet::white(860.0, 400.0);
    let x = Scale::linear(2.6, 4.2);
    let level = Field { place: [60.0, 34.0, 350.0, 270.0], x, y: Scale::logarithmic(0.5, 200.0) };
    let factor = Field { place: [490.0, 34.0, 350.0, 270.0], x, y: Scale::linear(1.0, 2.0) };
    level.axes(&mut sheet, "Mesh circumferential RMS", "contact ratio", "m/s²");
    factor.axes(&mut sheet, "Dynamic factor", "contact ratio", "");
    type Curve = (&'static str, fn(&Models) -> &Answer, Style);
    let curves: [Curve; 5] = [
        ("source's model", |own| &own.source, Style::both(BLUE)),
        ("without impact", |own| &own.without_impact, Style::both(GREY).thin()),
        ("contact, free halves", |own| &own.free_halves, Style::both(ORANGE)),
        ("contact, one body", |own| &own.one_body, Style::both(GREEN)),
        ("without corner contact", |own| &own.without_corners, Style::both(GREEN).thin().dashed()),
    ];
    for (index, (name, of, style)) in curves.iter().enumerate() {
        let points = |value: fn(&Answer) -> f64| {
            PRINTED.iter().zip(ours).map(|(row, own)| (row.ratio, value(of(own)))).collect::<Vec<_>>()
        };
        level.draw(&mut sheet, &points(|answer| answer.rms[0]), *style);
        factor.draw(&mut sheet, &points(|answer| answer.factor), *style);
        sheet.key(60.0 + 160.0 * index as f64, 366.0, style, name);
    }
    let printed: Vec<_> = PRINTED.iter().filter_map(|row| Some((row.ratio, row.rms?[0]))).collect();
    let style = Style::both(BLACK).dashed().hollow();
    level.draw(&mut sheet, &printed, style);
    sheet.key(60.0, 388.0, &style, "printed");
    study.figure("contact", sheet, "Circumferential vibration and dynamic factor by each model.");
}
