//! The shafts of a pair as plain values.

use serde::{Deserialize, Serialize};

use super::error::{ShaftError, ShaftItem};

/// Both shafts of a pair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShaftTrain {
    /// Shaft of the pinion.
    pub pinion: Shaft,
    /// Shaft of the gear.
    pub gear: Shaft,
}

/// A stepped shaft with the bodies of both gear halves, its bearings and its coupling. Positions are measured from the
/// left end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shaft {
    /// Segments from the left end to the right end, the bodies of the gear halves included.
    pub segments: Vec<ShaftSegment>,
    /// Position of the apex plane, the middle of the gap, m; z = position − `gear_position_m`.
    pub gear_position_m: f64,
    /// Bearings.
    pub bearings: Vec<Bearing>,
    /// Place where the torque enters or leaves.
    pub coupling: Coupling,
    /// Rigid body at mid-face of each half, additional to the mass of the segments.
    pub half_body: Option<RigidBody>,
    /// Further rigid bodies with their positions, m.
    pub bodies: Vec<(f64, RigidBody)>,
    /// Material.
    pub material: ShaftMaterial,
}

/// A cylindrical piece of a shaft.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShaftSegment {
    /// Length, m.
    pub length_m: f64,
    /// Outer diameter, m.
    pub diameter_m: f64,
    /// Bore diameter, m; 0 for a solid shaft.
    pub bore_m: f64,
}

/// Elastic material of a shaft.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShaftMaterial {
    /// Young's modulus E, Pa.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio ν.
    pub poissons_ratio: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
}

/// A linear bearing between the shaft and the rigid ground. It does not resist rotation about z.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bearing {
    /// Position from the left end, m.
    pub position_m: f64,
    /// Radial stiffness, N/m: force on the ground along x, y (rows) per displacement along x, y (columns). Cross terms
    /// need not be symmetric.
    pub radial_n_per_m: [[f64; 2]; 2],
    /// Radial damping, N s/m, ordered as the stiffness.
    pub radial_damping_n_s_per_m: [[f64; 2]; 2],
    /// Axial stiffness, N/m.
    pub axial_n_per_m: f64,
    /// Axial damping, N s/m.
    pub axial_damping_n_s_per_m: f64,
    /// Tilting stiffness about x and about y, N m/rad.
    pub tilting_nm_per_rad: f64,
    /// Tilting damping about x and about y, N m s/rad.
    pub tilting_damping_nm_s_per_rad: f64,
}

impl Bearing {
    /// A bearing of the same radial stiffness in all directions, and nothing else.
    pub fn radial(position_m: f64, radial_n_per_m: f64) -> Bearing {
        Bearing {
            position_m,
            radial_n_per_m: [[radial_n_per_m, 0.0], [0.0, radial_n_per_m]],
            radial_damping_n_s_per_m: [[0.0; 2]; 2],
            axial_n_per_m: 0.0,
            axial_damping_n_s_per_m: 0.0,
            tilting_nm_per_rad: 0.0,
            tilting_damping_nm_s_per_rad: 0.0,
        }
    }

    /// Stiffness (N/m, N m/rad) of the section at the bearing, over u_x, u_y, u_z, φ_x, φ_y, φ_z.
    pub(super) fn stiffness(&self) -> [[f64; 6]; 6] {
        section_matrix(self.radial_n_per_m, self.axial_n_per_m, self.tilting_nm_per_rad)
    }

    /// Damping (N s/m, N m s/rad) of the section at the bearing.
    pub(super) fn damping(&self) -> [[f64; 6]; 6] {
        section_matrix(self.radial_damping_n_s_per_m, self.axial_damping_n_s_per_m, self.tilting_damping_nm_s_per_rad)
    }
}

fn section_matrix(radial: [[f64; 2]; 2], axial: f64, tilting: f64) -> [[f64; 6]; 6] {
    let mut matrix = [[0.0; 6]; 6];
    for (row, radial) in matrix.iter_mut().zip(radial) {
        row[..2].copy_from_slice(&radial);
    }
    matrix[2][2] = axial;
    matrix[3][3] = tilting;
    matrix[4][4] = tilting;
    matrix
}

