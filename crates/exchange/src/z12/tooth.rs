//! Tooth height, fillet, bore and material.

use super::{File, MEMBERS};
use crate::draft::{Draft, Reading};
use crate::rexs::Basic;
use crate::unit::clean;
use serde_json::Value;

/// Tip alterations beyond this are placeholders.
const MAX_TIP_ALTERATION: f64 = 0.5;

impl File<'_, '_> {
    /// The tip diameter and the tip alteration that follows from it.
    pub(super) fn tip(&self, draft: &mut Draft, basic: &Basic, member: usize) -> Option<(Reading, f64)> {
        let pointer = format!("/design/{}/tip_alteration", MEMBERS[member]);
        let diameter = self.read(draft, &pointer, &self.of_member(member, "da.nul", "mm"), 1.0)?;
        let addendum = self.read(draft, &pointer, &self.of_member(member, "Tool.RefProfile.haP", ""), 1.0);
        let addendum = addendum.map_or(1.0, |reading| reading.value);
        let height = (diameter.value - basic.reference_mm(member)) / (2.0 * basic.module_mm);
        let alteration = clean(height - basic.profile_shift[member] - addendum);
        Some((diameter, alteration))
    }

    /// Tooth height, fillet and bore.
    pub(super) fn teeth(&self, draft: &mut Draft, basic: &Basic) {
        for (member, name) in MEMBERS.into_iter().enumerate() {
            let tool = self.read(draft, "/design", &self.of_member(member, "Tool.type", ""), 1.0);
            if let Some(tool) = tool.filter(|tool| tool.value != 2.0) {
                let detail = format!("{} is {}: the reference profile is read all the same", tool.from(), tool.value);
                draft.warn("other-tool", &format!("/design/{name}"), detail);
            }
            for (attribute, field, default) in [
                ("Tool.RefProfile.haP", "addendum", 1.0),
                ("Tool.RefProfile.hfP", "dedendum", 1.25),
                ("Tool.RefProfile.rhofP", "fillet_radius", 0.38),
            ] {
                let pointer = format!("/design/{name}/{field}");
                match self.read(draft, &pointer, &self.of_member(member, attribute, ""), 1.0) {
                    Some(reading) => draft.take(&pointer, reading.value, std::slice::from_ref(&reading), ""),
                    None => draft.assume(&pointer, default, "no reference profile in the file"),
                }
            }
            let pointer = format!("/design/{name}/tip_alteration");
            match self.tip(draft, basic, member) {
                Some((diameter, alteration)) if alteration.abs() <= MAX_TIP_ALTERATION => {
                    draft.take(&pointer, alteration, &[diameter], "(d_a − d)/(2 m_n) − x − addendum");
                }
                Some((diameter, _)) => {
                    let amount = format!("{} mm", diameter.value);
                    draft.ignore(diameter.from(), "no tip circle of such a tooth: a placeholder", Some(amount));
                    draft.assume(&pointer, 0.0, "the tip diameter of the file is none");
                }
                None => draft.assume(&pointer, 0.0, "no tip diameter in the file"),
            }
            let pointer = format!("/design/{name}/bore_diameter_mm");
            match self.read(draft, &pointer, &self.of_member(member, "di", "mm"), 1.0).filter(|bore| bore.value > 0.0) {
                Some(bore) => draft.take(&pointer, bore.value, std::slice::from_ref(&bore), ""),
                None => draft.assume(&pointer, Value::Null, "no bore in the file: the service's default"),
            }
        }
    }

    pub(super) fn material(&self, draft: &mut Draft) {
        let fields = [
            ("mat.E", "N/mm2", 1e-3, "youngs_modulus_gpa"),
            ("mat.ny", "", 1.0, "poissons_ratio"),
            ("mat.rho", "kg/m3", 1.0, "density_kg_m3"),
        ];
        for (attribute, unit, factor, field) in fields {
            let shared = format!("/design/material/{field}");
            let readings = [0, 1].map(|member| {
                let reading = self.read(draft, &shared, &self.of_member(member, attribute, unit), factor);
                reading.filter(|reading| reading.value > 0.0)
            });
            match readings {
                [Some(pinion), Some(gear)] if pinion.value == gear.value => {
                    draft.take(&shared, pinion.value, &[pinion.clone(), gear], "");
                }
                readings => {
                    for (reading, name) in readings.into_iter().zip(MEMBERS) {
                        if let Some(reading) = reading {
                            draft.take(&format!("/design/{name}/material/{field}"), reading.value, &[reading], "");
                        }
                    }
                }
            }
        }
    }
}
