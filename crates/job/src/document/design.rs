//! The gear pair: teeth, flanks, supports, assembly errors.

use super::arrangement;
use super::shafts::ShaftsInput;
use crate::field::Input;
use crate::reader::ObjectPlace;
use herringbone_macros::{Input, Words};
use serde::Serialize;
use std::sync::LazyLock;

/// Backlash along s where none is given, µm: that of the source.
pub const DEFAULT_BACKLASH_UM: f64 = 2.0;

/// The gear pair: teeth, flanks, material, supports and assembly errors.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "gears", rules = design_rules)]
pub struct DesignInput {
    /// Normal module m_n.
    #[input(unit = "mm", min = 0.1, max = 100.0, symbol = "m_n")]
    pub normal_module_mm: f64,
    /// Pressure angle of the rack.
    #[input(unit = "deg", min = 10.0, max = 35.0, default = 20.0, symbol = "α")]
    pub pressure_angle_deg: f64,
    /// Section in which the pressure angle is given.
    #[input(default = PressureAnglePlane::Normal)]
    pub pressure_angle_plane: PressureAnglePlane,
    /// Helix angle at the reference circle.
    #[input(unit = "deg", min = 0.0, max = 50.0, symbol = "β", group = "widths")]
    pub helix_angle_deg: f64,
    /// Face width of one half.
    #[input(unit = "mm", min = 0.5, max = 2000.0, symbol = "b", group = "widths")]
    pub face_width_mm: f64,
    /// Width of the gap between the halves.
    #[input(unit = "mm", min = 0.0, max = 1000.0, default = 30.0, group = "widths")]
    pub gap_width_mm: f64,
    /// Working centre distance; derived from the profile shifts when null.
    #[input(unit = "mm", min = 1.0, max = 20_000.0, symbol = "a_w")]
    pub center_distance_mm: Option<f64>,
    /// Total play along the direction of the mesh displacement s; the source's 2 um when it is not given.
    #[input(unit = "um", min = 0.0, max = 5000.0, default = DEFAULT_BACKLASH_UM)]
    pub backlash_um: Option<f64>,
    /// Stagger of the right half as a fraction of the transverse pitch.
    #[input(min = 0.0, max = 1.0, default = 0.0, group = "widths")]
    pub half_stagger: f64,
    /// Material of both gears.
    #[input(first)]
    pub material: MaterialInput,
    /// The driving gear.
    #[input(first, required, base = GearInput::of_pair(Hand::Left, &material))]
    pub pinion: GearInput,
    /// The driven gear.
    #[input(
        first,
        required,
        base = GearInput::of_pair(pinion.left_half_hand.opposite(), &material),
        derived(left_half_hand = "opposite of the pinion's")
    )]
    pub gear: GearInput,
    /// Springs of each half, in place of shafts and bearings.
    pub supports: SupportsInput,
    /// Shafts with their bearings, in place of the supports; without them the bodies stand on the supports.
    #[input(group = "shafts")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shafts: Option<ShaftsInput>,
    /// Assembly errors.
    pub assembly: AssemblyInput,
}

fn design_rules(design: &mut DesignInput, place: &ObjectPlace) {
    if design.pinion.left_half_hand == design.gear.left_half_hand {
        place.conflict(
            "gear/left_half_hand",
            "is the same hand as the pinion's left half; mating halves of an external pair have opposite hands",
        );
    }
    // A gear that is wider than the design needs room for that in the gap.
    let widest_mm = design.face_width_mm + design.gap_width_mm;
    for (name, gear) in [("pinion/face_width_mm", &design.pinion), ("gear/face_width_mm", &design.gear)] {
        if let Some(width_mm) = gear.face_width_mm.filter(|width_mm| *width_mm > widest_mm) {
            let detail = format!(
                "is {width_mm} mm; its halves, centred on halves of {} mm (face_width_mm) that stand {} mm apart (gap_width_mm), \
                 would overlap above {widest_mm} mm",
                design.face_width_mm, design.gap_width_mm
            );
            place.conflict(name, detail);
        }
    }
    arrangement::design_and_shafts(design, place);
}

/// Section in which the pressure angle of the rack is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum PressureAnglePlane {
    /// Perpendicular to the teeth.
    Normal,
    /// Perpendicular to the axis.
    Transverse,
}

/// An elastic, isotropic material.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct MaterialInput {
    /// Young's modulus.
    #[input(unit = "GPa", min = 1.0, max = 1000.0, default = 206.0, symbol = "E")]
    pub youngs_modulus_gpa: f64,
    /// Poisson's ratio.
    #[input(min = 0.0, max = 0.49, default = 0.3, symbol = "ν")]
    pub poissons_ratio: f64,
    /// Density.
    #[input(unit = "kg/m3", min = 100.0, max = 30_000.0, default = 7850.0, symbol = "ρ")]
    pub density_kg_m3: f64,
}

