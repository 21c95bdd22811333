//! Figures like the source's 3 to 10: time histories, phase planes with Poincaré points, spectra.

use crate::Study;
use crate::ask::{Outcome, number};
use crate::documents::{load, on_one_body};
use crate::page::sig;
use crate::source::PRINTED;
use herringbone_tools::plot::{BLUE, Field, ORANGE, Scale, Sheet, Style};
use serde_json::Value;
use std::f64::consts::TAU;

/// The recorded mesh period of one design.
struct History {
    ratio: f64,
    acceleration: Vec<f64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    result: Value,
}

impl History {
    /// Amplitudes of the acceleration at the mesh orders 1 to 20.
    fn orders(&self) -> Vec<(f64, f64)> {
        let count = self.acceleration.len() as f64;
        let amplitude = |order: f64| {
            let (mut a, mut b) = (0.0, 0.0);
            for (index, value) in self.acceleration.iter().enumerate() {
                let angle = TAU * order * index as f64 / count;
                a += value * angle.cos();
                b += value * angle.sin();
            }
            2.0 * a.hypot(b) / count
        };
        (1..=20).map(|order| (f64::from(order), amplitude(f64::from(order)))).collect()
    }
}

pub(crate) fn write(study: &mut Study) -> Outcome<()> {
    study.page.say("## Histories, phase planes, spectra\n\nAs the source's Figures 3 to 10, for the contact ratios it shows, steady state. The motion repeats every mesh period, so two equal periods are drawn and the \
        Poincaré points (once per mesh period, orange) fall on one.");
    for (name, channels, quantity) in [
        ("circumferential", ["a_x_left", "x_left", "v_x_left"], "Mesh circumferential vibration"),
        ("axial", ["a_z_p_left", "z_p_left", "v_z_p_left"], "Pinion axial vibration"),
    ] {
        let mut histories = Vec::new();
        for printed in PRINTED.iter().filter(|printed| printed.rms.is_some()) {
            histories.push(history(study, printed.ratio, &load(printed.document)?, &channels)?);
        }
        draw(study, name, quantity, &histories)?;
        if name == "axial" {
            seventh_order(study)?;
        }
    }
    Ok(())
}

/// The steady motion of a document in displacement, velocity and acceleration, whose channels are in the opposite
/// order.
fn history(study: &mut Study, ratio: f64, document: &Value, channels: &[&str]) -> Outcome<History> {
    let (result, mut series) = study.bench.series(document, channels)?;
    if result["response"]["regime"] != "period-1" {
        return Err("a motion does not repeat every mesh period, as its figure assumes".into());
    }
    let (Some(velocity), Some(displacement), Some(acceleration)) = (series.pop(), series.pop(), series.pop()) else {
        return Err("a series is missing".into());
    };
    Ok(History { ratio, acceleration, displacement, velocity, result })
}

/// The circumferential vibration of the same documents with the contact in the equations, on one body.
pub(crate) fn write_contact(study: &mut Study) -> Outcome<()> {
    let mut histories = Vec::new();
    for printed in PRINTED.iter().filter(|printed| printed.rms.is_some()) {
        let document = on_one_body(&load(printed.document)?);
        histories.push(history(study, printed.ratio, &document, &["a_x_left", "x_left", "v_x_left"])?);
    }
    draw(
        study,
        "circumferential_contact",
        "Mesh circumferential vibration with the contact in the equations",
        &histories,
    )
}

