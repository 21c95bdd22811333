//! Parameters of the equations of motion, SI.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::contact_force::ContactForce;
use super::error::DynamicsError;
use super::excitation::{Harmonic, ImpactExcitation, Stiffness};
use super::modal_train::ModalTrain;

/// A linear spring with a viscous damper in parallel. Zero stiffness and damping: no spring.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Spring {
    /// N/m; torsional: N m/rad.
    pub stiffness: f64,
    /// N s/m; torsional: N m s/rad.
    pub damping: f64,
}

impl Spring {
    /// Spring with the damping coefficient c = 2 ζ √(k m). `mass`: the mass in kg or inertia in kg m² it acts on.
    pub fn with_damping_ratio(stiffness: f64, damping_ratio: f64, mass: f64) -> Self {
        Self { stiffness, damping: 2.0 * damping_ratio * (stiffness * mass).sqrt() }
    }
}

/// Parameters of one helix half of the pair (half of the mass and inertia of a whole gear).
#[derive(Debug, Clone, PartialEq)]
pub struct HalfParameters {
    /// Mass of half the pinion, kg.
    pub pinion_mass_kg: f64,
    /// Polar moment of inertia of half the pinion, kg m².
    pub pinion_inertia_kg_m2: f64,
    /// Mass of half the gear, kg.
    pub gear_mass_kg: f64,
    /// Polar moment of inertia of half the gear, kg m².
    pub gear_inertia_kg_m2: f64,
    /// Torque on this half of the pinion, N m. That of the gear is R_g/R_p times as large, so that rigid rotation is
    /// not accelerated.
    pub pinion_torque_nm: f64,
    /// k_py, c_py: support of the pinion along y.
    pub pinion_lateral: Spring,
    /// k_gy, c_gy: support of the gear along y.
    pub gear_lateral: Spring,
    /// Axial support of the pinion; zero in the source paper (floating pinion).
    pub pinion_axial: Spring,
    /// k_gz, c_gz: axial support of the gear.
    pub gear_axial: Spring,
    /// k_m over the mesh phase, along s. With a `contact_force`: tangent stiffness at the operating load, used for the
    /// natural modes and as a scale only.
    pub mesh_stiffness: Stiffness,
    /// Mesh force as a function of displacement and phase in place of k_m(φ) f(s). Both halves have one, or neither.
    pub contact_force: Option<Arc<ContactForce>>,
    /// c_m along s, N s/m; see [`mesh_damping_n_s_per_m`].
    pub mesh_damping_n_s_per_m: f64,
    /// F_s, tangential in the transverse plane; see [`Parameters::impact_acts_on`].
    pub impact: Option<ImpactExcitation>,
    /// e, displacement of the flanks along the tooth normal by their shape, as a Fourier series over the mesh phase
    /// from the first harmonic, amplitudes in m; positive opens a gap (material removed). The mesh force is that of s −
    /// e: k_m f(s − e) + c_m d(s − e)/dt, or the contact force at s − e. Empty: none.
    pub displacement_excitation: Vec<Harmonic>,
    /// Delay of the excitations of this half, in mesh periods (stagger of the halves).
    pub phase_shift_mesh_periods: f64,
}

/// Equations in which the mesh-in impact acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ImpactActsOn {
    /// The two torsional equations of its half only, as in the source paper.
    #[default]
    Torsion,
    /// All equations of its half, as a normal tooth force: F_y = F_s and F_z = F_s tanβ_j are added to the mesh force.
    All,
}

/// Springs and dampers between the two halves of a shaft.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Couplings {
    /// k_p12z, c_p12z: between z_p1 and z_p2.
    pub pinion_axial: Spring,
    /// k_g12z, c_g12z: between z_g1 and z_g2.
    pub gear_axial: Spring,
    /// Between y_p1 and y_p2; zero in the source paper.
    pub pinion_lateral: Spring,
    /// Between y_g1 and y_g2; zero in the source paper.
    pub gear_lateral: Spring,
    /// Between θ_p1 and θ_p2; zero in the source paper.
    pub pinion_torsion: Spring,
    /// Between θ_g1 and θ_g2; zero in the source paper.
    pub gear_torsion: Spring,
}

