//! Springs of the equations of motion.

use super::{ResultFields, SpringOrigin};
use serde::{Deserialize, Serialize};

/// Supports of each half and couplings between the halves of a gear, as they stand in the equations; of a sweep those of its base document.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Supports))]
#[scalar(theory = "vibration#supports-and-couplings")]
pub struct SupportsResult {
    #[scalar(label = "lateral support, pinion")]
    pub pinion_lateral_n_per_um: SpringValue,
    #[scalar(label = "lateral support, gear")]
    pub gear_lateral_n_per_um: SpringValue,
    #[scalar(label = "axial support, gear")]
    pub gear_axial_n_per_um: SpringValue,
    #[scalar(label = "axial coupling of the halves, pinion")]
    pub pinion_halves_axial_n_per_um: SpringValue,
    #[scalar(label = "axial coupling of the halves, gear")]
    pub gear_halves_axial_n_per_um: SpringValue,
    #[scalar(label = "lateral coupling of the halves, pinion")]
    pub pinion_halves_lateral_n_per_um: SpringValue,
    #[scalar(label = "lateral coupling of the halves, gear")]
    pub gear_halves_lateral_n_per_um: SpringValue,
    #[scalar(label = "torsional coupling of the halves, pinion")]
    pub pinion_halves_torsional_nm_per_rad: SpringValue,
    #[scalar(label = "torsional coupling of the halves, gear")]
    pub gear_halves_torsional_nm_per_rad: SpringValue,
}

/// A stiffness in the unit of its name, and where it came from.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SpringValue {
    #[scalar(inherits)]
    pub value: f64,
    /// `given` by the document, `derived` from the gear body, or `assumed` after the size of the pair.
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    #[scalar(label = "origin")]
    pub origin: SpringOrigin,
}
