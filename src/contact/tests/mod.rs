//! Tests of the whole room on real pairs.

mod fidelities;
mod invariants;
mod reference_pair;
mod robustness;
mod tooth_tables;

use crate::gear::{Assembly, FlankModification, GearSpec, Material, Pair, PairSpec, Rotation};

pub(super) fn member(teeth: u32, bore_radius_m: f64) -> GearSpec {
    GearSpec {
        teeth,
        profile_shift: 0.0,
        addendum: 1.0,
        dedendum: 1.25,
        fillet_radius: 0.38,
        tip_alteration: 0.0,
        bore_radius_m,
        flanks: [FlankModification::NONE; 2],
    }
}

/// Module 4 mm, unmodified, without errors.
pub(super) fn spec(teeth: [u32; 2], helix_deg: f64, face_width_m: f64) -> PairSpec {
    let bore = |z: u32| (0.2 * f64::from(z) * 4e-3).min(0.5 * f64::from(z) * 4e-3 - 3.5 * 4e-3).max(2e-3);
    PairSpec {
        normal_module_m: 4e-3,
        normal_pressure_angle_rad: 20f64.to_radians(),
        helix_angle_rad: helix_deg.to_radians(),
        face_width_m,
        gap_width_m: 20e-3,
        center_distance_m: None,
        material: Material { youngs_modulus_pa: 206e9, poissons_ratio: 0.3, density_kg_m3: 7850.0 },
        rotation: Rotation::ApexLeading,
        pinion: member(teeth[0], bore(teeth[0])),
        gear: member(teeth[1], bore(teeth[1])),
        assembly: Assembly {
            center_distance_error_m: 0.0,
            in_plane_misalignment_m: 0.0,
            out_of_plane_misalignment_m: 0.0,
            apex_offset_m: 0.0,
        },
    }
}

pub(super) fn pair(spec: &PairSpec) -> Pair {
    Pair::new(spec).expect("a feasible pair").0
}