/// The place where the torque enters (pinion) or leaves (gear).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Coupling {
    /// Position from the left end, m.
    pub position_m: f64,
    /// Axial stiffness to the ground, N/m.
    pub axial_n_per_m: f64,
    /// Machine behind a torsional spring; `None`: the shaft turns freely in vibration.
    pub torsional: Option<Machine>,
}

/// Inertia of a machine on the torsional spring of a coupling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Torsional stiffness of the coupling, N m/rad.
    pub torsional_nm_per_rad: f64,
    /// Torsional damping of the coupling, N m s/rad.
    pub torsional_damping_nm_s_per_rad: f64,
    /// Polar moment of inertia of the machine, kg m².
    pub inertia_kg_m2: f64,
}

/// A rigid body on a section of the shaft.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RigidBody {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moment of inertia about the axis, kg m².
    pub polar_inertia_kg_m2: f64,
    /// Moment of inertia about a diameter through the centre of mass, kg m².
    pub diametral_inertia_kg_m2: f64,
}

/// Lowest ratio of a bore's wall to the diameter that is accepted.
const MIN_WALL_RATIO: f64 = 1e-6;

impl Shaft {
    /// Length, m.
    pub fn length_m(&self) -> f64 {
        self.segments.iter().map(|segment| segment.length_m).sum()
    }

    /// Whether neither a bearing nor the coupling holds the shaft axially.
    pub fn floats_axially(&self) -> bool {
        self.coupling.axial_n_per_m == 0.0 && self.bearings.iter().all(|bearing| bearing.axial_n_per_m == 0.0)
    }

    /// z of the bearings, m, from the apex plane.
    pub fn bearing_sections_m(&self) -> Vec<f64> {
        self.bearings.iter().map(|bearing| bearing.position_m - self.gear_position_m).collect()
    }

    /// z of the coupling, m, from the apex plane.
    pub fn coupling_section_m(&self) -> f64 {
        self.coupling.position_m - self.gear_position_m
    }

    /// Checks all numbers but the sufficiency of the support.
    ///
    /// # Errors
    /// [`ShaftError::NoSegments`], [`ShaftError::NoBearing`], [`ShaftError::InvalidValue`],
    /// [`ShaftError::OutsideShaft`].
    pub fn validate(&self) -> Result<(), ShaftError> {
        if self.segments.is_empty() {
            return Err(ShaftError::NoSegments);
        }
        for (i, segment) in self.segments.iter().enumerate() {
            let item = ShaftItem::Segment(i);
            positive(item, "length_m", segment.length_m)?;
            positive(item, "diameter_m", segment.diameter_m)?;
            not_negative(item, "bore_m", segment.bore_m)?;
            if segment.bore_m > segment.diameter_m * (1.0 - MIN_WALL_RATIO) {
                let reason = "it must be smaller than the diameter";
                return Err(ShaftError::InvalidValue { item, quantity: "bore_m", value: segment.bore_m, reason });
            }
        }
        positive(ShaftItem::Material, "youngs_modulus_pa", self.material.youngs_modulus_pa)?;
        positive(ShaftItem::Material, "density_kg_m3", self.material.density_kg_m3)?;
        let poissons_ratio = self.material.poissons_ratio;
        if !(poissons_ratio > -1.0 && poissons_ratio <= 0.5) {
            return Err(ShaftError::InvalidValue {
                item: ShaftItem::Material,
                quantity: "poissons_ratio",
                value: poissons_ratio,
                reason: "it must be above -1 and at most 0.5",
            });
        }
        self.on_shaft(ShaftItem::Gear, self.gear_position_m)?;
        if self.bearings.is_empty() {
            return Err(ShaftError::NoBearing);
        }
        for (i, bearing) in self.bearings.iter().enumerate() {
            bearing.validate(ShaftItem::Bearing(i))?;
            self.on_shaft(ShaftItem::Bearing(i), bearing.position_m)?;
        }
        self.on_shaft(ShaftItem::Coupling, self.coupling.position_m)?;
        not_negative(ShaftItem::Coupling, "axial_n_per_m", self.coupling.axial_n_per_m)?;
        if let Some(machine) = &self.coupling.torsional {
            positive(ShaftItem::Machine, "torsional_nm_per_rad", machine.torsional_nm_per_rad)?;
            let damping = machine.torsional_damping_nm_s_per_rad;
            not_negative(ShaftItem::Machine, "torsional_damping_nm_s_per_rad", damping)?;
            positive(ShaftItem::Machine, "inertia_kg_m2", machine.inertia_kg_m2)?;
        }
        if let Some(body) = &self.half_body {
            body.validate(ShaftItem::HalfBody)?;
        }
        for (i, (position_m, body)) in self.bodies.iter().enumerate() {
            body.validate(ShaftItem::Body(i))?;
            self.on_shaft(ShaftItem::Body(i), *position_m)?;
        }
        Ok(())
    }

