//! Impact force from the energy balance of the instantaneous line of action.

use super::corner::{EntryContact, FirstContact, NoEarlyContact, first_contact};
use crate::gear::{Half, Pair};

/// Moments of inertia that take part in the impact of one half.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// Of the pinion.
    pub pinion_kg_m2: f64,
    /// Of the gear.
    pub gear_kg_m2: f64,
}

/// State of the half at mesh-in: operating point, inertias and loaded contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshInConditions {
    /// The helix half.
    pub half: Half,
    /// Angular speed of the pinion, at least zero.
    pub pinion_speed_rad_s: f64,
    /// Moments of inertia.
    pub inertia: Inertia,
    /// Stiffness of the whole mesh of the half, base plane, along the transverse base tangent.
    pub mesh_stiffness_n_per_m: f64,
    /// Share of the load on the entering pair just after its theoretical start (one twentieth of a base pitch), 0 … 1.
    pub load_share: f64,
    /// Base pitch error that brings the entering pair earlier.
    pub base_pitch_error_m: f64,
}

/// The mesh-in impact of one half.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshInImpact {
    /// Force with the pairs already in mesh as a buffer, along the instantaneous line of action (within theta of the
    /// transverse base tangent).
    pub force_n: f64,
    /// The same without the buffer (Zhou and others 2008).
    pub zhou2008_force_n: f64,
    /// Reduction by the buffer, in percent of the unbuffered force.
    pub reduction_percent: f64,
    /// Velocity of approach along the instantaneous line of action.
    pub velocity_m_s: f64,
    /// Contact time: lossless half sine of the equivalent mass on both compliances.
    pub duration_s: f64,
    /// Time from the first contact D to the theoretical start A.
    pub lead_s: f64,
    /// Inclination θ of the instantaneous line of action against the line of action.
    pub theta_rad: f64,
    /// Equivalent mass along the instantaneous line of action.
    pub equivalent_mass_kg: f64,
    /// Stiffness of the entering pair, K L.
    pub single_pair_stiffness_n_per_m: f64,
    /// Stiffness of the pairs already in mesh, K (1 - L).
    pub other_pairs_stiffness_n_per_m: f64,
    /// Roll before the theoretical start at which the pair first touches.
    pub overrun_m: f64,
    /// Turn of the gear over that roll.
    pub delta_phi2_rad: f64,
    /// Base radius of the gear on the instantaneous line of action, r'_b2.
    pub effective_gear_base_radius_m: f64,
    /// Set when there is no impact; all forces are zero then.
    pub none_because: Option<NoEarlyContact>,
}

/// Errors of the mesh-in impact.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ImpactError {
    /// The entering corner has left the flank of its mate.
    #[error(
        "{overrun_m} m before the start of contact the entering corner has no flank to meet: the deflection is too large for the teeth"
    )]
    NoFlank {
        /// Roll before the theoretical start of contact.
        overrun_m: f64,
    },
    /// The given deflection is not a number.
    #[error("the deflection {overrun_m} m before the start of contact is not a number")]
    Deflection {
        /// Roll before the theoretical start of contact.
        overrun_m: f64,
    },
    /// An input is outside its range.
    #[error("{what} = {value} must be {requirement}")]
    Input {
        /// The quantity and its unit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The condition it does not meet.
        requirement: &'static str,
    },
}

/// The mesh-in impact of one half.
///
/// First contact D from [`first_contact`]; then, with the arms `r'_1`, `r'_2` of the instantaneous line of action (for
/// the gear's tip corner `r'_1 = r_b1`, `r'_2 = r'_b2`):
/// - velocity `v_s = omega_1 r'_1 - omega_2 r'_2`, for the tip corner `omega_1 r_b1 (1 - r'_b2/r_b2)`;
/// - equivalent mass `m_e = I_1 I_2 / (I_1 r'_2² + I_2 r'_1²)`;
/// - compliances `q_s = 1/(K L)` of the entering pair and `q_r = 1/(K (1 - L))` of the pairs in mesh;
/// - energy `m_e v_s²/2 = F² (q_s + q_r cos² theta)/2`, so `F = v_s sqrt(m_e/(q_s + q_r cos² theta))`. The formula as
///   printed in the source paper, `v_s / sqrt(m_e (q_s + q_r cos² theta))`, is not a force; the energy balance it is
///   taken from is
///   this one. `q_r = 0` gives the unbuffered force of Zhou and others (2008).
/// - duration `pi sqrt(m_e (q_s + q_r cos² theta))`.
///
/// A share of zero is an entering pair that carries nothing: no force. A share of one leaves no pair to buffer; the
/// balance then has no meaning and is refused.
pub fn mesh_in(
    pair: &Pair,
    entry: &MeshInConditions,
    deflection: impl Fn(f64) -> f64,
) -> Result<MeshInImpact, ImpactError> {
    check(entry)?;
    Ok(match first_contact(pair, entry.half, entry.base_pitch_error_m, deflection)? {
        EntryContact::Early(contact) => from_contact(pair, entry, &contact),
        EntryContact::OnPath(reason) => MeshInImpact::none(pair, entry, reason),
    })
}

