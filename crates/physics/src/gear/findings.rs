//! Reasons why a design cannot be solved, and warnings of one that can, as types: which field of the [`PairSpec`] they
//! are about, and the numbers they rest on. Everything is SI; coefficients are multiples of the normal module.
//!
//! [`PairSpec`]: super::PairSpec

use serde::{Deserialize, Serialize};

/// Member of a pair (ISO 1122-1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MemberId {
    /// The member that drives at positive torque.
    Pinion,
    /// Its mate.
    Gear,
}

impl MemberId {
    /// Pinion and gear: the order of every two-element array over members.
    pub const BOTH: [MemberId; 2] = [MemberId::Pinion, MemberId::Gear];

    /// `pinion` or `gear`.
    pub fn as_str(self) -> &'static str {
        match self {
            MemberId::Pinion => "pinion",
            MemberId::Gear => "gear",
        }
    }

    /// The other member.
    pub fn mate(self) -> MemberId {
        match self {
            MemberId::Pinion => MemberId::Gear,
            MemberId::Gear => MemberId::Pinion,
        }
    }
}

/// A field of a [`PairSpec`](super::PairSpec).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SpecField {
    /// `normal_module_m`.
    NormalModule,
    /// `normal_pressure_angle_rad`.
    NormalPressureAngle,
    /// `helix_angle_rad`.
    HelixAngle,
    /// `face_width_m`.
    FaceWidth,
    /// `gap_width_m`.
    GapWidth,
    /// `center_distance_m`.
    CenterDistance,
    /// A field of `material`.
    Material(MaterialField),
    /// A field of `assembly`.
    Assembly(AssemblyField),
    /// A field of `pinion` or `gear`.
    Member(MemberId, GearField),
}

impl SpecField {
    /// The member the field belongs to, where it belongs to one.
    pub fn member(self) -> Option<MemberId> {
        match self {
            SpecField::Member(member, _) => Some(member),
            _ => None,
        }
    }
}

/// A field of a [`Material`](super::Material).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MaterialField {
    /// `youngs_modulus_pa`.
    YoungsModulus,
    /// `poissons_ratio`.
    PoissonsRatio,
    /// `density_kg_m3`.
    Density,
}

/// A field of an [`Assembly`](super::Assembly).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AssemblyField {
    /// `center_distance_error_m`.
    CenterDistanceError,
    /// `in_plane_misalignment_m`.
    InPlaneMisalignment,
    /// `out_of_plane_misalignment_m`.
    OutOfPlaneMisalignment,
    /// `apex_offset_m`.
    ApexOffset,
}

/// A field of a [`GearSpec`](super::GearSpec) or of its [`FlankModification`](super::FlankModification)s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum GearField {
    /// `teeth`.
    Teeth,
    /// `profile_shift`.
    ProfileShift,
    /// `addendum`.
    Addendum,
    /// `dedendum`.
    Dedendum,
    /// `fillet_radius`.
    FilletRadius,
    /// `tip_alteration`.
    TipAlteration,
    /// `bore_radius_m`.
    BoreRadius,
    /// `face_width_m`.
    FaceWidth,
    /// A field of `material`.
    Material(MaterialField),
    /// `tip_relief.amount_m`.
    TipReliefAmount,
    /// `tip_relief.length_m`.
    TipReliefLength,
    /// `lead_crowning_m`.
    LeadCrowning,
    /// `helix_slope_m`.
    HelixSlope,
    /// `end_relief.amount_m`.
    EndReliefAmount,
    /// `end_relief.length_m`.
    EndReliefLength,
}

/// A reason why a design cannot be solved, and the field that has to change.
#[derive(Debug, Clone, PartialEq)]
pub struct Infeasibility {
    /// The field of the design.
    pub field: SpecField,
    /// The reason.
    pub reason: InfeasibilityReason,
}

