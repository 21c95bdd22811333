//! The numbers in the equations of motion, SI.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::contact_force::ContactForce;
use super::error::DynamicsError;
use super::excitation::{Impact, Stiffness};

/// A linear spring with a viscous damper beside it. Zero for both: not there. N/m and N s/m, or N m/rad and N m s/rad for
/// torsional ones.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Spring {
    pub stiffness: f64,
    pub damping: f64,
}

impl Spring {
    /// A spring whose damper is c = 2 ζ √(k m), m the mass (or inertia) it acts on.
    pub fn with_damping_ratio(stiffness: f64, damping_ratio: f64, mass: f64) -> Self {
        Self { stiffness, damping: 2.0 * damping_ratio * (stiffness * mass).sqrt() }
    }
}

/// What belongs to one helix half of the pair (half of a whole gear's mass and inertia, and so on).
#[derive(Debug, Clone, PartialEq)]
pub struct HalfParameters {
    pub pinion_mass_kg: f64,
    pub pinion_inertia_kg_m2: f64,
    pub gear_mass_kg: f64,
    pub gear_inertia_kg_m2: f64,
    /// Torque on this half of the pinion, N m. The gear's is this times R_g/R_p, so that rigid rotation is not accelerated.
    pub pinion_torque_nm: f64,
    /// k_py, c_py: the pinion's support along y.
    pub pinion_lateral: Spring,
    /// k_gy, c_gy.
    pub gear_lateral: Spring,
    /// The pinion's axial support; zero in the source, whose pinion floats.
    pub pinion_axial: Spring,
    /// k_gz, c_gz.
    pub gear_axial: Spring,
    /// k_m over the mesh phase, along s. With a `contact_force`: the tangent stiffness at the working load, for natural modes and as a
    /// scale; the force is then not taken from it.
    pub mesh_stiffness: Stiffness,
    /// The mesh force as a function of displacement and phase, in place of k_m(φ) f(s); both halves have one, or neither.
    pub contact_force: Option<Arc<ContactForce>>,
    /// c_m along s, N s/m; see [`mesh_damping_n_s_per_m`].
    pub mesh_damping_n_s_per_m: f64,
    /// F_s, along the mesh in the transverse plane; what it moves is said by [`Parameters::impact_acts_on`].
    pub impact: Option<Impact>,
    /// The excitations of this half come this fraction of a mesh period later than written (half stagger).
    pub phase_shift_mesh_periods: f64,
}

/// Which motions the mesh-in impact moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ImpactActsOn {
    /// The two torsional equations of its half only, as the source paper prints it.
    #[default]
    Torsion,
    /// All motions of its half, as a normal force on the tooth does: with F_s along the mesh in the transverse plane, F_y = F_s and
    /// F_z = F_s tanβ_j beside the mesh force's.
    All,
}

/// Springs and dampers between the two halves of a shaft.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Couplings {
    /// k_p12z, c_p12z.
    pub pinion_axial: Spring,
    /// k_g12z, c_g12z.
    pub gear_axial: Spring,
    /// Between y_p1 and y_p2; zero in the source.
    pub pinion_lateral: Spring,
    pub gear_lateral: Spring,
    /// Between θ_p1 and θ_p2; zero in the source.
    pub pinion_torsion: Spring,
    pub gear_torsion: Spring,
}

/// Everything the twelve equations need.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    pub mesh_frequency_hz: f64,
    /// R_p of the plane in use: pitch radius (`pitch`) or base radius (`base`).
    pub pinion_radius_m: f64,
    pub gear_radius_m: f64,
    /// β of the left half in the plane in use (β or β_b); the right half has −β.
    pub helix_angle_rad: f64,
    /// b: half of the total play along s.
    pub half_backlash_m: f64,
    /// True: the mesh damper acts always (the source's law). False: not while |s| ≤ b.
    pub damping_in_gap: bool,
    pub impact_acts_on: ImpactActsOn,
    /// Left, right.
    pub halves: [HalfParameters; 2],
    pub couplings: Couplings,
}

/// m_e = 1/(R_p²/I_p + R_g²/I_g), kg: the mass that the mesh of one half sees.
pub fn equivalent_mass_kg(
    pinion_radius_m: f64,
    pinion_inertia_kg_m2: f64,
    gear_radius_m: f64,
    gear_inertia_kg_m2: f64,
) -> f64 {
    1.0 / (pinion_radius_m * pinion_radius_m / pinion_inertia_kg_m2
        + gear_radius_m * gear_radius_m / gear_inertia_kg_m2)
}

/// c_m = 2 ζ_m √(k_mean m_e), N s/m.
pub fn mesh_damping_n_s_per_m(damping_ratio: f64, mean_stiffness_n_per_m: f64, equivalent_mass_kg: f64) -> f64 {
    2.0 * damping_ratio * (mean_stiffness_n_per_m * equivalent_mass_kg).sqrt()
}

