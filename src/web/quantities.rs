//! The script module `common/quantities.js`: the scalars of a result and of gear data and the columns of a sweep, as
//! their types declare them. The pages take names, units and meanings from it.

use herringbone_job::result::{CellKind, Column, SweepPoint, gear_data_quantities, quantities};
use herringbone_job::unit::typographic_units;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// A column in the module.
#[derive(Serialize)]
struct ColumnEntry {
    name: &'static str,
    group: &'static str,
    /// Pointer of its quantity; null for a value made by the sweep itself.
    quantity: Option<&'static str>,
    half: Option<&'static str>,
    kind: &'static str,
    on_request: bool,
}

impl From<&Column> for ColumnEntry {
    fn from(column: &Column) -> Self {
        let kind = match column.kind {
            CellKind::Number => "number",
            CellKind::Word => "word",
            CellKind::Numbers => "numbers",
        };
        let Column { name, group, quantity, half, on_request, .. } = *column;
        Self { name, group, quantity, half, kind, on_request }
    }
}

static MODULE: LazyLock<String> = LazyLock::new(|| {
    let columns: Vec<_> = SweepPoint::COLUMNS.iter().map(ColumnEntry::from).collect();
    format!(
        "// Made by the service from the declarations of its results.\n\n\
         export const QUANTITIES = {};\n\nexport const GEAR_DATA = {};\n\nexport const SWEEP_COLUMNS = {};\n",
        list(quantities()),
        list(gear_data_quantities()),
        list(&columns)
    )
});

static UNITS_MODULE: LazyLock<String> = LazyLock::new(|| {
    let symbols: BTreeMap<_, _> = typographic_units().collect();
    // Texts, which can be written.
    let symbols = serde_json::to_string(&symbols).unwrap_or_default();
    format!("// Made by the service from its table of units.\n\nexport const UNIT_SYMBOLS = {symbols};\n")
});

/// The text of the module.
pub(super) fn module() -> &'static str {
    &MODULE
}

/// The text of the module `common/units.js`: units with typographic symbols, by those of the API.
pub(super) fn units_module() -> &'static str {
    &UNITS_MODULE
}

/// A list in JSON, which is JavaScript too, with a line for each entry.
fn list(entries: &[impl Serialize]) -> String {
    // Entries are texts and flags, which can be written.
    let lines = entries.iter().filter_map(|entry| serde_json::to_string(entry).ok());
    format!("[\n{}\n]", lines.map(|line| format!("  {line},")).collect::<Vec<_>>().join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_quantity_and_column_is_an_entry() {
        let module = module();
        let entries = module.lines().filter(|line| line.starts_with("  {")).count();
        assert_eq!(entries, quantities().len() + gear_data_quantities().len() + SweepPoint::COLUMNS.len());
        assert!(
            module.contains(r#""pointer":"/mesh/stiffness_mean_n_per_um","label":"mesh stiffness of one half, mean""#)
        );
        assert!(module.contains(r#""name":"tooth_force_max_left_n","group":"tooth_force_max""#));
    }
}