fn from_contact(pair: &Pair, entry: &MeshInConditions, contact: &FirstContact) -> MeshInImpact {
    let (arm_1, arm_2) = (contact.corner.pinion_arm_m, contact.corner.gear_arm_m);
    let ratio = f64::from(pair.pinion.teeth) / f64::from(pair.gear.teeth);
    let velocity = entry.pinion_speed_rad_s * (arm_1 - ratio * arm_2);
    let mass = equivalent_mass_kg(&entry.inertia, arm_1, arm_2);
    let single = entry.mesh_stiffness_n_per_m * entry.load_share;
    let others = entry.mesh_stiffness_n_per_m * (1.0 - entry.load_share);
    // In terms of stiffness, so that an unloaded entering pair (q_s infinite) gives zero force.
    let buffer = single / others * contact.corner.theta_rad.cos().powi(2);
    let zhou = velocity * (mass * single).sqrt();
    let force = zhou / (1.0 + buffer).sqrt();
    let duration = if single > 0.0 { std::f64::consts::PI * (mass * (1.0 + buffer) / single).sqrt() } else { 0.0 };
    MeshInImpact {
        force_n: force,
        zhou2008_force_n: zhou,
        reduction_percent: 100.0 * (1.0 - 1.0 / (1.0 + buffer).sqrt()),
        velocity_m_s: velocity,
        duration_s: duration,
        lead_s: lead_s(pair, entry, contact.overrun_m),
        theta_rad: contact.corner.theta_rad,
        equivalent_mass_kg: mass,
        single_pair_stiffness_n_per_m: single,
        other_pairs_stiffness_n_per_m: others,
        overrun_m: contact.overrun_m,
        delta_phi2_rad: contact.gear_turn_rad,
        effective_gear_base_radius_m: arm_2,
        none_because: None,
    }
}

fn lead_s(pair: &Pair, entry: &MeshInConditions, overrun_m: f64) -> f64 {
    let roll_speed = entry.pinion_speed_rad_s * pair.pinion.base_radius_m;
    if roll_speed > 0.0 { overrun_m / roll_speed } else { 0.0 }
}

/// `I_1 I_2 / (I_1 r_2² + I_2 r_1²)`.
fn equivalent_mass_kg(inertia: &Inertia, arm_1_m: f64, arm_2_m: f64) -> f64 {
    1.0 / (arm_1_m * arm_1_m / inertia.pinion_kg_m2 + arm_2_m * arm_2_m / inertia.gear_kg_m2)
}

impl MeshInImpact {
    fn none(pair: &Pair, entry: &MeshInConditions, reason: NoEarlyContact) -> MeshInImpact {
        let (r_1, r_2) = (pair.pinion.base_radius_m, pair.gear.base_radius_m);
        MeshInImpact {
            force_n: 0.0,
            zhou2008_force_n: 0.0,
            reduction_percent: 0.0,
            velocity_m_s: 0.0,
            duration_s: 0.0,
            lead_s: 0.0,
            theta_rad: 0.0,
            equivalent_mass_kg: equivalent_mass_kg(&entry.inertia, r_1, r_2),
            single_pair_stiffness_n_per_m: entry.mesh_stiffness_n_per_m * entry.load_share,
            other_pairs_stiffness_n_per_m: entry.mesh_stiffness_n_per_m * (1.0 - entry.load_share),
            overrun_m: 0.0,
            delta_phi2_rad: 0.0,
            effective_gear_base_radius_m: r_2,
            none_because: Some(reason),
        }
    }
}

fn check(entry: &MeshInConditions) -> Result<(), ImpactError> {
    let require = |what, value: f64, good: bool, requirement| {
        if good && value.is_finite() { Ok(()) } else { Err(ImpactError::Input { what, value, requirement }) }
    };
    let speed = entry.pinion_speed_rad_s;
    require("pinion speed, rad/s", speed, speed >= 0.0, "at least zero")?;
    for (what, value) in [
        ("pinion inertia, kg m²", entry.inertia.pinion_kg_m2),
        ("gear inertia, kg m²", entry.inertia.gear_kg_m2),
        ("mesh stiffness, N/m", entry.mesh_stiffness_n_per_m),
    ] {
        require(what, value, value > 0.0, "positive")?;
    }
    let share = entry.load_share;
    require("load share at mesh-in", share, (0.0..1.0).contains(&share), "from 0 to below 1")?;
    require("base pitch error, m", entry.base_pitch_error_m, true, "finite")
}
