//! The mesh of a half on its shafts as a spring, and the opening of its flanks by the displaced shafts.

use super::cycle::{LoadOnShafts, LoadedContactOnShafts, ShaftState};
use super::face_load::HalfOnShafts;
use super::flexibility::{ContactShafts, DisplacementField, NODES};
use super::frame::Body;
use crate::gear::Half;

/// The openings of a half between its bodies, relative to the mid-face sections at the pitch point, mean over the
/// period.
pub(super) fn displacement_field(shafts: &ContactShafts, half: &HalfOnShafts) -> DisplacementField {
    let mut openings_m = [0.0; NODES];
    openings_m.iter_mut().zip(&half.openings_m).for_each(|(o, mean)| *o = *mean);
    shafts.field(openings_m)
}

/// Mesh of a half as a spring in the equations of motion of the rotor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshSection {
    /// Section at which approach and tilt of the loaded teeth do not couple, from the apex plane along the shafts.
    pub position_m: f64,
    /// Mean force by approach of that section, along the flank normal, N/m.
    pub stiffness_n_per_m: f64,
    /// Moment by relative tilt of the sections, N m/rad.
    pub tilting_nm_per_rad: f64,
    /// Moment of the working load about that section less what the tilting stiffness takes of it, N m.
    pub tilting_moment_nm: f64,
}

impl HalfOnShafts {
    /// Distance from mid-face, towards the mesh-in end, of the section at which approach and tilt of the loaded teeth
    /// do not couple.
    fn uncoupled_arm_m(&self) -> f64 {
        let [stiffness, coupled, _] = self.tooth_stiffness;
        if stiffness > 0.0 { coupled / stiffness } else { 0.0 }
    }
}

impl LoadedContactOnShafts {
    /// The mesh of a half about its mean loaded state.
    pub fn mesh_section(&self, shafts: &ContactShafts, half: Half) -> MeshSection {
        let own = &self.load.halves[half.index()];
        let [stiffness_n_per_m, coupled_n, by_tilt_nm] = own.tooth_stiffness;
        let middle_m = 0.5 * shafts.frame.width_m;
        let arm_m = own.uncoupled_arm_m();
        let position_m = shafts.frame.z_m(half, middle_m + arm_m);
        let tilting_nm_per_rad = (by_tilt_nm - arm_m * coupled_n).max(0.0);
        // Closing by tilt per distance along z: (e_z × n) · (φ_p − φ_g).
        let n = shafts.frame.load(Body::Pinion, half, 0.0);
        let tilt = |state: &ShaftState| {
            let section = &state.mid_faces[half.index()];
            n[0] * section[4] - n[1] * section[3]
        };
        let tilt_rad = tilt(&self.shafts[0]) - tilt(&self.shafts[1]);
        let moment_nm = own.normal_force_n[0] * (own.centroid_z_m - position_m);
        MeshSection {
            position_m,
            stiffness_n_per_m,
            tilting_nm_per_rad,
            tilting_moment_nm: moment_nm - tilting_nm_per_rad * tilt_rad,
        }
    }

    /// The openings between the bodies of a half relative to those of its [`MeshSection`], for a
    /// [displaced half](crate::contact::HalfContact::displaced).
    pub fn field_about_mesh_section(&self, shafts: &ContactShafts, half: Half) -> DisplacementField {
        let own = &self.load.halves[half.index()];
        let arm_m = own.uncoupled_arm_m();
        let mut field = displacement_field(shafts, own);
        let at_section_m = field.at(0.5 * shafts.frame.width_m + arm_m, shafts.frame.pitch_point_m);
        field.opening_m.iter_mut().for_each(|opening| *opening -= at_section_m);
        field
    }
}

impl LoadOnShafts {
    /// The openings between the bodies of a half, for a [displaced half](crate::contact::HalfContact::displaced).
    pub fn displacement_field(&self, shafts: &ContactShafts, half: Half) -> DisplacementField {
        displacement_field(shafts, &self.halves[half.index()])
    }
}