/// Reasons why a design cannot be solved.
#[derive(Debug, Clone, PartialEq)]
pub enum InfeasibilityReason {
    /// A stated value is not a number or outside the range in which the formulas hold; in the unit of the field.
    ValueOutOfRange {
        /// Stated value.
        value: f64,
        /// Least value.
        minimum: f64,
        /// Largest value.
        maximum: f64,
    },
    /// The generating rack is pointed before it reaches its dedendum.
    RackTipPointed {
        /// Stated coefficient.
        dedendum: f64,
        /// Coefficient at which the rack is pointed.
        limit: f64,
    },
    /// The tip rounding does not fit the generating rack.
    FilletRadiusTooLarge {
        /// Stated coefficient.
        fillet_radius: f64,
        /// Largest coefficient.
        limit: f64,
    },
    /// The root circle has no radius worth the name.
    RootCircleVanishes {
        /// Radius of the root circle.
        root_radius_m: f64,
        /// Least radius.
        limit_m: f64,
    },
    /// The tooth has no involute flank.
    NoInvolute {
        /// Radius of the tip circle.
        tip_radius_m: f64,
        /// Radius at which the involute starts, or of the base circle.
        start_radius_m: f64,
    },
    /// Undercut takes the whole thickness of the tooth.
    ToothCutOff {
        /// Thickness of the waist (negative), as a coefficient.
        thickness: f64,
    },
    /// The tooth ends pointed below its tip circle.
    PointedTip {
        /// Thickness at the tip circle in the normal section, as a coefficient.
        thickness: f64,
    },
    /// The bore reaches the root circle.
    BoreTooLarge {
        /// Radius of the bore.
        bore_radius_m: f64,
        /// Radius of the root circle.
        root_radius_m: f64,
    },
    /// No centre distance brings both flanks into contact.
    ProfileShiftSumTooSmall {
        /// Sum of the profile shift coefficients.
        sum: f64,
        /// Least sum.
        limit: f64,
    },
    /// The base circles touch or overlap at the working centre distance.
    CenterDistanceTooSmall {
        /// Sum of the base radii.
        base_radius_sum_m: f64,
        /// Matching centre distance and profile shifts.
        fit: CenterDistanceFit,
    },
    /// The tip passes the base tangent point of the mate and cuts into the tooth that the cutter has left there.
    TipInterference {
        /// Depth of the cut, as a coefficient.
        cut: f64,
        /// Stated addendum coefficient.
        addendum: f64,
        /// Largest addendum coefficient.
        limit: f64,
    },
    /// The tip cuts into the root fillet of the mate.
    FilletInterference {
        /// Depth of the cut, as a coefficient.
        cut: f64,
        /// Largest depth.
        limit: f64,
    },
    /// The tip reaches into the root circle of the mate.
    NoTipClearance {
        /// Tip clearance (negative), as a coefficient.
        clearance: f64,
    },
    /// Lines of contact are missing during a part of the mesh period.
    ContactRatioBelowOne {
        /// Transverse contact ratio.
        transverse: f64,
        /// Overlap ratio.
        overlap: f64,
        /// True where undercut shortens the path of contact of either member.
        undercut: bool,
    },
    /// Teeth of nominal thickness overlap by more than thinner teeth could make up for.
    FlanksOverlap {
        /// Backlash along the transverse base tangent (negative).
        backlash_m: f64,
        /// Largest overlap.
        limit_m: f64,
        /// The same as a coefficient.
        limit: f64,
    },
    /// The working centre distance does not belong to the profile shifts.
    CenterDistanceDoesNotFit {
        /// Centre distance without backlash for the profile shifts (the nearest that exists).
        fitting_m: f64,
        /// Matching centre distance and profile shifts.
        fit: CenterDistanceFit,
        /// Infeasibilities at the working centre distance that the fitting one does not have; never empty.
        consequences: Vec<Consequence>,
    },
}

/// A consequence of a centre distance that does not belong to the profile shifts.
#[derive(Debug, Clone, PartialEq)]
pub enum Consequence {
    /// A reason of its own.
    Infeasible(Infeasibility),
    /// The transverse contact ratio falls below 1 with more backlash than any allowance asks for.
    ContactRatioLost {
        /// Transverse contact ratio at the fitting centre distance.
        fitting: f64,
        /// Transverse contact ratio at the working centre distance.
        working: f64,
        /// Backlash along the transverse base tangent, as a coefficient.
        backlash: f64,
        /// Largest backlash, as a coefficient.
        limit: f64,
    },
}

/// A working centre distance, and the centre distance and profile shifts that belong together without backlash.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CenterDistanceFit {
    /// Working centre distance.
    pub center_distance_m: f64,
    /// Sum of the given profile shift coefficients.
    pub shift_sum: f64,
    /// Centre distance that the given profile shifts fit; `None` where there is none.
    pub fitting_center_distance_m: Option<f64>,
    /// Sum of the profile shift coefficients that fits the working centre distance; `None` where there is none.
    pub fitting_shift_sum: Option<f64>,
}

/// A property of a design that is solved all the same, and the field it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    /// The field of the design.
    pub field: SpecField,
    /// The reason.
    pub reason: WarningReason,
}

/// Reasons for a warning of a feasible design.
#[derive(Debug, Clone, PartialEq)]
pub enum WarningReason {
    /// The tooth is undercut.
    Undercut {
        /// Profile shift coefficient.
        profile_shift: f64,
        /// Coefficient below which there is undercut.
        limit: f64,
        /// Radius at which the involute starts.
        form_radius_m: f64,
    },
    /// The tip is thinner than usual practice allows.
    ThinTip {
        /// Thickness at the tip circle in the normal section, as a coefficient.
        thickness: f64,
        /// Usual least thickness.
        limit: f64,
    },
    /// The rim is so thin that it adds to the stress and the deflection of the tooth root.
    ThinRim {
        /// Thickness between bore and root circle.
        thickness_m: f64,
        /// Least thickness, in tooth heights.
        limit_tooth_heights: f64,
    },
    /// The tip dips into the nominal root fillet of the mate.
    FilletInterference {
        /// Depth.
        cut_m: f64,
    },
    /// The tip clearance is small.
    SmallTipClearance {
        /// Clearance, as a coefficient.
        clearance: f64,
        /// Usual least clearance.
        limit: f64,
    },
    /// The overlap ratio alone keeps lines of contact at every phase.
    TransverseContactRatioBelowOne {
        /// Transverse contact ratio.
        transverse: f64,
        /// Overlap ratio.
        overlap: f64,
        /// True where undercut shortens the path of contact of either member.
        undercut: bool,
        /// Shortest length of the lines of contact over their mean.
        shortest_over_mean: f64,
    },
    /// Teeth of nominal thickness overlap and have to be thinner.
    NegativeBacklash {
        /// Backlash along the transverse base tangent (negative).
        backlash_m: f64,
        /// Matching centre distance and profile shifts.
        fit: CenterDistanceFit,
    },
    /// The backlash is larger than the allowances of ISO/TR 10064-2.
    LargeBacklash {
        /// Backlash along the transverse base tangent.
        backlash_m: f64,
        /// Matching centre distance and profile shifts.
        fit: CenterDistanceFit,
    },
    /// The tip relief is longer than the path of contact.
    TipReliefOverWholePath {
        /// Roll length of the relief.
        length_m: f64,
        /// Length of the path of contact.
        path_m: f64,
    },
}
