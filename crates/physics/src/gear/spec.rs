//! Specification of a double-helical pair in SI, the input of [`Pair::new`](super::Pair::new).

use serde::{Deserialize, Serialize};

/// One of the two helix halves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Half {
    /// The left half.
    Left,
    /// The right half.
    Right,
}

impl Half {
    /// Left and right.
    pub const BOTH: [Half; 2] = [Half::Left, Half::Right];

    /// 0 for left, 1 for right: the order of every two-element array over halves.
    pub fn index(self) -> usize {
        match self {
            Half::Left => 0,
            Half::Right => 1,
        }
    }
}

/// Ends of the teeth that enter the mesh first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rotation {
    /// Each tooth enters at the inner ends, towards the apex.
    ApexLeading,
    /// Each tooth enters at the outer ends.
    ApexTrailing,
}

impl Rotation {
    /// The other direction of rotation of the same gears.
    pub fn reversed(self) -> Rotation {
        match self {
            Rotation::ApexLeading => Rotation::ApexTrailing,
            Rotation::ApexTrailing => Rotation::ApexLeading,
        }
    }
}

/// Linear-elastic, isotropic material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Young's modulus E.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio ν.
    pub poissons_ratio: f64,
    /// Density.
    pub density_kg_m3: f64,
}

impl Material {
    /// Steel: the defaults of the job document.
    pub const STEEL: Material = Material { youngs_modulus_pa: 206e9, poissons_ratio: 0.3, density_kg_m3: 7850.0 };

    /// Plane-strain compliance (1-ν²)/E. Those of both bodies add up to 1/E* of their contact (Hertz; Johnson, Contact
    /// Mechanics, 1985, equation 4.2c).
    pub fn plane_strain_compliance_per_pa(&self) -> f64 {
        (1.0 - self.poissons_ratio * self.poissons_ratio) / self.youngs_modulus_pa
    }
}

/// Course of a tip relief over its roll length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReliefShape {
    /// amount · (u / length), u the roll length counted from the start of the relief.
    Linear,
    /// amount · (u / length)².
    Parabolic,
}

/// Material removed at the tip, along the transverse base tangent. Zero length: no relief.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TipRelief {
    /// Largest amount removed.
    pub amount_m: f64,
    /// Roll length of the relief, from the tip along the path of contact.
    pub length_m: f64,
    /// Course over the length.
    pub shape: ReliefShape,
}

/// Material removed at both ends of the face width (parabolic from its start), along the transverse base tangent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EndRelief {
    /// Largest amount removed.
    pub amount_m: f64,
    /// Axial length of the relief at each end.
    pub length_m: f64,
}

/// Flank modifications of one member on one half: amounts removed in the transverse plane along the base tangent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FlankModification {
    /// Tip relief.
    pub tip_relief: TipRelief,
    /// Zero at mid-width, this value at both ends (parabola).
    pub lead_crowning_m: f64,
    /// Zero at the inner end, this value at the outer end (linear).
    pub helix_slope_m: f64,
    /// End relief.
    pub end_relief: EndRelief,
}

impl FlankModification {
    /// The unmodified flank.
    pub const NONE: FlankModification = FlankModification {
        tip_relief: TipRelief { amount_m: 0.0, length_m: 0.0, shape: ReliefShape::Parabolic },
        lead_crowning_m: 0.0,
        helix_slope_m: 0.0,
        end_relief: EndRelief { amount_m: 0.0, length_m: 0.0 },
    };
}

/// One member of the pair. Coefficients are multiples of the normal module.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GearSpec {
    /// Number of teeth z.
    pub teeth: u32,
    /// Profile shift coefficient x.
    pub profile_shift: f64,
    /// Addendum coefficient h*_aP.
    pub addendum: f64,
    /// Dedendum coefficient h*_fP of the generating rack.
    pub dedendum: f64,
    /// Tip rounding coefficient ρ*_fP of the generating rack.
    pub fillet_radius: f64,
    /// Tip alteration coefficient k (ISO 21771; negative shortens the tooth).
    pub tip_alteration: f64,
    /// Radius of the bore.
    pub bore_radius_m: f64,
    /// Material of this member; the pair's when `None`.
    pub material: Option<Material>,
    /// Face width of one half of this member; the pair's when `None`. At least the pair's: the excess,
    /// alike on both sides, carries no load.
    pub face_width_m: Option<f64>,
    /// Modifications of the left and the right half: of the flanks in contact while the pinion drives.
    pub flanks: [FlankModification; 2],
    /// Modifications of the other flanks, in contact while the pinion is driven; as `flanks` when `None`.
    pub coast_flanks: Option<[FlankModification; 2]>,
}

impl GearSpec {
    /// An unmodified solid gear without profile shift, cut by the rack 1.0/1.25/0.38.
    pub fn plain(teeth: u32) -> GearSpec {
        GearSpec {
            teeth,
            profile_shift: 0.0,
            addendum: 1.0,
            dedendum: 1.25,
            fillet_radius: 0.38,
            tip_alteration: 0.0,
            bore_radius_m: 0.0,
            material: None,
            face_width_m: None,
            flanks: [FlankModification::NONE; 2],
            coast_flanks: None,
        }
    }
}

/// Assembly errors of the pair; `Pair::initial_gap_m` states the sign conventions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Assembly {
    /// Working less nominal centre distance.
    pub center_distance_error_m: f64,
    /// Axis misalignment in the plane of action, over the face width of a half.
    pub in_plane_misalignment_m: f64,
    /// Axis misalignment perpendicular to the plane of action, over the face width of a half.
    pub out_of_plane_misalignment_m: f64,
    /// Axial offset of the apex of the pinion against that of the gear.
    pub apex_offset_m: f64,
}

impl Assembly {
    /// Mounted as designed.
    pub const NONE: Assembly = Assembly {
        center_distance_error_m: 0.0,
        in_plane_misalignment_m: 0.0,
        out_of_plane_misalignment_m: 0.0,
        apex_offset_m: 0.0,
    };
}

/// A double-helical pair as designed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairSpec {
    /// Normal module m_n.
    pub normal_module_m: f64,
    /// Pressure angle in the normal section.
    pub normal_pressure_angle_rad: f64,
    /// Helix angle β at the reference circle.
    pub helix_angle_rad: f64,
    /// Face width of one half that both members have in common: where the teeth bear.
    pub face_width_m: f64,
    /// Gap between the halves of the common face width.
    pub gap_width_m: f64,
    /// Working centre distance; derived from the profile shifts when `None`.
    pub center_distance_m: Option<f64>,
    /// Material of each member that names none of its own.
    pub material: Material,
    /// Ends of the teeth that enter first.
    pub rotation: Rotation,
    /// The pinion.
    pub pinion: GearSpec,
    /// The gear.
    pub gear: GearSpec,
    /// Assembly errors.
    pub assembly: Assembly,
}

impl PairSpec {
    /// Steel gears, apex leading, without gap or assembly errors, at the centre distance of their profile shifts.
    pub fn plain(
        normal_module_m: f64,
        [normal_pressure_angle_rad, helix_angle_rad]: [f64; 2],
        face_width_m: f64,
        [pinion, gear]: [GearSpec; 2],
    ) -> PairSpec {
        PairSpec {
            normal_module_m,
            normal_pressure_angle_rad,
            helix_angle_rad,
            face_width_m,
            gap_width_m: 0.0,
            center_distance_m: None,
            material: Material::STEEL,
            rotation: Rotation::ApexLeading,
            pinion,
            gear,
            assembly: Assembly::NONE,
        }
    }
}
