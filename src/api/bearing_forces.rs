//! The force spectrum that the bearings pass on, as CSV: for a model of the housing.

use super::csv::{CsvField, CsvWriter, Decimal};
use herringbone_job::result::BearingForceResult;
use std::io::{self, Write};

/// The columns of the table.
pub(super) const HEADER: [&str; 8] =
    ["shaft", "bearing", "position_mm", "axis", "mesh_order", "frequency_hz", "amplitude_n", "phase_rad"];

/// Writes a row for every bearing, axis and mesh order: the force of the bearing on its shaft is the sum of
/// `amplitude_n` cos(2π `frequency_hz` t + `phase_rad`) over the orders. Order 0 is the mean, its `amplitude_n` signed
/// and its phase 0. Bearings count from 1 on each shaft.
///
/// # Errors
/// Those of `out`.
pub fn write_bearing_forces<W: Write>(
    out: W,
    bearings: &[BearingForceResult],
    mesh_frequency_hz: f64,
    decimal: Decimal,
) -> io::Result<W> {
    let mut writer = CsvWriter::with_mark(out, decimal)?;
    writer.write_record(HEADER.map(CsvField::Text))?;
    for bearing in bearings {
        for (axis, force) in bearing.force_n.axes() {
            let phases = force.phases_rad.iter().copied().chain(std::iter::repeat(f64::NAN));
            let orders = std::iter::once((force.mean, 0.0)).chain(force.amplitudes.iter().copied().zip(phases));
            for (order, (amplitude_n, phase_rad)) in orders.enumerate() {
                writer.write_record([
                    CsvField::Text(&bearing.shaft),
                    CsvField::Integer(u64::from(bearing.index) + 1),
                    CsvField::Number(bearing.position_mm),
                    CsvField::Text(axis),
                    CsvField::Integer(order as u64),
                    CsvField::Number(order as f64 * mesh_frequency_hz),
                    CsvField::Number(amplitude_n),
                    CsvField::Number(phase_rad),
                ])?;
            }
        }
    }
    writer.into_inner()
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::{BearingForces, DirectionForce};

    #[test]
    fn a_row_for_every_axis_and_order() {
        let y = DirectionForce { mean: -7000.5, rms: 10.0, amplitudes: vec![12.0, 3.0], phases_rad: vec![0.5, -1.5] };
        let forces = BearingForces { y, ..BearingForces::default() };
        let bearing = BearingForceResult { shaft: "gear".to_owned(), index: 1, position_mm: 380.0, force_n: forces };
        let text = |decimal| {
            let bytes = write_bearing_forces(Vec::new(), std::slice::from_ref(&bearing), 425.0, decimal);
            String::from_utf8(bytes.expect("memory")).expect("UTF-8")
        };
        let expected = [
            "shaft,bearing,position_mm,axis,mesh_order,frequency_hz,amplitude_n,phase_rad",
            "gear,2,380.0,x,0,0.0,0.0,0.0",
            "gear,2,380.0,y,0,0.0,-7000.5,0.0",
            "gear,2,380.0,y,1,425.0,12.0,0.5",
            "gear,2,380.0,y,2,850.0,3.0,-1.5",
            "gear,2,380.0,z,0,0.0,0.0,0.0",
            "",
        ];
        assert_eq!(text(Decimal::Point), expected.join("\n"));
        assert!(text(Decimal::Comma).contains("gear;2;380,0;y;1;425,0;12,0;0,5\r\n"));
    }
}