/// Hand of a helix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum Hand {
    Left,
    Right,
}

impl Hand {
    /// The hand of a mating half of an external pair.
    pub fn opposite(self) -> Hand {
        match self {
            Hand::Left => Hand::Right,
            Hand::Right => Hand::Left,
        }
    }
}

/// One gear of the pair, with both halves.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "gears")]
pub struct GearInput {
    /// Number of teeth.
    #[input(min = 5, max = 1000, symbol = "z")]
    pub teeth: u32,
    /// Hand of the left half's helix.
    #[input(default = Hand::Left, group = "widths")]
    pub left_half_hand: Hand,
    /// Profile shift coefficient x.
    #[input(min = -2.0, max = 2.0, default = 0.0, symbol = "x", group = "tooth-form")]
    pub profile_shift: f64,
    /// Addendum of the rack, multiple of the normal module.
    #[input(min = 0.3, max = 2.5, default = 1.0, symbol = "h*_aP", group = "tooth-form")]
    pub addendum: f64,
    /// Dedendum of the rack, multiple of the normal module.
    #[input(min = 0.3, max = 3.0, default = 1.25, symbol = "h*_fP", group = "tooth-form")]
    pub dedendum: f64,
    /// Root fillet radius of the rack, multiple of the normal module.
    #[input(min = 0.0, max = 1.0, default = 0.38, symbol = "ρ*_fP", group = "tooth-form")]
    pub fillet_radius: f64,
    /// Tip alteration coefficient k; negative shortens the tooth.
    #[input(min = -1.0, max = 0.5, default = 0.0, symbol = "k", group = "tooth-form")]
    pub tip_alteration: f64,
    /// Bore; 0.4 of the reference diameter when null.
    #[input(unit = "mm", min = 0.0, max = 20_000.0)]
    pub bore_diameter_mm: Option<f64>,
    /// Mass of the whole gear; a solid disc of both halves when null.
    #[input(unit = "kg", min = 1e-6, max = 1e6)]
    pub mass_kg: Option<f64>,
    /// Moment of inertia of the whole gear; a solid disc of both halves when null.
    #[input(unit = "kg m2", min = 1e-9, max = 1e9, symbol = "J")]
    pub inertia_kg_m2: Option<f64>,
    /// Face width of one half of this gear; the design's when null. What both gears have in common, centred, bears.
    #[input(unit = "mm", min = 0.5, max = 2000.0, symbol = "b", group = "widths")]
    pub face_width_mm: Option<f64>,
    /// Material of this gear where it differs.
    ///
    /// Its defaults are those of the design's material.
    #[input(derived = "as both gears")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialInput>,
    /// Modifications of the drive flanks of both halves.
    #[input(flatten, first)]
    #[serde(flatten)]
    pub flank: FlankInput,
    /// Flank modifications of the left half where they differ.
    #[input(first, base = flank.clone(), derived = "as both halves")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<FlankInput>,
    /// Flank modifications of the right half where they differ.
    #[input(first, base = flank.clone(), derived = "as both halves")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right: Option<FlankInput>,
    /// Flank modifications of the other flanks, in contact under negative torque, where they differ.
    #[input(first, base = CoastInput::of_both(&flank), derived = "as the drive flank")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coast: Option<CoastInput>,
}

impl GearInput {
    /// The defaults of a gear in a pair.
    fn of_pair(left_half_hand: Hand, material: &MaterialInput) -> Self {
        static DEFAULTS: LazyLock<GearInput> = LazyLock::new(GearInput::defaults);
        Self { left_half_hand, material: Some(material.clone()), ..DEFAULTS.clone() }
    }
}

/// Modifications of the flanks that are in contact under negative torque.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct CoastInput {
    /// Modifications of both halves.
    #[input(flatten)]
    #[serde(flatten)]
    pub flank: FlankInput,
    /// Flank modifications of the left half where they differ.
    #[input(base = flank.clone(), derived = "as both halves")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<FlankInput>,
    /// Flank modifications of the right half where they differ.
    #[input(base = flank.clone(), derived = "as both halves")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right: Option<FlankInput>,
}

impl CoastInput {
    /// Those of one flank on both halves.
    fn of_both(flank: &FlankInput) -> Self {
        Self { flank: flank.clone(), left: None, right: None }
    }
}

/// Flank modifications: material removed, measured in the transverse plane along the base tangent.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "micro-geometry")]
pub struct FlankInput {
    /// Tip relief.
    #[input(first)]
    pub tip_relief: TipReliefInput,
    /// Crowning: zero at mid-width, this at both ends.
    #[input(unit = "um", min = -500.0, max = 1000.0, default = 0.0, symbol = "C_β")]
    pub lead_crowning_um: f64,
    /// Helix slope: zero at the inner end, this at the outer.
    #[input(unit = "um", min = -1000.0, max = 1000.0, default = 0.0, symbol = "C_Hβ")]
    pub helix_slope_um: f64,
    /// End relief at both ends of the face width.
    #[input(first, order = 1)]
    pub end_relief: EndReliefInput,
}

