//! The springs of the model one by one, each as a direction in the source's twelve displacements: meshes, supports, shafts between
//! the halves.

use super::SourceVector;
use crate::dynamics::parameters::{Parameters, Spring};

/// What a spring belongs to. Supports hold a half to the ground, the others hold the halves of a shaft together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpringGroup {
    MeshLeft,
    MeshRight,
    PinionLateral,
    GearLateral,
    PinionAxial,
    GearAxial,
    PinionHalvesLateral,
    GearHalvesLateral,
    PinionHalvesAxial,
    GearHalvesAxial,
    PinionHalvesTorsional,
    GearHalvesTorsional,
}

impl SpringGroup {
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

    /// Its name in results.
    pub fn as_str(self) -> &'static str {
        Self::ALL.iter().find(|(group, _)| *group == self).map_or("", |(_, word)| word)
    }
}

/// A spring with its damper: its deflection is `row` times the displacements.
pub(super) struct SpringElement {
    pub group: SpringGroup,
    pub row: SourceVector,
    pub spring: Spring,
}

/// Every spring there is, the meshes at their mean stiffness and closed; those of no stiffness and damping left out.
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

/// s_j as a row over the twelve displacements.
pub(super) fn mesh_direction(p: &Parameters, j: usize) -> SourceVector {
    let (sin, cos) = p.helix_angle_rad.sin_cos();
    let sin = if j == 0 { sin } else { -sin };
    let mut row = [0.0; 12];
    row[6 * j..6 * j + 6].copy_from_slice(&[cos, sin, cos * p.pinion_radius_m, -cos, -sin, -cos * p.gear_radius_m]);
    row
}