    /// The position if it is on the shaft, moved to the end if it is beyond it by rounding.
    ///
    /// # Errors
    /// [`ShaftError::OutsideShaft`].
    pub(super) fn on_shaft(&self, item: ShaftItem, position_m: f64) -> Result<f64, ShaftError> {
        let length_m = self.length_m();
        let rounding = 1e-9 * length_m;
        if position_m >= -rounding && position_m <= length_m + rounding {
            Ok(position_m.clamp(0.0, length_m))
        } else {
            Err(ShaftError::OutsideShaft { item, position_m, length_m })
        }
    }

    /// Force (N) and moment (N m) of every bearing on the shaft, from the displacements of the sections at the bearings
    /// (see [`Shaft::bearing_sections_m`]), in the order of [`Shaft::bearings`].
    pub fn bearing_reactions(&self, displacements: &[[f64; 6]]) -> Vec<[f64; 6]> {
        self.bearings
            .iter()
            .zip(displacements)
            .map(|(bearing, u)| bearing.stiffness().map(|row| -row.iter().zip(u).map(|(k, u)| k * u).sum::<f64>()))
            .collect()
    }
}

impl Bearing {
    fn validate(&self, item: ShaftItem) -> Result<(), ShaftError> {
        let radial = self.radial_n_per_m.iter().flatten().map(|&k| ("radial_n_per_m", k));
        let damping = self.radial_damping_n_s_per_m.iter().flatten().map(|&c| ("radial_damping_n_s_per_m", c));
        for (quantity, value) in radial.chain(damping) {
            if !value.is_finite() {
                return Err(ShaftError::InvalidValue { item, quantity, value, reason: "it must be a finite number" });
            }
        }
        let others = [
            ("radial_n_per_m", self.radial_n_per_m[0][0]),
            ("radial_n_per_m", self.radial_n_per_m[1][1]),
            ("axial_n_per_m", self.axial_n_per_m),
            ("axial_damping_n_s_per_m", self.axial_damping_n_s_per_m),
            ("tilting_nm_per_rad", self.tilting_nm_per_rad),
            ("tilting_damping_nm_s_per_rad", self.tilting_damping_nm_s_per_rad),
        ];
        others.into_iter().try_for_each(|(quantity, value)| not_negative(item, quantity, value))
    }
}

impl RigidBody {
    fn validate(&self, item: ShaftItem) -> Result<(), ShaftError> {
        not_negative(item, "mass_kg", self.mass_kg)?;
        not_negative(item, "polar_inertia_kg_m2", self.polar_inertia_kg_m2)?;
        not_negative(item, "diametral_inertia_kg_m2", self.diametral_inertia_kg_m2)
    }
}

pub(super) fn positive(item: ShaftItem, quantity: &'static str, value: f64) -> Result<(), ShaftError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ShaftError::InvalidValue { item, quantity, value, reason: "it must be a positive finite number" })
}

pub(super) fn not_negative(item: ShaftItem, quantity: &'static str, value: f64) -> Result<(), ShaftError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ShaftError::InvalidValue { item, quantity, value, reason: "it must be zero or a positive finite number" })
}
