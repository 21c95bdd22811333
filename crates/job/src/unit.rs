//! Units: those in which fields of the document are declared, and others that occur in names of unknown fields.

use std::f64::consts::PI;

/// A unit.
#[derive(Debug, PartialEq)]
pub struct Unit {
    /// The unit in ASCII, as schemas and violations write it.
    pub text: &'static str,
    /// Ending of the names of fields in this unit; empty where names do not state it.
    pub suffix: &'static str,
    /// The unit with typographic symbols; empty for none, and for units in which no field is declared.
    pub symbol: &'static str,
    /// Value of one unit in the SI unit of its quantity.
    pub size: f64,
    pub quantity: UnitQuantity,
    /// Whether fields may be declared in it.
    declared: bool,
}

/// Physical quantity of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitQuantity {
    /// No physical quantity: plain numbers, and numbers in the unit of another field.
    Number,
    Length,
    Angle,
    Speed,
    Torque,
    Power,
    Force,
    Stress,
    Mass,
    Inertia,
    Density,
    Stiffness,
    LineStiffness,
    TorsionalStiffness,
    Damping,
    TorsionalDamping,
}

use UnitQuantity::*;

const fn declared(suffix: &'static str, text: &'static str, symbol: &'static str, size: f64, of: UnitQuantity) -> Unit {
    Unit { text, suffix, symbol, size, quantity: of, declared: true }
}

const fn other(suffix: &'static str, text: &'static str, size: f64, quantity: UnitQuantity) -> Unit {
    Unit { text, suffix, symbol: "", size, quantity, declared: false }
}

/// Every unit; a longer ending stands before one that ends it.
pub static UNITS: [Unit; 59] = [
    declared("_n_per_mm_um", "N/(mm um)", "N/(mm·µm)", 1e9, LineStiffness),
    declared("_nms_per_rad", "N m s/rad", "N·m·s/rad", 1.0, TorsionalDamping),
    declared("_nm_per_rad", "N m/rad", "N·m/rad", 1.0, TorsionalStiffness),
    other("_nm_per_deg", "N m/deg", 180.0 / PI, TorsionalStiffness),
    other("_knm_per_rad", "kN m/rad", 1e3, TorsionalStiffness),
    other("_kn_per_mm", "kN/mm", 1e6, Stiffness),
    declared("_n_per_um", "N/um", "N/µm", 1e6, Stiffness),
    other("_n_per_mm", "N/mm", 1e3, Stiffness),
    other("_n_per_m", "N/m", 1.0, Stiffness),
    declared("_ns_per_m", "N s/m", "N·s/m", 1.0, Damping),
    other("_kg_dm3", "kg/dm3", 1e3, Density),
    declared("_kg_m3", "kg/m3", "kg/m³", 1.0, Density),
    other("_g_cm3", "g/cm3", 1e3, Density),
    other("_t_m3", "t/m3", 1e3, Density),
    other("_kg_mm2", "kg mm2", 1e-6, Inertia),
    other("_kg_cm2", "kg cm2", 1e-4, Inertia),
    declared("_kg_m2", "kg m2", "kg·m²", 1.0, Inertia),
    other("_lbf_ft", "lbf ft", 1.355_817_948_331_4, Torque),
    other("_ft_lbf", "lbf ft", 1.355_817_948_331_4, Torque),
    other("_ft_lb", "lbf ft", 1.355_817_948_331_4, Torque),
    other("_lbft", "lbf ft", 1.355_817_948_331_4, Torque),
    other("_lbf_in", "lbf in", 0.112_984_829_027_617, Torque),
    other("_in_lbf", "lbf in", 0.112_984_829_027_617, Torque),
    other("_in_lb", "lbf in", 0.112_984_829_027_617, Torque),
    other("_nmm", "N mm", 1e-3, Torque),
    other("_knm", "kN m", 1e3, Torque),
    other("_n_m", "N m", 1.0, Torque),
    declared("_nm", "N m", "N·m", 1.0, Torque),
    other("_rad_s", "rad/s", 1.0, Speed),
    other("_rad_per_s", "rad/s", 1.0, Speed),
    other("_1_min", "r/min", PI / 30.0, Speed),
    declared("_rpm", "r/min", "r/min", PI / 30.0, Speed),
    other("_rps", "r/s", 2.0 * PI, Speed),
    other("_hz", "r/s", 2.0 * PI, Speed),
    other("_n_mm2", "N/mm2", 1e6, Stress),
    declared("_gpa", "GPa", "GPa", 1e9, Stress),
    other("_mpa", "MPa", 1e6, Stress),
    other("_pa", "Pa", 1.0, Stress),
    other("_psi", "psi", 6_894.757_293_168, Stress),
    other("_mrad", "mrad", 1e-3, Angle),
    declared("_rad", "rad", "rad", 1.0, Angle),
    other("_arcmin", "arcmin", PI / 10_800.0, Angle),
    declared("_deg", "deg", "°", PI / 180.0, Angle),
    other("_kw", "kW", 1e3, Power),
    other("_hp", "hp", 745.699_871_582_27, Power),
    other("_w", "W", 1.0, Power),
    other("_kn", "kN", 1e3, Force),
    declared("_kg", "kg", "kg", 1.0, Mass),
    other("_inch", "in", 25.4e-3, Length),
    other("_in", "in", 25.4e-3, Length),
    declared("_mm", "mm", "mm", 1e-3, Length),
    declared("_um", "um", "µm", 1e-6, Length),
    other("_cm", "cm", 1e-2, Length),
    other("_m", "m", 1.0, Length),
    declared("_n", "N", "N", 1.0, Force),
    // A name that is the unit: times of the service, none of the gears.
    declared("seconds", "s", "s", 1.0, Number),
    declared("", "1", "", 1.0, Number),
    declared("", "SI", "SI units", 1.0, Number),
    declared("", "unit of the input", "in its unit", 1.0, Number),
];

