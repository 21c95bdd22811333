//! Hints for unknown members of a document: the field to use instead of a name or unit from a standard or another
//! program, with the converted value if the document determines it.

use super::schema::field_descriptions;
use super::unit::{Unit, UnitQuantity, with_unit};
use serde_json::Value;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// A member of the document that is not a declared field.
pub(crate) struct Unknown<'a> {
    /// The whole document.
    pub document: &'a Value,
    /// Pointer of the object that has the member.
    pub object: &'a str,
    pub name: &'a str,
    pub value: &'a Value,
    /// Names of the declared fields of the object.
    pub known: &'a [&'static str],
}

/// The hint that follows "is not a field of this object"; `None` if the intended field is uncertain.
pub(crate) fn hint(unknown: &Unknown) -> Option<String> {
    if unknown.name.len() > 60 {
        return None;
    }
    let name = plain(unknown.name);
    let (stem, unit) = split(&name);
    let foreign = ForeignName { unknown, stem, unit };
    foreign.by_meaning().or_else(|| foreign.in_another_unit()).or_else(|| foreign.elsewhere(&name))
}

/// Lower case, with underscores, "center" for "centre": "transverseModule" and "Transverse-Module" become
/// "transverse_module".
fn plain(name: &str) -> String {
    let mut text = String::with_capacity(name.len() + 4);
    for letter in name.chars() {
        if letter.is_uppercase() && text.ends_with(|last: char| last.is_lowercase()) {
            text.push('_');
        }
        match letter {
            '-' | ' ' | '.' => text.push('_'),
            other => text.extend(other.to_lowercase()),
        }
    }
    text.replace("centre", "center")
}

/// A name without the unit at its end, and that unit.
fn split(name: &str) -> (&str, Option<&'static Unit>) {
    let unit = Unit::of_name(name);
    let stem = unit.and_then(|unit| name.strip_suffix(unit.suffix)).unwrap_or(name);
    // "m_n" is a module and "d_m" a diameter.
    if stem.len() > 1 { (stem, unit) } else { (name, None) }
}

/// An unknown name, split into stem and unit.
struct ForeignName<'a> {
    unknown: &'a Unknown<'a>,
    stem: &'a str,
    unit: Option<&'static Unit>,
}

