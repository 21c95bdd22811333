//! Input of the finite elements of a flank, and their errors.

use serde::Serialize;

use crate::gear::{Member, MemberId, Pair};
use crate::watch::Canceled;

/// Version of meshes, elements and load grid: part of every key, raised whenever a value may change.
pub const MESH_VERSION: u32 = 1;

/// Fineness of the elements and the load grid; `tools/src/bin/fe_validation.rs` prints cost and error of each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Resolution {
    /// Half the load grid in both directions.
    Coarse,
    /// About 11 profile nodes and one station per 0.57 normal modules, one element or spline cell per load cell.
    Medium,
    /// The load grid of `Medium`, two spline cells per load cell along the face.
    Standard,
    /// The load grid of `Medium`, elements and spline cells of half the size: for validation.
    Fine,
}

/// Everything the flexibility of one flank depends on: hash this (lengths in m, angles in rad).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FlankKey {
    /// [`MESH_VERSION`].
    pub mesh_version: u32,
    /// Fineness of elements and load grid.
    pub resolution: Resolution,
    /// Pinion or gear.
    pub side: MemberId,
    /// Number of teeth.
    pub teeth: u32,
    /// Normal module.
    pub normal_module_m: f64,
    /// Normal pressure angle.
    pub normal_pressure_angle_rad: f64,
    /// Helix angle at the reference circle.
    pub helix_angle_rad: f64,
    /// Profile shift coefficient.
    pub profile_shift: f64,
    /// Dedendum coefficient of the rack.
    pub dedendum: f64,
    /// Tip rounding coefficient of the rack.
    pub fillet_radius: f64,
    /// Radius of the tip circle.
    pub tip_radius_m: f64,
    /// Face width of one half.
    pub face_width_m: f64,
    /// Radius of the held cylinder.
    pub hold_radius_m: f64,
    /// Young's modulus.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Teeth ahead whose displacement is part of the result.
    pub offsets: usize,
}

/// One member of a pair, ready for the elements.
#[derive(Debug, Clone)]
pub struct FlankFlexibilityInput {
    key: FlankKey,
    member: Member,
    base_helix_angle_rad: f64,
}

impl FlankFlexibilityInput {
    /// The flank of one helix half of `side`, held at `hold_radius_m` (all displacements zero over the face width, end
    /// faces free), with displacements of the teeth up to `offsets` pitches ahead.
    pub fn new(
        pair: &Pair,
        side: MemberId,
        hold_radius_m: f64,
        offsets: usize,
        resolution: Resolution,
    ) -> FlankFlexibilityInput {
        let (member, spec) = match side {
            MemberId::Pinion => (&pair.pinion, &pair.spec.pinion),
            MemberId::Gear => (&pair.gear, &pair.spec.gear),
        };
        let key = FlankKey {
            mesh_version: MESH_VERSION,
            resolution,
            side,
            teeth: member.teeth,
            normal_module_m: pair.spec.normal_module_m,
            normal_pressure_angle_rad: pair.spec.normal_pressure_angle_rad,
            helix_angle_rad: pair.spec.helix_angle_rad,
            profile_shift: member.profile_shift,
            dedendum: spec.dedendum,
            fillet_radius: spec.fillet_radius,
            tip_radius_m: member.tip_radius_m,
            face_width_m: member.face_width_m,
            hold_radius_m,
            youngs_modulus_pa: member.material.youngs_modulus_pa,
            poissons_ratio: member.material.poissons_ratio,
            offsets,
        };
        FlankFlexibilityInput { key, member: member.clone(), base_helix_angle_rad: pair.base_helix_angle_rad }
    }

    /// All that the result depends on.
    pub fn key(&self) -> &FlankKey {
        &self.key
    }

    pub(super) fn member(&self) -> &Member {
        &self.member
    }

    /// Turn of the section per axial length, positive towards the loaded flank. The section is drawn with the loaded
    /// flank on the side of growing angle: the leading flank of the driving pinion, the trailing one of the gear.
    pub(super) fn twist_per_m(&self) -> f64 {
        let turn = self.base_helix_angle_rad.tan() / self.member.base_radius_m;
        match self.key.side {
            MemberId::Pinion => turn,
            MemberId::Gear => -turn,
        }
    }
}

/// Errors of the finite elements.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FeError {
    /// The calculation was canceled.
    #[error(transparent)]
    Canceled(#[from] Canceled),
    /// The held cylinder leaves no rim.
    #[error("the held radius {hold_radius_m} m leaves no rim below the root radius {root_radius_m} m")]
    NoRim {
        /// Radius of the held cylinder.
        hold_radius_m: f64,
        /// Radius of the root circle.
        root_radius_m: f64,
    },
    /// The flank or the tip land has no length.
    #[error("the tooth has no usable form: {what} is {value_m} m")]
    Form {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value_m: f64,
    },
    /// An element is turned inside out.
    #[error("element {element} of the tooth section is degenerate (Jacobian {jacobian:e} of its mean)")]
    Mesh {
        /// Index of the element.
        element: usize,
        /// Least over mean Jacobian determinant.
        jacobian: f64,
    },
    /// The stiffness matrix is not positive definite.
    #[error("the stiffness matrix is not positive definite ({place})")]
    Singular {
        /// The stage of the elimination.
        place: &'static str,
    },
    /// Stored bytes are not a flexibility of this version.
    #[error("the stored flexibility cannot be read: {reason}")]
    Stored {
        /// The reason.
        reason: &'static str,
    },
}
