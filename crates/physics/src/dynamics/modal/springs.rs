//! Springs of the model as directions in the twelve displacements: meshes, supports, couplings of the halves of a
//! shaft.

use super::DisplacementVector;
use crate::dynamics::parameters::{Parameters, Spring};

/// Group of a spring. Supports connect a half to the ground, the others connect the halves of a shaft.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpringGroup {
    /// Mesh of the left half.
    MeshLeft,
    /// Mesh of the right half.
    MeshRight,
    /// Lateral supports of the pinion halves.
    PinionLateral,
    /// Lateral supports of the gear halves.
    GearLateral,
    /// Axial supports of the pinion halves.
    PinionAxial,
    /// Axial supports of the gear halves.
    GearAxial,
    /// Lateral coupling of the pinion halves.
    PinionHalvesLateral,
    /// Lateral coupling of the gear halves.
    GearHalvesLateral,
    /// Axial coupling of the pinion halves.
    PinionHalvesAxial,
    /// Axial coupling of the gear halves.
    GearHalvesAxial,
    /// Torsional coupling of the pinion halves.
    PinionHalvesTorsional,
    /// Torsional coupling of the gear halves.
    GearHalvesTorsional,
}

impl SpringGroup {
    /// All groups with their names in results.
    pub const ALL: [(SpringGroup, &'static str); 12] = [
        (SpringGroup::MeshLeft, "mesh_left"),
        (SpringGroup::MeshRight, "mesh_right"),
        (SpringGroup::PinionLateral, "pinion_lateral"),
        (SpringGroup::GearLateral, "gear_lateral"),
        (SpringGroup::PinionAxial, "pinion_axial"),
        (SpringGroup::GearAxial, "gear_axial"),
        (SpringGroup::PinionHalvesLateral, "pinion_halves_lateral"),
        (SpringGroup::GearHalvesLateral, "gear_halves_lateral"),
        (SpringGroup::PinionHalvesAxial, "pinion_halves_axial"),
        (SpringGroup::GearHalvesAxial, "gear_halves_axial"),
        (SpringGroup::PinionHalvesTorsional, "pinion_halves_torsional"),
        (SpringGroup::GearHalvesTorsional, "gear_halves_torsional"),
    ];

    /// Name in results.
    pub fn as_str(self) -> &'static str {
        Self::ALL.iter().find(|(group, _)| *group == self).map_or("", |(_, word)| word)
    }
}

/// Spring with damper; its deflection is the scalar product of `row` and the displacements.
pub(super) struct SpringElement {
    pub group: SpringGroup,
    pub row: DisplacementVector,
    pub spring: Spring,
}

/// All springs with stiffness or damping; the meshes closed, with their mean stiffness.
pub(super) fn spring_elements(p: &Parameters) -> Vec<SpringElement> {
    use SpringGroup::*;
    let mut out = Vec::with_capacity(16);
    let mut add = |group, row, spring: Spring| {
        if spring != Spring::default() {
            out.push(SpringElement { group, row, spring });
        }
    };
    for (j, h) in p.halves.iter().enumerate() {
        let mesh = Spring { stiffness: h.mesh_stiffness.mean_n_per_m(), damping: h.mesh_damping_n_s_per_m };
        add([MeshLeft, MeshRight][j], mesh_direction(p, j), mesh);
        let supports = [
            (PinionLateral, 0, h.pinion_lateral),
            (PinionAxial, 1, h.pinion_axial),
            (GearLateral, 3, h.gear_lateral),
            (GearAxial, 4, h.gear_axial),
        ];
        for (group, c, spring) in supports {
            let mut row = [0.0; 12];
            row[6 * j + c] = 1.0;
            add(group, row, spring);
        }
    }
    let c = &p.couplings;
    let between = [
        (PinionHalvesLateral, c.pinion_lateral),
        (PinionHalvesAxial, c.pinion_axial),
        (PinionHalvesTorsional, c.pinion_torsion),
        (GearHalvesLateral, c.gear_lateral),
        (GearHalvesAxial, c.gear_axial),
        (GearHalvesTorsional, c.gear_torsion),
    ];
    for (c, (group, spring)) in between.into_iter().enumerate() {
        let mut row = [0.0; 12];
        (row[c], row[c + 6]) = (1.0, -1.0);
        add(group, row, spring);
    }
    out
}

/// Gradient of s_j by the displacements.
pub(super) fn mesh_direction(p: &Parameters, j: usize) -> DisplacementVector {
    let (sin, cos) = p.helix_angle_rad.sin_cos();
    let sin = if j == 0 { sin } else { -sin };
    let mut row = [0.0; 12];
    row[6 * j..6 * j + 6].copy_from_slice(&[cos, sin, cos * p.pinion_radius_m, -cos, -sin, -cos * p.gear_radius_m]);
    row
}