impl ForeignName<'_> {
    /// A number of the document.
    fn number(&self, pointer: &str) -> Option<f64> {
        self.unknown.document.pointer(pointer)?.as_f64()
    }

    /// The unknown member's value in SI. Without a unit in its name it is taken to be in the unit of size `default`
    /// (SI).
    fn si(&self, quantity: UnitQuantity, default: f64) -> Option<f64> {
        let size = match self.unit {
            None => default,
            Some(unit) if unit.quantity == quantity => unit.size,
            Some(_) => return None,
        };
        self.unknown.value.as_f64().map(|value| value * size)
    }

    fn mm(&self) -> Option<f64> {
        Some(self.si(UnitQuantity::Length, 1e-3)? * 1e3)
    }

    fn cos_beta(&self) -> Option<f64> {
        Some(self.number("/design/helix_angle_deg")?.to_radians().cos())
    }

    /// The gear that the member describes, by its object or by its name.
    fn member(&self) -> &'static str {
        let of_gear = self.unknown.object.starts_with("/design/gear") || is_of_gear(self.stem);
        if of_gear { "/design/gear" } else { "/design/pinion" }
    }

    fn of_member(&self, name: &str, default: Option<f64>) -> Option<f64> {
        self.number(&format!("{}/{name}", self.member())).or(default)
    }

    /// Numbers of teeth of pinion and gear.
    fn teeth(&self) -> Option<(f64, f64)> {
        Some((self.number("/design/pinion/teeth")?, self.number("/design/gear/teeth")?))
    }

    /// Reference diameter of the gear that the member describes, mm: d = z m_n / cos β.
    fn reference_diameter(&self) -> Option<f64> {
        Some(self.of_member("teeth", None)? * self.number("/design/normal_module_mm")? / self.cos_beta()?)
    }

    /// Hints for quantities under other names, converted by the formulas of ISO 21771 if they differ from the field's.
    fn by_meaning(&self) -> Option<String> {
        let object = self.unknown.object;
        if object.starts_with("/axes/") {
            return self.of_an_axis();
        }
        let module = |formula: &str, value: Option<f64>| {
            let value = shown(value, "mm");
            Some(format!("the module is that of the normal section, /design/normal_module_mm: {formula}{value}"))
        };
        let value = self.unknown.value.as_f64();
        let stem = self.stem;
        let bare = ["pinion_", "gear_", "wheel_", "input_", "output_"]
            .iter()
            .find_map(|prefix| stem.strip_prefix(prefix))
            .unwrap_or(stem);
        let member = self.member();
        match bare {
            "transverse_module" | "module_transverse" | "mt" | "m_t" => {
                module("m_n = m_t cos β", self.mm().zip(self.cos_beta()).map(|(m, cos)| m * cos))
            }
            "module" | "module_normal" | "mn" | "m_n" | "m" => {
                let normal = shown(self.mm(), "mm");
                let transverse = self.mm().zip(self.cos_beta()).map(|(m, cos)| m * cos);
                module(&format!("the value itself{normal}; from a transverse module m_t, m_n = m_t cos β"), transverse)
            }
            "normal_module" if object != "/design" => module("one for both gears", None),
            "normal_diametral_pitch" | "pnd" | "p_nd" => {
                module("m_n = 25.4 mm / P_nd", value.map(|pitch| 25.4 / pitch))
            }
            "transverse_diametral_pitch" => {
                let transverse = value.zip(self.cos_beta()).map(|(pitch, cos)| 25.4 / pitch * cos);
                module("m_n = 25.4 mm / P_d · cos β", transverse)
            }
            "diametral_pitch" | "dp" | "pd" | "p_d" => {
                let transverse = value.zip(self.cos_beta()).map(|(pitch, cos)| 25.4 / pitch * cos);
                let normal = shown(value.map(|pitch| 25.4 / pitch), "mm");
                let transverse = shown(transverse, "mm");
                module(
                    &format!(
                        "m_n = 25.4 mm / P_nd{normal} from a normal diametral pitch, 25.4 mm / P_d · cos β{transverse} from a transverse one"
                    ),
                    None,
                )
            }
            "normal_pitch" | "normal_circular_pitch" | "circular_pitch" | "pitch" => {
                module("m_n = p_n / π", self.mm().map(|pitch| pitch / PI))
            }
            "transverse_pitch" | "transverse_circular_pitch" => {
                module("m_n = p_t cos β / π", self.mm().zip(self.cos_beta()).map(|(pitch, cos)| pitch * cos / PI))
            }
            "ratio" | "gear_ratio" | "transmission_ratio" | "speed_ratio" | "teeth_ratio" | "i" | "u" => {
                let now = self.teeth().map(|(z1, z2)| format!(", here {z2}/{z1}{}", shown(Some(z2 / z1), "")));
                let now = now.unwrap_or_default();
                Some(format!(
                    "the ratio follows from the numbers of teeth, /design/gear/teeth over /design/pinion/teeth{now}"
                ))
            }
            "teeth" | "z" | "number_of_teeth" | "no_of_teeth" | "num_teeth" | "tooth_count" | "tooth_number"
            | "n_teeth" => match object {
                "/design/pinion" | "/design/gear" => Some("the number of teeth is \"teeth\"".to_owned()),
                _ => Some("the numbers of teeth are /design/pinion/teeth and /design/gear/teeth".to_owned()),
            },
            "z1" => Some("the pinion's number of teeth is /design/pinion/teeth".to_owned()),
            "z2" => Some("the gear's number of teeth is /design/gear/teeth".to_owned()),
            "normal_pressure_angle" | "transverse_pressure_angle" | "alpha" | "alpha_n" | "alpha_t" => {
                let plane = match bare {
                    "normal_pressure_angle" | "alpha_n" => " with /design/pressure_angle_plane \"normal\"",
                    "alpha" => "",
                    _ => " with /design/pressure_angle_plane \"transverse\"",
                };
                Some(format!("the pressure angle is /design/pressure_angle_deg{plane}{}", self.in_degrees()))
            }
            "beta" | "helix" | "helix_angle" if !self.is_known("helix_angle_deg") || bare != "helix_angle" => {
                Some(format!("the helix angle at the reference circle is /design/helix_angle_deg{}", self.in_degrees()))
            }
            "base_helix_angle" | "beta_b" => Some(format!(
                "the helix angle is that at the reference circle, /design/helix_angle_deg: sin β = sin β_b / cos α_n{}",
                shown(self.helix_from_base(), "deg")
            )),
            "hand" | "helix_hand" | "helix_direction" | "hand_of_helix" => {
                Some(format!("the hand is {member}/left_half_hand, that of the left half"))
            }
            "total_face_width" | "face_width_total" | "overall_face_width" | "full_face_width" | "total_width"
            | "overall_width" => {
                let gap = self.number("/design/gap_width_mm").unwrap_or(30.0);
                let half = self.mm().map(|total| (total - gap) / 2.0).filter(|half| *half > 0.0);
                Some(format!(
                    "the face width is that of one half, /design/face_width_mm: (total width − gap_width_mm) / 2{}",
                    shown(half, "mm")
                ))
            }
            "width" | "b" | "tooth_width" | "half_width" => {
                Some("the face width is /design/face_width_mm, of one half".to_owned())
            }
            "center_distance" | "working_center_distance" | "axis_distance" | "shaft_distance" | "a" | "aw" | "a_w"
                if self.unit.is_none_or(|unit| unit.text == "mm") =>
            {
                Some("the centre distance is /design/center_distance_mm".to_owned())
            }
            "gap" | "groove" | "groove_width" => {
                Some("the width between the halves is /design/gap_width_mm".to_owned())
            }
            "normal_backlash" | "circumferential_backlash" | "transverse_backlash" | "play" => Some(
                "the play is /design/backlash_um, all of it, along the direction of the mesh displacement s".to_owned(),
            ),
            "tip_diameter" | "outside_diameter" | "outer_diameter" | "addendum_diameter" | "da" | "d_a"
            | "tip_radius" => {
                let k =
                    self.over_module(if bare == "tip_radius" { 2.0 } else { 1.0 }).and_then(|(diameter, reference)| {
                        let rack =
                            self.of_member("addendum", Some(1.0))? + self.of_member("profile_shift", Some(0.0))?;
                        Some((diameter - reference) / 2.0 - rack)
                    });
                Some(format!(
                    "the tip circle follows from addendum, profile_shift and tip_alteration: k = (d_a / m_n − z / cos β) / 2 − addendum − \
                     profile_shift, {member}/tip_alteration{}",
                    shown(k, "")
                ))
            }
            "root_diameter" | "dedendum_diameter" | "df" | "d_f" | "root_radius" => {
                let factor = if bare == "root_radius" { 2.0 } else { 1.0 };
                let dedendum = self.over_module(factor).and_then(|(diameter, reference)| {
                    Some(self.of_member("profile_shift", Some(0.0))? + (reference - diameter) / 2.0)
                });
                Some(format!(
                    "the root circle follows from dedendum and profile_shift: {member}/dedendum = profile_shift + (z / cos β − d_f / m_n) \
                     / 2{}",
                    shown(dedendum, "")
                ))
            }
            "pitch_diameter" | "reference_diameter" | "pcd" | "d" | "pitch_radius" | "reference_radius" => {
                Some(format!(
                    "the reference circle follows from teeth, normal_module_mm and helix_angle_deg: d = z m_n / cos β{}",
                    shown(self.reference_diameter(), "mm")
                ))
            }
            "base_diameter" | "base_radius" | "db" | "d_b" => Some(
                "the base circle follows from teeth, normal_module_mm, helix_angle_deg and pressure_angle_deg"
                    .to_owned(),
            ),
            "addendum" | "dedendum" | "fillet_radius" | "tip_alteration" | "profile_shift"
                if self.unit.is_some_and(|unit| unit.quantity == UnitQuantity::Length) =>
            {
                let multiple =
                    self.mm().zip(self.number("/design/normal_module_mm")).map(|(length, module)| length / module);
                Some(format!("{member}/{bare} is a multiple of the normal module: length / m_n{}", shown(multiple, "")))
            }
            "addendum_coefficient" | "addendum_factor" | "ha" | "hap" | "h_ap" | "h_a" => {
                Some(format!("the rack's addendum is {member}/addendum, a multiple of the normal module"))
            }
            "dedendum_coefficient" | "dedendum_factor" | "hf" | "hfp" | "h_fp" | "h_f" => {
                Some(format!("the rack's dedendum is {member}/dedendum, a multiple of the normal module"))
            }
            "rho_f" | "rhofp" | "root_fillet_radius" | "tool_tip_radius" => {
                Some(format!("the rack's fillet is {member}/fillet_radius, a multiple of the normal module"))
            }
            "x"
            | "x1"
            | "x2"
            | "profile_shift_coefficient"
            | "addendum_modification"
            | "addendum_modification_coefficient" => Some(
                "the profile shift coefficients are /design/pinion/profile_shift and /design/gear/profile_shift"
                    .to_owned(),
            ),
            "bore" | "bore_radius" | "inner_diameter" | "shaft_diameter" => {
                Some(format!("the bore is {member}/bore_diameter_mm, a diameter"))
            }
            "crowning" => Some(format!("crowning along the tooth is {member}/lead_crowning_um")),
            "torque" if self.is_about_the_gear() => {
                let torque =
                    self.si(UnitQuantity::Torque, 1.0).zip(self.teeth()).map(|(torque, (z1, z2))| torque * z1 / z2);
                Some(format!(
                    "the torque is the pinion's, /operation/pinion_torque_nm: T_1 = T_2 z_1 / z_2{}",
                    shown(torque, "N m")
                ))
            }
            "torque" | "load" | "moment" if object != "/operation" || bare == stem => {
                let torque = self.si(UnitQuantity::Torque, 1.0).filter(|_| self.unit.is_some());
                Some(format!("the torque is /operation/pinion_torque_nm, of the whole pinion{}", shown(torque, "N m")))
            }
            "speed" | "rpm" | "angular_velocity" | "angular_speed" | "omega" | "rotational_speed" | "n" | "n1"
                if object != "/operation" || bare == stem || self.is_about_the_gear() || bare != "speed" =>
            {
                let rpm = self.si(UnitQuantity::Speed, PI / 30.0).map(|speed| speed * 30.0 / PI);
                if self.is_about_the_gear() {
                    let rpm = rpm.zip(self.teeth()).map(|(speed, (z1, z2))| speed * z2 / z1);
                    return Some(format!(
                        "the speed is the pinion's, /operation/pinion_speed_rpm: n_1 = n_2 z_2 / z_1{}",
                        shown(rpm, "r/min")
                    ));
                }
                let rpm = rpm.filter(|_| self.unit.is_some());
                Some(format!("the speed is /operation/pinion_speed_rpm{}", shown(rpm, "r/min")))
            }
            "power" => {
                let speed = self.number("/operation/pinion_speed_rpm");
                let torque = self.si(UnitQuantity::Power, 1e3).zip(speed).map(|(power, rpm)| power * 30.0 / (PI * rpm));
                Some(format!(
                    "the load is given as a torque, /operation/pinion_torque_nm: T_1 = P / ω_1{}",
                    shown(torque, "N m")
                ))
            }
            "application_factor" | "service_factor" | "overload_factor" | "load_factor" | "ka" | "k_a" => {
                let torque =
                    value.zip(self.number("/operation/pinion_torque_nm")).map(|(factor, torque)| factor * torque);
                Some(format!("the factor belongs into the torque, /operation/pinion_torque_nm{}", shown(torque, "N m")))
            }
            "e" | "e_gpa" | "e_modulus" | "elastic_modulus" | "young_modulus" | "modulus_of_elasticity"
                if self.is_of_material() =>
            {
                let modulus = self.si(UnitQuantity::Stress, 1e9).filter(|_| self.unit.is_some());
                Some(format!("Young's modulus is youngs_modulus_gpa{}", shown(modulus.map(|pa| pa / 1e9), "GPa")))
            }
            "poisson" | "poisson_ratio" | "nu" if self.is_of_material() => {
                Some("Poisson's ratio is poissons_ratio".to_owned())
            }
            "mesh_frequency" | "tooth_frequency" => {
                let teeth = self.number("/design/pinion/teeth");
                let rpm = value.filter(|_| self.unit.is_none_or(|unit| unit.text == "r/s")).zip(teeth);
                let rpm = rpm.map(|(hertz, teeth)| 60.0 * hertz / teeth);
                Some(format!("the speed is given, /operation/pinion_speed_rpm: n_1 = f_z / z_1{}", shown(rpm, "r/min")))
            }
            "tangential_force" | "circumferential_force" | "ft" | "f_t" => {
                let torque = self
                    .si(UnitQuantity::Force, 1.0)
                    .zip(self.reference_diameter())
                    .map(|(force, d)| force * d * 0.5e-3);
                Some(format!(
                    "the load is given as a torque, /operation/pinion_torque_nm: T_1 = F_t d_1 / 2{}",
                    shown(torque, "N m")
                ))
            }
            "step" | "step_size" | "time_step" | "max_step" | "dt" => Some(
                "steps are chosen for /analysis/accuracy; series are sampled by /analysis/samples_per_mesh_period"
                    .to_owned(),
            ),
            "tolerance" | "tol" | "rtol" | "relative_tolerance" | "precision" => {
                Some("the error to reach is /analysis/accuracy".to_owned())
            }
            _ => None,
        }
    }

    /// Names of an axis of a sweep in other programs.
    fn of_an_axis(&self) -> Option<String> {
        let here = |name: &str| self.number(&format!("{}/{name}", self.unknown.object));
        match plain(self.unknown.name).as_str() {
            "step" | "step_size" | "increment" | "delta" | "by" => {
                let step = self.unknown.value.as_f64();
                let points = here("from").zip(here("to")).zip(step).map(|((from, to), step)| (to - from) / step + 1.0);
                let points = points.filter(|points| (1.5..1e5).contains(points)).map(|points| (points + 1e-9).floor());
                Some(format!("the number of values is given, points: (to − from) / step + 1{}", shown(points, "")))
            }
            "start" | "min" | "minimum" | "first" | "begin" | "lower" => Some("the first value is \"from\"".to_owned()),
            "stop" | "end" | "max" | "maximum" | "last" | "upper" => Some("the last value is \"to\"".to_owned()),
            "count" | "n" | "num" | "number" | "steps" | "n_points" => {
                Some("the number of values is \"points\"".to_owned())
            }
            "path" | "field" | "parameter" | "param" | "variable" | "input" | "name" => Some(
                "the input that varies is \"pointer\", a JSON pointer such as /operation/pinion_speed_rpm".to_owned(),
            ),
            "list" | "value" => Some("a list of values is \"values\"".to_owned()),
            "scale" | "log" => Some("the spacing is \"spacing\": \"linear\" or \"logarithmic\"".to_owned()),
            _ => None,
        }
    }

    /// Hint for a field's name with another unit, or without one: the value in the unit of the field.
    fn in_another_unit(&self) -> Option<String> {
        let Some(unit) = self.unit else {
            let is_meant = |name: &&&str| matches!(split(name), (stem, Some(_)) if stem == self.stem);
            let name = self.unknown.known.iter().find(is_meant)?;
            return Some(format!("did you mean \"{name}\", in {}?", split(name).1?.name_for_people()));
        };
        let (name, field) = self.unknown.known.iter().find_map(|name| match split(name) {
            (stem, Some(field)) if stem == self.stem && field.quantity == unit.quantity && field.size != unit.size => {
                Some((name, field))
            }
            _ => None,
        })?;
        let given = self.unknown.value.as_f64().map(|value| [value, value * unit.size / field.size]);
        Some(match given.filter(|[_, converted]| converted.is_finite()).map(|both| both.map(significant)) {
            Some([given, converted]) => {
                format!("did you mean \"{name}\"? {} are {}", unit.after(given), field.after(converted))
            }
            None => format!("did you mean \"{name}\", in {}?", field.name_for_people()),
        })
    }

    /// Hint for a name that is a field of another object.
    fn elsewhere(&self, name: &str) -> Option<String> {
        static POINTERS: LazyLock<Vec<String>> =
            LazyLock::new(|| field_descriptions().into_iter().map(|field| field.pointer).collect());
        // The name of a material is not that of the job.
        if self.is_of_material() {
            return None;
        }
        let has_name = |pointer: &&String| pointer.rsplit('/').next() == Some(name) && !pointer.contains('*');
        let found: Vec<&str> = POINTERS.iter().filter(has_name).map(String::as_str).collect();
        match found[..] {
            [] => None,
            [one] => Some(format!("it stands at {one}")),
            [first, second] => Some(format!("it stands at {first} and {second}")),
            // Flank modifications are fields of each gear and half: the ones nearest to the root are named.
            _ => {
                let depth = |pointer: &str| pointer.matches('/').count();
                let least = found.iter().map(|pointer| depth(pointer)).min()?;
                let nearest: Vec<_> = found.into_iter().filter(|pointer| depth(pointer) == least).collect();
                (nearest.len() <= 2).then(|| format!("it stands at {}", nearest.join(" and ")))
            }
        }
    }

    fn is_known(&self, name: &str) -> bool {
        self.unknown.known.contains(&name)
    }

    fn is_of_material(&self) -> bool {
        self.unknown.object.ends_with("/material")
    }

    fn is_about_the_gear(&self) -> bool {
        self.unknown.object.starts_with("/design/gear") || is_of_gear(self.stem)
    }

    /// Text such as " = 20°" for an angle that was given in another unit.
    fn in_degrees(&self) -> String {
        let angle = self.si(UnitQuantity::Angle, PI / 180.0).filter(|_| self.unit.is_some());
        shown(angle.map(f64::to_degrees), "deg")
    }

    fn helix_from_base(&self) -> Option<f64> {
        let base = self.si(UnitQuantity::Angle, PI / 180.0)?;
        let angle = self.number("/design/pressure_angle_deg").unwrap_or(20.0).to_radians();
        // tan α_n = tan α_t cos β and sin β_b = sin β cos α_n; with α_t given, tan β_b = tan β cos α_t.
        let beta = match self.unknown.document.pointer("/design/pressure_angle_plane").and_then(Value::as_str) {
            Some("transverse") => (base.tan() / angle.cos()).atan(),
            _ => (base.sin() / angle.cos()).asin(),
        };
        Some(beta.to_degrees())
    }

    /// The given diameter (or `factor` times the given length) and the reference diameter, as multiples of the normal
    /// module.
    fn over_module(&self, factor: f64) -> Option<(f64, f64)> {
        let module = self.number("/design/normal_module_mm")?;
        Some((factor * self.mm()? / module, self.of_member("teeth", None)? / self.cos_beta()?))
    }
}