/// Units of results that no field of a document is declared in, in ASCII and with typographic symbols.
const RESULT_SYMBOLS: [(&str, &str); 8] = [
    ("us", "µs"),
    ("m/s2", "m/s²"),
    ("m/s^2", "m/s²"),
    ("rad/s2", "rad/s²"),
    ("rad/s^2", "rad/s²"),
    ("%/um", "% per µm"),
    ("um/um", "µm/µm"),
    ("1/mesh period", "per mesh period"),
];

/// Units of the API that are written differently with typographic symbols: in ASCII, and so.
pub fn typographic_units() -> impl Iterator<Item = (&'static str, &'static str)> {
    let declared = UNITS.iter().filter(|unit| unit.declared && unit.quantity != Number);
    declared.map(|unit| (unit.text, unit.symbol)).filter(|(text, symbol)| text != symbol).chain(RESULT_SYMBOLS)
}

/// A unit of the API with typographic symbols.
pub fn typographic(text: &str) -> &str {
    typographic_units().find_map(|(ascii, symbol)| (ascii == text).then_some(symbol)).unwrap_or(text)
}

/// A number with a unit given by its text in ASCII, as sentences for people write it.
pub(crate) fn with_unit(number: impl std::fmt::Display, text: &str) -> String {
    match Unit::named(text) {
        Some(unit) => unit.after(number),
        None => format!("{number} {text}"),
    }
}

impl Unit {
    /// The unit as sentences for people write it.
    pub(crate) fn name_for_people(&self) -> &'static str {
        if self.symbol.is_empty() { self.text } else { self.symbol }
    }

    /// A number with this unit, as sentences for people write it.
    pub(crate) fn after(&self, number: impl std::fmt::Display) -> String {
        match self.name_for_people() {
            "1" => number.to_string(),
            "°" => format!("{number}°"),
            unit => format!("{number} {unit}"),
        }
    }

    /// No unit: a plain number.
    pub const ONE: &'static Unit = Unit::of_field("", "1");

    /// The unit `text` of a field. Evaluated when the crate is compiled: an unknown unit, and a name that does not end
    /// in its unit, are errors there.
    pub const fn of_field(name: &str, text: &str) -> &'static Unit {
        let mut index = 0;
        let mut found = None;
        while index < UNITS.len() {
            let unit = &UNITS[index];
            if unit.declared {
                if is_same(unit.text.as_bytes(), text.as_bytes()) {
                    found = Some(unit);
                } else if found.is_none() && !unit.suffix.is_empty() {
                    assert!(
                        !ends_with(name, unit.suffix),
                        "the name of the field ends in another unit than it is declared in"
                    );
                }
            }
            index += 1;
        }
        match found {
            Some(unit) => {
                assert!(ends_with(name, unit.suffix), "the name of the field does not end in its unit");
                unit
            }
            None => panic!("a field is declared in a unit that is not known"),
        }
    }

    /// The unit `text` of a field in an object whose name ends in it. Evaluated when the crate is compiled.
    pub const fn of_object(text: &str) -> &'static Unit {
        let mut index = 0;
        while index < UNITS.len() {
            if UNITS[index].declared && is_same(UNITS[index].text.as_bytes(), text.as_bytes()) {
                return &UNITS[index];
            }
            index += 1;
        }
        panic!("a field is declared in a unit that is not known")
    }

    /// The unit that a name ends in.
    pub fn of_name(name: &str) -> Option<&'static Unit> {
        UNITS.iter().find(|unit| !unit.suffix.is_empty() && name.ends_with(unit.suffix))
    }

    /// The unit `text`, as a schema of the document writes it.
    pub fn named(text: &str) -> Option<&'static Unit> {
        UNITS.iter().find(|unit| unit.declared && unit.text == text)
    }
}

const fn ends_with(text: &str, end: &str) -> bool {
    match text.len().checked_sub(end.len()) {
        Some(start) => is_same(text.as_bytes().split_at(start).1, end.as_bytes()),
        None => false,
    }
}

const fn is_same(a: &[u8], b: &[u8]) -> bool {
    if a.len() != b.len() {
        return false;
    }
    let mut index = 0;
    while index < a.len() {
        if a[index] != b[index] {
            return false;
        }
        index += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A longer ending stands before one that ends it.
    #[test]
    fn the_longest_unit_is_found() {
        let named = || UNITS.iter().filter(|unit| !unit.suffix.is_empty());
        for (index, unit) in named().enumerate() {
            assert!(!named().take(index).any(|before| unit.suffix.ends_with(before.suffix)), "{}", unit.suffix);
        }
        assert_eq!(Unit::of_name("moment_nmm").map(|unit| unit.text), Some("N mm"));
        assert_eq!(Unit::of_name("teeth"), None);
    }

    #[test]
    fn a_field_is_declared_in_one_unit() {
        assert_eq!(Unit::of_field("pinion_torque_nm", "N m").suffix, "_nm");
        for unit in UNITS.iter().filter(|unit| unit.declared) {
            assert_eq!(Unit::named(unit.text), Some(unit));
        }
    }

    #[test]
    #[should_panic(expected = "ends in another unit")]
    fn a_unit_that_the_name_denies_is_refused() {
        Unit::of_field("face_width_mm", "1");
    }
}
