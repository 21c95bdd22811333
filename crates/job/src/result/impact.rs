//! The mesh-in impact.

use super::ResultFields;
use crate::document::{ActsOn, ImpactSource};
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Impact))]
#[scalar(theory = "impact#impact-force")]
pub struct ImpactResult {
    /// Force buffered by the pairs in mesh, or the given one. What only a calculated impact has is null for a given one.
    #[scalar(
        label = "mesh-in impact force",
        headline,
        lower_is_better,
        help = "Peak of the half-sine pulse when the loaded teeth already in mesh let the next pair touch too early, at its tip \
                corner. The pairs in mesh buffer it; Zhou's law of 2008 leaves that out."
    )]
    pub force_n: f64,
    #[scalar(label = "mesh-in impact force, Zhou et al. 2008", headline, theory = "impact#zhou-et-al-2008")]
    pub zhou2008_force_n: Option<f64>,
    #[scalar(label = "reduction of the impact force by the pairs in mesh", theory = "impact#zhou-et-al-2008")]
    pub reduction_percent: Option<f64>,
    #[scalar(label = "impact velocity", headline, theory = "impact#corner-contact")]
    pub velocity_m_s: Option<f64>,
    /// Length of the pulse in the equations.
    #[scalar(label = "impact duration", headline, theory = "impact#impact-duration")]
    pub duration_us: f64,
    /// Half the period of the equivalent mass on the compliance of the impact.
    #[scalar(label = "impact duration by the balance of energy", theory = "impact#impact-duration")]
    pub energy_balance_duration_us: Option<f64>,
    #[scalar(
        label = "inclination of the line of action at the impact",
        symbol = "θ",
        theory = "impact#corner-contact"
    )]
    pub theta_deg: Option<f64>,
    #[scalar(label = "equivalent mass at the impact")]
    pub equivalent_mass_kg: Option<f64>,
    #[scalar(label = "stiffness of the entering pair")]
    pub single_pair_stiffness_n_per_um: Option<f64>,
    #[scalar(label = "stiffness of the pairs in mesh")]
    pub other_pairs_stiffness_n_per_um: Option<f64>,
    /// Deflection of the pairs in mesh at the first contact, which the corner gap equals.
    #[scalar(label = "deflection at the first contact", theory = "impact#corner-contact")]
    pub corner_deflection_um: Option<f64>,
    /// Roll before the theoretical start of contact at which the tip corner touches.
    #[scalar(label = "roll before the theoretical start of contact", theory = "impact#corner-contact")]
    pub corner_overrun_mm: Option<f64>,
    #[scalar(label = "start of the impact", change = Absolute, theory = "impact#impact-duration")]
    pub start_mesh_periods: f64,
    /// Which law excites the response: `corner_contact`, `zhou2008`, `none` or `given`.
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    #[scalar(label = "law of the impact")]
    pub source: ImpactSource,
    /// Whether the pulse is put on the equations of motion; false: it is only reported.
    #[serde(default = "always_applied")]
    #[scalar(label = "impact in the equations of motion", theory = "vibration#mesh-force")]
    pub applied: bool,
    /// What it moves: `torsion` or `all` (bending and axial motion too).
    #[serde(default)]
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    #[scalar(label = "motions that the impact acts on", theory = "vibration#mesh-force")]
    pub acts_on: ActsOn,
}

/// Of results stored before impacts could be reported alone.
fn always_applied() -> bool {
    true
}