fn is_of_gear(stem: &str) -> bool {
    ["gear_", "wheel_", "output_"].iter().any(|prefix| stem.starts_with(prefix)) || stem.ends_with('2')
}

/// Text such as " = 5.4628 mm"; empty if the document does not determine the value.
fn shown(value: Option<f64>, unit: &str) -> String {
    match value.filter(|value| value.is_finite()) {
        Some(value) if unit.is_empty() => format!(" = {}", significant(value)),
        Some(value) => format!(" = {}", with_unit(significant(value), unit)),
        None => String::new(),
    }
}

/// A number with six significant digits.
fn significant(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::super::{DocumentError, parse, parse_value};
    use super::*;
    use rstest::rstest;
    use serde_json::json;

    /// The detail of the one violation that table 1 of the source has with `value` at `pointer`.
    fn detail(pointer: &str, value: Value) -> String {
        let mut document: Value = serde_json::from_str(include_str!("../../../examples/speed_sweep.json")).unwrap();
        let axis = json!({"pointer": "/operation/pinion_speed_rpm", "from": 500, "to": 8000, "points": 10});
        document["axes"] = json!([axis]);
        let (parent, name) = pointer.rsplit_once('/').unwrap();
        document.pointer_mut(parent).unwrap()[name] = value;
        let error = parse_value(&document).unwrap_err();
        let DocumentError::Invalid(violations) = error else { panic!("{error:?}") };
        let [violation] = &violations[..] else { panic!("{violations:?}") };
        assert_eq!((violation.pointer.as_str(), violation.code.as_str()), (pointer, "unknown-field"));
        violation.detail.clone()
    }

    // Of that document: z 17/44, m_n 6 mm, β 24.43°, α_t 20°, face 75 mm, gap 30 mm, 800 N m.
    #[rstest]
    #[case("/design/transverse_module_mm", 6.0, &["/design/normal_module_mm", "m_n = m_t cos β = 5.4628 mm"])]
    #[case("/design/transverseModule", 6.0, &["m_n = m_t cos β = 5.4628 mm"])]
    #[case("/design/gear/transverse_module_in", 0.25, &["m_n = m_t cos β = 5.78147 mm"])]
    #[case("/design/module_mm", 6.0, &["/design/normal_module_mm"])]
    #[case("/design/pinion/module", 6.0, &["/design/normal_module_mm"])]
    #[case("/module", 6.0, &["/design/normal_module_mm"])]
    #[case("/design/pinion/normal_module_mm", 6.0, &["/design/normal_module_mm"])]
    #[case("/design/m_t", 6.0, &["= 5.4628 mm"])]
    #[case("/design/m_n", 6.0, &["/design/normal_module_mm"])]
    #[case("/design/diametral_pitch", 4.0, &["25.4 mm / P_nd = 6.35 mm", "cos β = 5.78147 mm"])]
    #[case("/design/normal_diametral_pitch", 4.0, &["m_n = 25.4 mm / P_nd = 6.35 mm"])]
    #[case("/design/normal_pitch_mm", 18.849556, &["m_n = p_n / π = 6 mm"])]
    #[case("/design/transverse_pitch_mm", 18.849556, &["= 5.4628 mm"])]
    #[case("/design/ratio", 2.6, &["/design/gear/teeth over /design/pinion/teeth", "44/17 = 2.58824"])]
    #[case("/design/gear_ratio", 2.6, &["44/17"])]
    #[case("/design/helix_angle_rad", 0.5, &["\"helix_angle_deg\"", "0.5 rad are 28.6479°"])]
    #[case("/design/beta", 20.0, &["/design/helix_angle_deg"])]
    #[case("/design/base_helix_angle_deg", 22.0, &["sin β = sin β_b / cos α_n = 23.2656°"])]
    #[case("/design/transverse_pressure_angle_deg", 20.0, &["/design/pressure_angle_deg", "\"transverse\""])]
    #[case("/design/centre_distance_mm", 201.0, &["center_distance_mm"])]
    #[case("/design/centre_distance", 201.0, &["/design/center_distance_mm"])]
    #[case("/design/center_distance_m", 0.201, &["0.201 m are 201 mm"])]
    #[case("/design/total_face_width_mm", 180.0, &["/design/face_width_mm", "/ 2 = 75 mm"])]
    #[case("/design/face_width_total_mm", 200.0, &["/ 2 = 85 mm"])]
    #[case("/design/face_width_in", 3.0, &["3 in are 76.2 mm"])]
    #[case("/design/backlash_mm", 0.2, &["0.2 mm are 200 µm"])]
    #[case("/design/teeth", 17.0, &["/design/pinion/teeth", "/design/gear/teeth"])]
    #[case("/design/z1", 17.0, &["/design/pinion/teeth"])]
    #[case("/design/torque_nm", 800.0, &["/operation/pinion_torque_nm"])]
    #[case("/design/density_kg_m3", 7850.0, &["/design/material/density_kg_m3"])]
    #[case("/design/material/youngs_modulus_mpa", 206000.0, &["206000 MPa are 206 GPa"])]
    #[case("/design/material/density_g_cm3", 7.85, &["7.85 g/cm3 are 7850 kg/m³"])]
    #[case("/design/pinion/tip_diameter_mm", 124.0, &["/design/pinion/tip_alteration = -0.00253"])]
    #[case("/design/gear/outside_diameter_mm", 301.953, &["/design/gear/tip_alteration = -0.000667"])]
    #[case("/design/pinion/root_diameter_mm", 97.0, &["/design/pinion/dedendum = profile_shift", "= 1.25253"])]
    #[case("/design/gear/pitch_diameter_mm", 290.0, &["d = z m_n / cos β = 289.961"])]
    #[case("/design/pinion/addendum_mm", 6.6, &["/design/pinion/addendum", "length / m_n = 1.1"])]
    #[case("/design/gear/profile_shift_mm", 1.5, &["/design/gear/profile_shift", "= 0.25"])]
    #[case("/design/pinion/x", 0.2, &["/design/pinion/profile_shift"])]
    #[case("/design/pinion/number_of_teeth", 17.0, &["\"teeth\""])]
    #[case("/design/pinion/torque_nm", 800.0, &["/operation/pinion_torque_nm"])]
    #[case("/design/gear/torque_nm", 2070.588235, &["/operation/pinion_torque_nm", "T_2 z_1 / z_2 = 800 N·m"])]
    #[case("/design/gear/speed_rpm", 772.727273, &["/operation/pinion_speed_rpm", "= 2000 r/min"])]
    #[case("/design/pinion/bore_mm", 50.0, &["/design/pinion/bore_diameter_mm"])]
    #[case("/design/pinion/inertia_kg_mm2", 65000.0, &["65000 kg mm2 are 0.065 kg·m²"])]
    #[case("/operation/speed", 2000.0, &["/operation/pinion_speed_rpm"])]
    #[case("/operation/rpm", 2000.0, &["/operation/pinion_speed_rpm"])]
    #[case("/operation/speed_rad_s", 100.0, &["/operation/pinion_speed_rpm = 954.93 r/min"])]
    #[case("/operation/pinion_speed_rad_s", 100.0, &["100 rad/s are 954.93 r/min"])]
    #[case("/operation/pinion_torque_knm", 0.8, &["0.8 kN m are 800 N·m"])]
    #[case("/operation/gear_torque_nm", 2070.588235, &["= 800 N·m"])]
    #[case("/operation/output_speed_rpm", 772.727273, &["= 2000 r/min"])]
    #[case("/operation/power_kw", 100.0, &["T_1 = P / ω_1 = 477.465 N·m"])]
    #[case("/operation/mesh_frequency_hz", 566.666667, &["/operation/pinion_speed_rpm", "= 2000 r/min"])]
    #[case("/operation/helix_angle_deg", 20.0, &["/design/helix_angle_deg"])]
    #[case("/design/module_mm", 6.0, &["the value itself = 6 mm", "m_n = m_t cos β = 5.4628 mm"])]
    #[case("/design/pinion/hand", 1.0, &["/design/pinion/left_half_hand"])]
    #[case("/design/gear/inertia", 1.0, &["\"inertia_kg_m2\", in kg·m²"])]
    #[case("/design/pressure_angle", 20.0, &["\"pressure_angle_deg\", in °"])]
    #[case("/design/material/e_gpa", 206.0, &["youngs_modulus_gpa"])]
    #[case("/design/material/elastic_modulus_mpa", 206000.0, &["youngs_modulus_gpa = 206 GPa"])]
    #[case("/design/material/poisson_ratio", 0.3, &["poissons_ratio"])]
    #[case("/operation/power_hp", 134.102209, &["T_1 = P / ω_1 = 477.465 N·m"])]
    #[case("/operation/torque_ft_lb", 590.049719, &["/operation/pinion_torque_nm", "= 800 N·m"])]
    #[case("/operation/pinion_torque_in_lb", 7080.59663, &["are 800 N·m"])]
    #[case("/operation/application_factor", 1.25, &["/operation/pinion_torque_nm = 1000 N·m"])]
    #[case("/axes/0/step", 500.0, &["points", "/ step + 1 = 16"])]
    #[case("/axes/0/count", 16.0, &["\"points\""])]
    #[case("/axes/0/start", 1.0, &["\"from\""])]
    #[case("/analysis/step", 1e-6, &["/analysis/accuracy"])]
    #[case("/analysis/tolerance", 1e-6, &["/analysis/accuracy"])]
    fn f17_a_field_by_another_name_has_a_hint(#[case] pointer: &str, #[case] value: f64, #[case] parts: &[&str]) {
        let found = detail(pointer, json!(value));
        assert!(found.starts_with("is not a field of this object; "), "{found}");
        for part in parts {
            assert!(found.contains(part), "{part} in: {found}");
        }
    }

    #[test]
    fn f17_the_value_that_the_hint_gives_is_the_one_that_is_meant() {
        let text = include_str!("../../../examples/table1.json");
        let document = parse(text.as_bytes()).unwrap();
        let report = crate::study::CheckedJob::new(document).unwrap().report();
        let reference_mm = report.geometry.pinion.reference_diameter_mm;
        let hinted = detail("/design/transverse_module_mm", json!(reference_mm / 17.0));
        assert!(hinted.ends_with("m_n = m_t cos β = 6 mm"), "{hinted}");
        let hinted = detail("/design/gear/tip_diameter_mm", json!(report.geometry.gear.tip_diameter_mm));
        let k: f64 = hinted.rsplit(" = ").next().unwrap().parse().unwrap();
        assert!(k.abs() < 1e-9, "{hinted}");
        let hinted = detail("/design/pinion/root_diameter_mm", json!(report.geometry.pinion.root_diameter_mm));
        assert!(hinted.ends_with("= 1.25"), "{hinted}");
        let hinted = detail("/design/base_helix_angle_deg", json!(report.geometry.base_helix_angle_deg));
        assert!(hinted.ends_with("= 24.43°"), "{hinted}");
    }

    #[test]
    fn f17_without_the_numbers_it_needs_a_hint_has_the_formula_only() {
        for document in [json!({}), json!({"design": {}}), json!({"design": {"helix_angle_deg": "20"}}), json!([])] {
            for value in [json!(6), json!("6"), json!(null), json!({}), json!(1e308), json!(0)] {
                for (object, name) in [
                    ("/design", "transverse_module_mm"),
                    ("/design", "diametral_pitch"),
                    ("/design", "ratio"),
                    ("/design", "helix_angle_rad"),
                    ("/design", "total_face_width_mm"),
                    ("/design/gear", "tip_diameter_mm"),
                    ("/design/gear", "torque_nm"),
                    ("/operation", "power_kw"),
                    ("/axes/0", "step"),
                ] {
                    let known = ["helix_angle_deg"];
                    let said = hint(&Unknown { document: &document, object, name, value: &value, known: &known });
                    let said = said.unwrap_or_else(|| panic!("{name}"));
                    assert!(!said.contains("NaN") && !said.contains("inf"), "{said}");
                }
            }
        }
    }

    #[test]
    fn what_means_nothing_has_no_hint() {
        for name in ["", "_", "_mm", "colour", "é", "人", &"x".repeat(100)] {
            let unknown =
                Unknown { document: &json!({}), object: "/design", name, value: &json!(1), known: &["teeth"] };
            assert_eq!(hint(&unknown), None, "{name}");
        }
    }
}