/// Tip relief.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(rules = tip_relief_rules)]
pub struct TipReliefInput {
    /// Relief at the tip.
    #[input(unit = "um", min = 0.0, max = 1000.0, default = 0.0, symbol = "C_αa")]
    pub amount_um: f64,
    /// Roll length along the path of contact from the tip.
    #[input(unit = "mm", min = 0.0, max = 500.0, default = 0.0, symbol = "L_Cαa")]
    pub length_mm: f64,
    /// Course over the length.
    #[input(default = ReliefShapeInput::Parabolic)]
    pub shape: ReliefShapeInput,
}

fn tip_relief_rules(relief: &mut TipReliefInput, place: &ObjectPlace) {
    if relief.amount_um > 0.0 && relief.length_mm == 0.0 {
        place.conflict("length_mm", "is 0 mm while amount_um is above 0; a relief needs a roll length above 0 mm");
    }
}

/// Course of a tip relief over its roll length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum ReliefShapeInput {
    Linear,
    Parabolic,
}

/// End relief.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(rules = end_relief_rules)]
pub struct EndReliefInput {
    /// Relief at the ends.
    #[input(unit = "um", min = 0.0, max = 1000.0, default = 0.0)]
    pub amount_um: f64,
    /// Axial length of the relief.
    #[input(unit = "mm", min = 0.0, max = 1000.0, default = 0.0)]
    pub length_mm: f64,
}

fn end_relief_rules(relief: &mut EndReliefInput, place: &ObjectPlace) {
    if relief.amount_um > 0.0 && relief.length_mm == 0.0 {
        place.conflict("length_mm", "is 0 mm while amount_um is above 0; a relief needs a length above 0 mm");
    }
}

/// Shafts and bearings, per half. A spring that is null is derived (`study::supports`), one of zero is absent.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "supports")]
pub struct SupportsInput {
    /// Lateral support of each pinion half; scaled with the centre distance when null.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub pinion_lateral_n_per_um: Option<f64>,
    /// Lateral support of each gear half; scaled with the centre distance when null.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub gear_lateral_n_per_um: Option<f64>,
    /// Axial spring between the pinion halves; that of the gear body when null.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub pinion_halves_axial_n_per_um: Option<f64>,
    /// Axial support of each gear half; scaled with the centre distance when null.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub gear_axial_n_per_um: Option<f64>,
    /// Axial spring between the gear halves; that of the gear body when null.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub gear_halves_axial_n_per_um: Option<f64>,
    /// Damping ratio of supports and couplings.
    #[input(min = 0.0, max = 2.0, default = 0.03, symbol = "ζ")]
    pub damping_ratio: f64,
    /// Torsional spring between the pinion halves; that of the gear body when null, 0 (none) in the source's model.
    #[input(unit = "N m/rad", min = 0.0, max = 1e13)]
    pub pinion_halves_torsional_nm_per_rad: Option<f64>,
    /// Torsional spring between the gear halves; that of the gear body when null, 0 (none) in the source's model.
    #[input(unit = "N m/rad", min = 0.0, max = 1e13)]
    pub gear_halves_torsional_nm_per_rad: Option<f64>,
    /// Lateral (bending) spring between the pinion halves; that of the gear body when null, 0 (none) in the source's model.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub pinion_halves_lateral_n_per_um: Option<f64>,
    /// Lateral (bending) spring between the gear halves; that of the gear body when null, 0 (none) in the source's model.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub gear_halves_lateral_n_per_um: Option<f64>,
}

/// Assembly errors.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "assembly")]
pub struct AssemblyInput {
    /// Added to the centre distance.
    #[input(unit = "um", min = -2000.0, max = 2000.0, default = 0.0)]
    pub center_distance_error_um: f64,
    /// Linear gap over the face width of one half, in the plane of action of the drive flanks.
    #[input(unit = "um", min = -2000.0, max = 2000.0, default = 0.0)]
    pub in_plane_misalignment_um: f64,
    /// Linear deviation over the face width of one half, out of the plane of action of the drive flanks; positive turns the left half's
    /// outer end away from the gear.
    #[input(unit = "um", min = -2000.0, max = 2000.0, default = 0.0)]
    pub out_of_plane_misalignment_um: f64,
    /// Axial offset between the apexes of pinion and gear.
    #[input(unit = "um", min = -2000.0, max = 2000.0, default = 0.0)]
    pub apex_offset_um: f64,
}
