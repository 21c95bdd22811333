//! Memory of a compliance, from the sizes that it grows with.

use super::bulk::NODES;
use super::influence::table_bytes;
use super::member::width_order;
use super::ring_influence::ring_bytes;
use super::settings::stations;
use super::{CORNER_REACH, PATH_NODES, UNIFORM_STATIONS};
use crate::contact::{ComplianceModel, ContactSizes};
use crate::fe::{Resolution, load_grid_size};

/// Memory of a compliance, bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ComplianceMemory {
    /// What is kept.
    pub kept: f64,
    /// Peak while it is made, what is kept included. With finite elements without the elimination of a sector, which
    /// does not grow with the contact ratio.
    pub peak: f64,
}

/// Tooth pairs that can be in contact at once lie up to so many pitches apart.
pub(crate) fn offsets(total_contact_ratio: f64, corner_contact: bool) -> usize {
    let reach = if corner_contact { 2.0 * CORNER_REACH } else { 0.0 };
    (total_contact_ratio + reach + 1e-6).floor() as usize
}

/// Stations of the bulk flexibility.
pub(crate) fn station_count(sizes: &ContactSizes) -> usize {
    match sizes.compliance {
        ComplianceModel::Analytic => stations(sizes.face_modules, 1.0),
        ComplianceModel::FiniteElements(resolution) => grid(sizes, resolution).1,
        ComplianceModel::Uniform => UNIFORM_STATIONS,
    }
}

/// Involute of a flank over the height of its tooth: below that with pressure angles up to 35°.
const INVOLUTE_PER_HEIGHT: f64 = 1.25;

fn grid(sizes: &ContactSizes, resolution: Resolution) -> (usize, usize) {
    load_grid_size(resolution, INVOLUTE_PER_HEIGHT * sizes.tooth_height_modules, sizes.face_modules)
}

/// Memory of the compliance of a pair: of both rings and teeth and of the table that they are put together to, or of
/// the flexibilities of both gears and that table.
pub(crate) fn compliance_memory(sizes: &ContactSizes) -> ComplianceMemory {
    let offsets = offsets(sizes.total_contact_ratio(), sizes.corner_contact) as f64;
    let stations = station_count(sizes) as f64;
    match sizes.compliance {
        ComplianceModel::Analytic => {
            let table = table_bytes(NODES as f64, stations, offsets);
            let order = width_order(sizes.face_modules);
            let (ring, passing) = ring_bytes(order, sizes.face_modules, sizes.helix_angle_rad, offsets);
            // The rings are small pieces, which the allocator does not give back for the tables.
            let rings = 2.0 * (ring + passing);
            ComplianceMemory { kept: table + rings, peak: 3.0 * table + rings }
        }
        ComplianceModel::FiniteElements(resolution) => {
            let table = table_bytes(PATH_NODES as f64, stations, offsets);
            let (profile, stations) = grid(sizes, resolution);
            let flexibility = 8.0 * (offsets + 2.0) * ((profile * stations) as f64).powi(2);
            // Of one gear the sums over the sectors and their copy, or the copy and its stored bytes; of the other what
            // is kept.
            ComplianceMemory { kept: table, peak: (3.0 * flexibility).max(2.0 * flexibility + table) }
        }
        ComplianceModel::Uniform => {
            let table = table_bytes(1.0, stations, 0.0);
            ComplianceMemory { kept: table, peak: table }
        }
    }
}
