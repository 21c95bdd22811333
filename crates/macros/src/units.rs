//! The unit at the end of a field's name.

/// Ending of a name and its unit, in the ASCII form of the API; longer endings stand before the shorter ones that they
/// end with.
const UNITS: [(&str, &str); 28] = [
    ("_nm_per_rad", "N m/rad"),
    ("_percent_per_um", "%/um"),
    ("_um_per_um", "um/um"),
    ("_n_per_mm_um", "N/(mm um)"),
    ("_n_per_um", "N/um"),
    ("_n_per_mm", "N/mm"),
    ("_per_mesh_period", "1/mesh period"),
    ("_mesh_periods", "mesh periods"),
    ("_kg_m2", "kg m2"),
    ("_kg_m3", "kg/m3"),
    ("_m_s2", "m/s2"),
    ("_m_s", "m/s"),
    ("_percent", "%"),
    ("_mpa", "MPa"),
    ("_gpa", "GPa"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_rpm", "r/min"),
    ("_hz", "Hz"),
    ("_nm", "N m"),
    ("_mm", "mm"),
    ("_um", "um"),
    ("_us", "us"),
    ("_ms", "ms"),
    ("_kg", "kg"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
];

/// A name without its unit, the ending of the unit (empty where there is none) and the unit.
pub(crate) fn split(name: &str) -> (&str, &'static str, &'static str) {
    UNITS.iter().find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, *ending, *unit))).unwrap_or((name, "", ""))
}

/// A name as words: `center_distance` is "centre distance".
pub(crate) fn words(name: &str) -> String {
    name.replace('_', " ").replace("center", "centre")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_ending_is_the_unit() {
        for (name, expected) in [
            ("stiffness_mean_n_per_um", ("stiffness_mean", "_n_per_um", "N/um")),
            ("velocity_m_s", ("velocity", "_m_s", "m/s")),
            ("dynamic_factor", ("dynamic_factor", "", "")),
            ("load_split_percent_per_um", ("load_split", "_percent_per_um", "%/um")),
        ] {
            assert_eq!(split(name), expected);
        }
        assert!(
            UNITS
                .iter()
                .enumerate()
                .all(|(at, (ending, _))| { UNITS[at + 1..].iter().all(|(later, _)| !later.ends_with(ending)) })
        );
    }
}