fn draw(study: &mut Study, name: &str, quantity: &str, histories: &[History]) -> Outcome<()> {
    let mut sheet = Sheet::white(900.0, 690.0);
    let period_ms = 1e3 / number(&histories[0].result, "/geometry/mesh_frequency_hz")?;
    let all =
        |values: fn(&History) -> &[f64]| histories.iter().flat_map(move |history| values(history).iter().copied());
    let acceleration = Scale::holding(all(|history| &history.acceleration));
    let velocity = Scale::holding(all(|history| &history.velocity).map(|v| 1e3 * v));
    let spectra: Vec<_> = histories.iter().map(History::orders).collect();
    let spectrum = Scale::holding(spectra.iter().flatten().map(|(_, amplitude)| *amplitude));
    for (column, (history, orders)) in histories.iter().zip(&spectra).enumerate() {
        let left = 62.0 + 288.0 * column as f64;
        let place = |row: f64| [left, 34.0 + 225.0 * row, 215.0, 150.0];
        let count = history.acceleration.len();
        let at = |index: usize| index as f64 / count as f64 * period_ms;
        let time = Field { place: place(0.0), x: Scale::linear(0.0, 2.0 * period_ms), y: acceleration };
        time.axes(
            &mut sheet,
            &format!("ε {:.2}", history.ratio),
            "time, ms",
            if column == 0 { "acceleration, m/s²" } else { "" },
        );
        let twice: Vec<_> = (0..2 * count).map(|index| (at(index), history.acceleration[index % count])).collect();
        time.draw(&mut sheet, &twice, Style { width: 1.2, ..Style::line(BLUE) });

        let middle = history.displacement.iter().sum::<f64>() / count as f64;
        let reach = history.displacement.iter().fold(1e-12, |most: f64, x| most.max((x - middle).abs())) * 1.1e6;
        let phase = Field { place: place(1.0), x: Scale::linear(-reach, reach), y: velocity };
        phase.axes(&mut sheet, "", "displacement about its mean, µm", if column == 0 { "velocity, mm/s" } else { "" });
        let mut orbit: Vec<_> =
            history.displacement.iter().zip(&history.velocity).map(|(x, v)| (1e6 * (x - middle), 1e3 * v)).collect();
        orbit.push(orbit[0]);
        phase.draw(&mut sheet, &orbit, Style { width: 1.2, ..Style::line(BLUE) });
        phase.draw(&mut sheet, &orbit[..1], Style::dots(ORANGE));

        let field = Field { place: place(2.0), x: Scale::linear(0.0, 20.6), y: spectrum };
        field.axes(&mut sheet, "", "mesh order", if column == 0 { "amplitude, m/s²" } else { "" });
        field.bars(&mut sheet, orders, BLUE);
    }
    study.figure(name, sheet, &format!("{quantity}: two mesh periods of the acceleration, phase plane, spectrum."));
    Ok(())
}

/// The mesh mode is met by an order of the mesh at the source's speed.
fn seventh_order(study: &mut Study) -> Outcome<()> {
    let result = study.bench.result(&crate::documents::table1()?)?;
    let mesh = number(&result, "/geometry/mesh_frequency_hz")?;
    let modes = result["response"]["natural_modes"].as_array().ok_or("no modes")?;
    let find = |name: &str| {
        let mode = modes.iter().find(|mode| mode["name"].as_str().is_some_and(|found| found.starts_with(name)));
        mode.map(|mode| number(mode, "/frequency_hz")).transpose()
    };
    let (lateral, torsion) =
        (find("gear lateral mode, meshes in phase")?.unwrap_or(0.0), find("mesh mode")?.unwrap_or(0.0));
    let order = (torsion / mesh).round();
    study.page.claim(
        (lateral / mesh - 1.0).abs() < 0.05 && (torsion / mesh / order - 1.0).abs() < 0.02,
        format!(
            "Two coincidences at this operating point should be known before anything is concluded from it. The mesh frequency ({} Hz) lies on a lateral mode of the gear ({} Hz with the default supports), and its order {order} on the mesh mode \
             ({} Hz): small changes of stiffness, width or speed move both in and out of resonance. The spikes of the acceleration are the impact; between them the mesh mode rings.",
            sig(mesh, 3), sig(lateral, 3), sig(torsion, 3)
        ),
    );
    Ok(())
}
