//! The geared rotor: forces in the bearings, modes of both shafts.

use super::{PerHalf, ResultFields};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Force of a bearing on its shaft over the steady motion.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BearingForceResult {
    /// `pinion` or `gear`.
    pub shaft: String,
    /// Place among the bearings of that shaft, from 0.
    pub index: u32,
    /// From the left end of the shaft.
    pub position_mm: f64,
    pub force_n: BearingForces,
}

/// The force along each axis: x from the pinion's axis to the gear's, z along the shafts from left to right, y = z × x.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BearingForces {
    pub x: DirectionForce,
    pub y: DirectionForce,
    pub z: DirectionForce,
}

impl BearingForces {
    /// RMS of the dynamic force vector.
    pub fn rms_n(&self) -> f64 {
        self.axes().iter().map(|(_, force)| force.rms * force.rms).sum::<f64>().sqrt()
    }

    /// The components with the names of their axes.
    pub fn axes(&self) -> [(&'static str, &DirectionForce); 3] {
        [("x", &self.x), ("y", &self.y), ("z", &self.z)]
    }
}

/// One component of a bearing's force.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DirectionForce {
    /// Of the static forces and what the vibration adds.
    pub mean: f64,
    /// Of the dynamic part: mean removed.
    pub rms: f64,
    /// Amplitudes at the mesh frequency and its multiples, from order 1.
    pub amplitudes: Vec<f64>,
    /// Phases of the cosines of these orders, mesh phase 0 at the start of contact of a pair of the left half.
    #[serde(default)]
    pub phases_rad: Vec<f64>,
}

/// Orders of the normal tooth force of each half (mesh force, and impact force where one is applied), N.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ToothForceOrders {
    pub left: ForceOrders,
    pub right: ForceOrders,
}

/// Amplitudes at the mesh frequency and its multiples, from order 1, and the phases of their cosines.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ForceOrders {
    pub amplitudes: Vec<f64>,
    /// Mesh phase 0 at the start of contact of a pair of the left half.
    pub phases_rad: Vec<f64>,
}

/// The geared rotor behind the response, and how far its modes were reduced.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Rotor))]
#[scalar(theory = "shafts#reduction")]
pub struct RotorResult {
    /// Degrees of freedom of the full model.
    #[scalar(label = "rotor: degrees of freedom of both shafts", change = Absolute)]
    pub degrees_of_freedom: u32,
    /// Coordinates of the equations of motion: modes and static corrections.
    #[scalar(label = "rotor: coordinates kept", change = Absolute)]
    pub coordinates: u32,
    #[scalar(label = "rotor: modes kept", change = Absolute)]
    pub modes_kept: u32,
    /// Static corrections (residual flexibility) beside the modes.
    #[scalar(label = "rotor: static corrections", change = Absolute)]
    pub static_corrections: u32,
    /// Up to which frequency the error below was estimated.
    #[scalar(label = "rotor: highest frequency of interest")]
    pub highest_frequency_hz: f64,
    /// Largest relative error of the receptances of both meshes up to that frequency, against the full model.
    #[scalar(label = "rotor: estimated relative error of the reduction", lower_is_better)]
    pub reduction_error: f64,
    /// Modes with frequency zero: motions that nothing holds; not among `modes`.
    #[scalar(label = "rotor: motions that nothing holds", change = Absolute)]
    pub rigid_body_modes: u32,
    /// Stiffness of each mesh with which the modes were found, along the flank normal.
    #[scalar(label = "rotor: mesh stiffness of the modes", theory = "shafts#modes")]
    pub mesh_stiffness_n_per_um: PerHalf,
    /// Frequencies at the speed of the document, gyroscopic terms included, undamped.
    pub whirl_frequencies_hz: Vec<f64>,
    /// Undamped modes at rest, by ascending frequency.
    pub modes: Vec<RotorMode>,
}

/// A natural mode of both shafts, undamped, at rest, with the mean mesh stiffness.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RotorMode {
    pub frequency_hz: f64,
    /// After what holds most of the strain energy.
    pub name: String,
    /// Damping ratio as far as damping does not couple the modes.
    pub damping_ratio: f64,
    /// Share of the strain energy in each mesh.
    pub strain_energy_mesh: PerHalf,
    /// Share of the strain energy in all bearings together.
    pub strain_energy_bearings: f64,
    /// Share of everything else that holds strain energy: `pinion_shaft`, `gear_shaft`, `pinion_coupling`, `gear_coupling`, and each bearing as
    /// `pinion_bearing_0`, ….
    pub strain_energy: BTreeMap<String, f64>,
    /// Shares of the kinetic energy: `lateral`, `axial`, `torsion`; `pinion_shaft`, `gear_shaft`.
    pub kinetic_energy: BTreeMap<String, f64>,
    /// Displacements of the four sections at mid-face.
    pub shape: MidFaceShape,
    /// Displacements along both shafts, in the scale of `shape`.
    pub along: ShapeAlongShafts,
}

/// (u_x, u_y, u_z, r_b φ_x, r_b φ_y, r_b φ_z) of the section at mid-face of each half, r_b the base radius of the member; the largest is 1.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct MidFaceShape {
    pub pinion_left: [f64; 6],
    pub pinion_right: [f64; 6],
    pub gear_left: [f64; 6],
    pub gear_right: [f64; 6],
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ShapeAlongShafts {
    pub pinion: ShaftShape,
    pub gear: ShaftShape,
}

/// Displacements of the centre line of a shaft in a mode.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ShaftShape {
    /// From the left end of the shaft.
    pub station_mm: Vec<f64>,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub z: Vec<f64>,
    /// r_b φ_z.
    pub twist: Vec<f64>,
}
