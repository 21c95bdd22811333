//! The ways of changing the contact ratio of the source's pair.

use crate::Study;
use crate::ask::{Outcome, number};
use crate::documents::with;
use serde_json::{Value, json};

/// One input, or two that are changed together.
pub(crate) struct Way {
    pub name: &'static str,
    pub unit: &'static str,
    /// Range of the input within which a contact ratio is searched, in `unit`.
    range: [f64; 2],
    /// Text with the reason why the largest contact ratios are not reached.
    pub limit: &'static str,
    pub make: fn(&Value, f64) -> Value,
}

pub(crate) const WAYS: [Way; 3] = [
    Way {
        name: "tooth height",
        unit: "m_n",
        range: [0.65, 1.2695],
        limit: "undercut from 1.205, tip beyond the base tangent from 1.27 m_n",
        make: height,
    },
    Way {
        name: "face width",
        unit: "mm",
        range: [40.0, 130.0],
        limit: "",
        make: |base, b| with(base, &[("/design/face_width_mm", json!(b))]),
    },
    Way {
        name: "helix angle",
        unit: "°",
        range: [12.0, 44.0],
        limit: "44°, the steepest tried",
        make: |base, beta| with(base, &[("/design/helix_angle_deg", json!(beta))]),
    },
];

/// Equal addenda of both gears; the dedendum follows where the usual one would leave no clearance.
fn height(base: &Value, addendum: f64) -> Value {
    let dedendum = (addendum + 0.25).max(1.25);
    with(
        base,
        &[
            ("/design/pinion/addendum", json!(addendum)),
            ("/design/gear/addendum", json!(addendum)),
            ("/design/pinion/dedendum", json!(dedendum)),
            ("/design/gear/dedendum", json!(dedendum)),
        ],
    )
}

/// The value with which a way reaches a total contact ratio; none where its range ends before.
pub(crate) fn reach(study: &mut Study, base: &Value, way: &Way, target: f64) -> Outcome<Option<f64>> {
    let mut ratio = |value: f64| -> Outcome<f64> {
        let document = with(&(way.make)(base, value), &[("/kind", json!("mesh"))]);
        Ok(number(&study.bench.result(&document)?, "/geometry/total_contact_ratio")? - target)
    };
    let [mut low, mut high] = way.range;
    let (mut below, mut above) = (ratio(low)?, ratio(high)?);
    if below > 0.0 || above < 0.0 {
        return Ok(None);
    }
    // False position, with the stale end's weight halved.
    for _ in 0..30 {
        let value = (low * above - high * below) / (above - below);
        let miss = ratio(value)?;
        if miss.abs() < 2e-4 {
            return Ok(Some(value));
        }
        if miss < 0.0 {
            (low, below, above) = (value, miss, above / 2.0);
        } else {
            (high, above, below) = (value, miss, below / 2.0);
        }
    }
    Err("a contact ratio was not reached".into())
}