/// All parameters of the twelve equations.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Mesh frequency, Hz.
    pub mesh_frequency_hz: f64,
    /// R_p in the reference plane: pitch or base radius.
    pub pinion_radius_m: f64,
    /// R_g in the reference plane, m.
    pub gear_radius_m: f64,
    /// β of the left half in the reference plane (β or β_b); the right half has −β.
    pub helix_angle_rad: f64,
    /// b: half of the total backlash along s.
    pub half_backlash_m: f64,
    /// True: the mesh damper always acts (law of the source paper). False: only while |s| > b.
    pub damping_in_gap: bool,
    /// Equations in which the impact acts.
    pub impact_acts_on: ImpactActsOn,
    /// Left half, right half.
    pub halves: [HalfParameters; 2],
    /// Springs between the halves of the shafts.
    pub couplings: Couplings,
    /// Shafts, bearings and bodies as a reduced train, in place of the masses, supports and couplings. Radii, helix
    /// angle and pinion torques then serve the impact and the choice of the loaded flank alone.
    pub train: Option<Arc<ModalTrain>>,
}

/// Equivalent mass of the mesh of one half, m_e = 1/(R_p²/I_p + R_g²/I_g), kg.
pub fn equivalent_mass_kg(
    pinion_radius_m: f64,
    pinion_inertia_kg_m2: f64,
    gear_radius_m: f64,
    gear_inertia_kg_m2: f64,
) -> f64 {
    1.0 / (pinion_radius_m * pinion_radius_m / pinion_inertia_kg_m2
        + gear_radius_m * gear_radius_m / gear_inertia_kg_m2)
}

/// Mesh damping coefficient c_m = 2 ζ_m √(k_mean m_e), N s/m.
pub fn mesh_damping_n_s_per_m(damping_ratio: f64, mean_stiffness_n_per_m: f64, equivalent_mass_kg: f64) -> f64 {
    2.0 * damping_ratio * (mean_stiffness_n_per_m * equivalent_mass_kg).sqrt()
}

impl Parameters {
    /// m_e of a half (0 left, 1 right), kg.
    pub fn equivalent_mass_kg(&self, half: usize) -> f64 {
        let h = &self.halves[half];
        equivalent_mass_kg(self.pinion_radius_m, h.pinion_inertia_kg_m2, self.gear_radius_m, h.gear_inertia_kg_m2)
    }

    /// Mesh period, s.
    pub fn mesh_period_s(&self) -> f64 {
        1.0 / self.mesh_frequency_hz
    }

    /// Whether both halves are equal, phase included: the motion is then mirror-symmetric (z_2 = −z_1). Never with a
    /// [`train`](Self::train).
    pub fn is_symmetric(&self) -> bool {
        self.train.is_none() && self.halves[0] == self.halves[1]
    }

    /// Shifts torque between the halves until the mean impact forces have no component along the screw motion of the
    /// floating pinion; the total torque stays: ΔT = R_p (mean F_s1 − mean F_s2)/2. Needed only for unequal impacts
    /// that act on torsion alone: the axial component of an impact that acts on all equations is balanced by the torque
    /// that balances its mesh forces.
    pub fn balance_axially(&mut self) {
        if self.impact_acts_on == ImpactActsOn::All {
            return;
        }
        let mean = |h: &HalfParameters| h.impact.as_ref().map_or(0.0, ImpactExcitation::mean_n);
        let total = self.halves[0].pinion_torque_nm + self.halves[1].pinion_torque_nm;
        let shift_nm = 0.5 * self.pinion_radius_m * (mean(&self.halves[0]) - mean(&self.halves[1]));
        self.halves[0].pinion_torque_nm = 0.5 * total + shift_nm;
        self.halves[1].pinion_torque_nm = 0.5 * total - shift_nm;
    }

    /// Checks all parameters.
    ///
    /// # Errors
    /// [`DynamicsError::InvalidParameter`] for the first invalid one.
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
            if self.train.is_none() {
                positive("pinion mass", h.pinion_mass_kg)?;
                positive("gear mass", h.gear_mass_kg)?;
                positive("pinion inertia", h.pinion_inertia_kg_m2)?;
                positive("gear inertia", h.gear_inertia_kg_m2)?;
            }
            finite("pinion torque", h.pinion_torque_nm)?;
            finite("phase shift", h.phase_shift_mesh_periods)?;
            not_negative("mesh damping", h.mesh_damping_n_s_per_m)?;
            spring("pinion lateral support", h.pinion_lateral)?;
            spring("gear lateral support", h.gear_lateral)?;
            spring("pinion axial support", h.pinion_axial)?;
            spring("gear axial support", h.gear_axial)?;
            h.mesh_stiffness.validate()?;
            h.impact.as_ref().map_or(Ok(()), ImpactExcitation::validate)?;
            let numbers = |e: &Harmonic| e.amplitude.is_finite() && e.phase_rad.is_finite();
            if let Some(bad) = h.displacement_excitation.iter().find(|e| !numbers(e)) {
                return Err(invalid("displacement excitation", bad.amplitude, "harmonics must be finite"));
            }
        }
        if let Some(train) = &self.train {
            train.validate()?;
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
