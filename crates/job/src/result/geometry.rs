//! Geometry of the pair and of its gears.

use super::ResultFields;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "geometry#diameters-angles-and-pitches")]
pub struct Geometry {
    #[scalar(symbol = "ε_α", headline, theory = "geometry#contact-ratios")]
    pub transverse_contact_ratio: f64,
    #[scalar(symbol = "ε_β", headline, theory = "geometry#contact-ratios")]
    pub overlap_ratio: f64,
    #[scalar(
        theory = "geometry#contact-ratios",
        symbol = "ε_γ",
        headline,
        help = "Transverse contact ratio plus overlap ratio of one half, from the geometry. The loaded one counts the contact that \
                deflection adds before and after the theoretical path, and what modifications take away."
    )]
    pub total_contact_ratio: f64,
    #[scalar(symbol = "α_wt", headline = 1)]
    pub working_pressure_angle_deg: f64,
    #[scalar(symbol = "a", headline)]
    pub center_distance_mm: f64,
    #[scalar(headline = 1, theory = "geometry#speed-torque-and-mesh-frequency")]
    pub mesh_frequency_hz: f64,
    #[scalar(symbol = "α_t")]
    pub transverse_pressure_angle_deg: f64,
    #[scalar(symbol = "α_n")]
    pub normal_pressure_angle_deg: f64,
    #[scalar(symbol = "β_b")]
    pub base_helix_angle_deg: f64,
    #[scalar(symbol = "p_bt")]
    pub transverse_base_pitch_mm: f64,
    #[scalar(label = "length of the path of contact", symbol = "g_α", theory = "geometry#contact-ratios")]
    pub path_of_contact_mm: f64,
    /// Face width of one half that both gears have in common, and the gap between those of the halves.
    #[serde(default)]
    #[scalar(label = "common face width of one half", symbol = "b")]
    pub face_width_mm: Option<f64>,
    #[serde(default)]
    #[scalar(label = "gap between the halves")]
    pub gap_width_mm: Option<f64>,
    #[scalar(label = "pinion")]
    pub pinion: GearGeometry,
    #[scalar(label = "gear")]
    pub gear: GearGeometry,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "geometry#diameters-angles-and-pitches")]
pub struct GearGeometry {
    #[scalar(symbol = "d")]
    pub reference_diameter_mm: f64,
    #[scalar(symbol = "d_b")]
    pub base_diameter_mm: f64,
    #[scalar(symbol = "d_a")]
    pub tip_diameter_mm: f64,
    #[scalar(symbol = "d_f")]
    pub root_diameter_mm: f64,
    #[scalar(symbol = "d_Ff", theory = "geometry#tooth-form")]
    pub root_form_diameter_mm: f64,
    #[scalar(label = "normal tooth thickness at the tip", symbol = "s_an", theory = "geometry#tooth-form")]
    pub tip_thickness_normal_mm: f64,
    #[scalar(symbol = "d_i", theory = "geometry#mass-and-moment-of-inertia")]
    pub bore_diameter_mm: f64,
    /// Face width of one half of this gear.
    #[serde(default)]
    #[scalar(label = "face width of one half")]
    pub face_width_mm: Option<f64>,
    #[scalar(symbol = "m", theory = "geometry#mass-and-moment-of-inertia")]
    pub mass_kg: f64,
    #[scalar(label = "moment of inertia", symbol = "J", theory = "geometry#mass-and-moment-of-inertia")]
    pub inertia_kg_m2: f64,
}
