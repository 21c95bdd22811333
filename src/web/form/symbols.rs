//! Symbols of the quantities (ISO 21771, ISO 1122), for those who read a drawing faster than words.

/// End of a field's pointer, letter, subscript.
const SYMBOLS: &[(&str, &str, &str)] = &[
    ("/normal_module_mm", "m", "n"),
    ("/pressure_angle_deg", "α", ""),
    ("/helix_angle_deg", "β", ""),
    ("/face_width_mm", "b", ""),
    ("/center_distance_mm", "a", "w"),
    ("/teeth", "z", ""),
    ("/profile_shift", "x", ""),
    ("/addendum", "h*", "aP"),
    ("/dedendum", "h*", "fP"),
    ("/fillet_radius", "ρ*", "fP"),
    ("/tip_alteration", "k", ""),
    ("/inertia_kg_m2", "J", ""),
    ("/tip_relief/amount_um", "C", "αa"),
    ("/tip_relief/length_mm", "L", "Cαa"),
    ("/lead_crowning_um", "C", "β"),
    ("/helix_slope_um", "C", "Hβ"),
    ("/youngs_modulus_gpa", "E", ""),
    ("/poissons_ratio", "ν", ""),
    ("/density_kg_m3", "ρ", ""),
    ("/pinion_speed_rpm", "n", "1"),
    ("/pinion_torque_nm", "T", "1"),
    ("/damping_ratio", "ζ", ""),
    ("/mesh_damping_ratio", "ζ", "m"),
];

/// Letter and subscript of a field, both empty where there is none.
pub fn symbol(pointer: &str) -> (&'static str, &'static str) {
    let found = SYMBOLS.iter().find(|(end, ..)| pointer.ends_with(end) && !pointer.starts_with("/axes"));
    found.map_or(("", ""), |(_, letter, subscript)| (*letter, *subscript))
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::schema::field_descriptions;

    #[test]
    fn symbols_belong_to_fields() {
        let fields = field_descriptions();
        for (end, ..) in SYMBOLS {
            assert!(fields.iter().any(|field| field.pointer.ends_with(end)), "{end}");
        }
        assert_eq!(symbol("/design/pinion/addendum"), ("h*", "aP"));
        assert_eq!(symbol("/design/gap_width_mm"), ("", ""));
    }
}