impl Parameters {
    /// m_e of a half (0 left, 1 right).
    pub fn equivalent_mass_kg(&self, half: usize) -> f64 {
        let h = &self.halves[half];
        equivalent_mass_kg(self.pinion_radius_m, h.pinion_inertia_kg_m2, self.gear_radius_m, h.gear_inertia_kg_m2)
    }

    pub fn mesh_period_s(&self) -> f64 {
        1.0 / self.mesh_frequency_hz
    }

    /// ObserverPair halves equal in every respect, phase included: the motion is then mirror symmetric (z_2 = −z_1).
    pub fn is_symmetric(&self) -> bool {
        self.halves[0] == self.halves[1]
    }

    /// Moves torque between the halves until the mean impacts no longer push the floating pinion along its screw motion:
    /// the total stays. ΔT = R_p (mean F_s1 − mean F_s2)/2. Needed only when the impacts of the halves differ, and act on torsion
    /// alone: an impact that pushes the pinion along its axis too is balanced by the same torque that balances its mesh forces.
    pub fn balance_axially(&mut self) {
        if self.impact_acts_on == ImpactActsOn::All {
            return;
        }
        let mean = |h: &HalfParameters| h.impact.as_ref().map_or(0.0, Impact::mean_n);
        let total = self.halves[0].pinion_torque_nm + self.halves[1].pinion_torque_nm;
        let moved = 0.5 * self.pinion_radius_m * (mean(&self.halves[0]) - mean(&self.halves[1]));
        self.halves[0].pinion_torque_nm = 0.5 * total + moved;
        self.halves[1].pinion_torque_nm = 0.5 * total - moved;
    }

    /// Fails with the first parameter the equations cannot use.
    pub fn validate(&self) -> Result<(), DynamicsError> {
        positive("mesh frequency", self.mesh_frequency_hz)?;
        positive("pinion radius", self.pinion_radius_m)?;
        positive("gear radius", self.gear_radius_m)?;
        not_negative("half backlash", self.half_backlash_m)?;
        let beta = self.helix_angle_rad;
        if beta.is_nan() || beta.abs() >= std::f64::consts::FRAC_PI_2 {
            return Err(invalid("helix angle", beta, "must be between -90 and 90 degrees"));
        }
        if self.halves[0].contact_force.is_some() != self.halves[1].contact_force.is_some() {
            return Err(invalid("mesh force", f64::NAN, "both halves need a contact force, or neither"));
        }
        for h in &self.halves {
            positive("pinion mass", h.pinion_mass_kg)?;
            positive("gear mass", h.gear_mass_kg)?;
            positive("pinion inertia", h.pinion_inertia_kg_m2)?;
            positive("gear inertia", h.gear_inertia_kg_m2)?;
            finite("pinion torque", h.pinion_torque_nm)?;
            finite("phase shift", h.phase_shift_mesh_periods)?;
            not_negative("mesh damping", h.mesh_damping_n_s_per_m)?;
            spring("pinion lateral support", h.pinion_lateral)?;
            spring("gear lateral support", h.gear_lateral)?;
            spring("pinion axial support", h.pinion_axial)?;
            spring("gear axial support", h.gear_axial)?;
            h.mesh_stiffness.validate()?;
            h.impact.as_ref().map_or(Ok(()), Impact::validate)?;
        }
        let c = &self.couplings;
        spring("pinion axial coupling", c.pinion_axial)?;
        spring("gear axial coupling", c.gear_axial)?;
        spring("pinion lateral coupling", c.pinion_lateral)?;
        spring("gear lateral coupling", c.gear_lateral)?;
        spring("pinion torsional coupling", c.pinion_torsion)?;
        spring("gear torsional coupling", c.gear_torsion)
    }
}

fn invalid(name: &'static str, value: f64, reason: &'static str) -> DynamicsError {
    DynamicsError::InvalidParameter { name, value, reason }
}

fn positive(name: &'static str, value: f64) -> Result<(), DynamicsError> {
    if value.is_finite() && value > 0.0 { Ok(()) } else { Err(invalid(name, value, "must be positive and finite")) }
}

fn not_negative(name: &'static str, value: f64) -> Result<(), DynamicsError> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(invalid(name, value, "must be finite and not negative"))
    }
}

fn finite(name: &'static str, value: f64) -> Result<(), DynamicsError> {
    if value.is_finite() { Ok(()) } else { Err(invalid(name, value, "must be finite")) }
}

fn spring(name: &'static str, spring: Spring) -> Result<(), DynamicsError> {
    not_negative(name, spring.stiffness)?;
    not_negative(name, spring.damping)
}
