//! Speed, torque and backlash, and what no rule reads.

use super::File;
use super::text::Key;
use crate::draft::Draft;
use crate::report::OperatingPoint;
use crate::rexs::Basic;
use crate::unit::clean;

const DEFAULT_SPEED_RPM: f64 = 1000.0;

impl File<'_, '_> {
    pub(super) fn operation(&self, draft: &mut Draft) -> Vec<OperatingPoint> {
        let (speed_pointer, torque_pointer) = ("/operation/pinion_speed_rpm", "/operation/pinion_torque_nm");
        // Of the pinion, or carried from the gear by the tooth ratio.
        let ratio = |draft: &Draft| {
            let teeth = |name: &str| draft.document["design"][name]["teeth"].as_f64().unwrap_or(1.0);
            teeth("gear") / teeth("pinion")
        };
        let of_either = |draft: &mut Draft, pointer: &str, attribute, unit| {
            let of = |draft: &mut Draft, member| {
                let reading = self.read(draft, pointer, &self.of_member(member, attribute, unit), 1.0);
                reading.filter(|reading| reading.value != 0.0)
            };
            of(draft, 0).map(|reading| (reading, false)).or_else(|| of(draft, 1).map(|reading| (reading, true)))
        };
        let carried = "carried to the pinion by the numbers of teeth";
        let speed_rpm = match of_either(draft, speed_pointer, "nnominal", "r/min") {
            Some((reading, of_gear)) => {
                let value = reading.value.abs();
                let value = if of_gear { clean(value * ratio(draft)) } else { value };
                draft.take(speed_pointer, value, &[reading], if of_gear { carried } else { "size" });
                value
            }
            None => {
                draft.assume(speed_pointer, DEFAULT_SPEED_RPM, "no speed in the file");
                draft.warn(
                    "speed-assumed",
                    speed_pointer,
                    format!("is not in the file: {DEFAULT_SPEED_RPM} r/min assumed"),
                );
                DEFAULT_SPEED_RPM
            }
        };
        let factor = if self.mirrored { 2.0 } else { 1.0 };
        let mut why = if self.mirrored { "doubled: the stage is one half".to_owned() } else { String::new() };
        let torque_nm = if let Some(torque_nm) = self.options.torque_nm {
            draft.assume(torque_pointer, torque_nm, "chosen at import");
            Some(torque_nm)
        } else if let Some((reading, of_gear)) = of_either(draft, torque_pointer, "Tnominal", "N m") {
            let value = reading.value.abs() * factor;
            let value = if of_gear { clean(value / ratio(draft)) } else { value };
            if of_gear {
                why = format!("{carried} {why}").trim_end().to_owned();
            }
            draft.take(torque_pointer, value, &[reading], &why);
            Some(value)
        } else {
            let power = self.read(draft, torque_pointer, &Key::of_pair("ZS", "Pnominal", "kW"), 1.0);
            match power.filter(|power| power.value != 0.0) {
                Some(power) => {
                    let value = clean(power.value.abs() * 1e3 * factor / (speed_rpm * std::f64::consts::PI / 30.0));
                    draft.take(torque_pointer, value, &[power], format!("P · 1000/ω {why}").trim_end());
                    Some(value)
                }
                None => {
                    let detail = "neither torque nor power is in the file (ZR[i].Tnominal, ZS.Pnominal): give the torque (torque_nm)";
                    draft.refuse(torque_pointer, "missing", detail);
                    None
                }
            }
        };
        let rotation = "/operation/rotation";
        draft.assume(rotation, "apex_leading", "the sense of rotation is not read from this format");
        draft.warn("rotation-assumed", rotation, "is apex_leading: it does not follow from the file");
        vec![OperatingPoint {
            number: 1,
            load_case: None,
            pinion_speed_rpm: Some(speed_rpm),
            pinion_torque_nm: torque_nm,
            share: None,
            chosen: true,
        }]
    }

    /// The backlash that follows from the allowances of the tooth thickness, as an offer.
    pub(super) fn backlash(&self, draft: &mut Draft, basic: &Basic) {
        let pointer = "/design/backlash_um";
        let mut sum_mm = 0.0;
        let mut first = None;
        for member in [0, 1] {
            let limits = ["As.E", "As.i"].map(|key| self.read(draft, pointer, &self.of_member(member, key, "mm"), 1.0));
            let [Some(upper), Some(lower)] = limits else { return };
            sum_mm += 0.5 * (upper.value + lower.value);
            first.get_or_insert(upper);
        }
        let backlash_um = -sum_mm * basic.pressure_angle_deg.to_radians().cos() * 1e3;
        if let Some(reading) = first.filter(|_| backlash_um > 0.0) {
            let why =
                "mean allowances of the tooth thickness of both gears · cos α_n, without that of the centre distance";
            draft.offer(pointer, &reading, backlash_um, why);
        }
    }

    pub(super) fn left_over(&self, draft: &mut Draft) {
        draft.warn("modifications-not-read", "", "flank modifications are not read from this format");
        for member in [0, 1] {
            let crowning = self.values.number(&self.of_member(member, "crowning", "mm"), 1.0).ok().flatten();
            if let Some(crowning) = crowning.filter(|crowning| crowning.value != 0.0) {
                let amount = format!("{} mm", crowning.value);
                draft.ignore(crowning.from(), "flank modifications are not read from this format", Some(amount));
            }
        }
    }
}
