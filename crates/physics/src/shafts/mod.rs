//! Shafts on bearings: beams of several diameters, their static flexibility, and the geared rotor of both shafts.
//!
//! # Coordinates
//! Right-handed x, y, z. x points from the pinion axis to the gear axis, z along the shafts from left to right, y = z ×
//! x. The origin of z is the apex plane, the middle of the gap; both shafts are aligned by it. Displacements u (m) and
//! rotations φ (rad, right-handed about the axes) of a section are ordered u_x, u_y, u_z, φ_x, φ_y, φ_z, its forces (N)
//! and moments (N m) F_x, F_y, F_z, M_x, M_y, M_z. In the plane x–z the slope is +φ_y, in y–z it is −φ_x.
//!
//! # Beams
//! Straight Timoshenko beams with bending in two planes, torsion and tension; the shear coefficient of the hollow
//! circle is Cowper's. Sections are rigid: a point at r from the axis moves by u + φ × r. Diameter steps are fully
//! effective at the step.

mod beam;
mod error;
mod flexibility;
mod rotor;
mod shaft;
#[cfg(test)]
mod tests;

pub use error::{ShaftError, ShaftItem, SupportDefect};
pub use flexibility::{SectionLoad, StaticDeflection};
pub use rotor::{
    DampedMode, FrequencyResponse, GearedRotor, Harmonics, KineticShares, MeshElement, ModeRange, ReducedRotor,
    ReductionReport, ReductionSettings, ReductionStep, RotationSense, RotorMode, RotorModes, StrainShares,
};
pub use shaft::{Bearing, Coupling, Machine, RigidBody, Shaft, ShaftMaterial, ShaftSegment, ShaftTrain};
