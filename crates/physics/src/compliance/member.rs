//! Compliance of one member: its tooth and its ring, held at rim or bore.

use serde::{Deserialize, Serialize};

use super::bulk::{BulkCompliance, BulkInput, NODES};
use super::edge::EndFaces;
use super::ring::{Ring, WidthBasis};
use super::ring_influence::{RingFlexibility, ToothLayout, ring_weight};
use super::tooth::{ProfilePoint, RootRemainder, Tooth, ToothProfile, compression, plate};
use crate::gear::{Member, Pair};
use crate::watch::{Canceled, Watch};

/// Surface on which the gear bodies are held (all displacements zero on a cylinder over the face width, end faces
/// free).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyHold {
    /// Three normal modules below the root circles: teeth and rims, for dynamic models with rigid gear bodies.
    Rim,
    /// At the bores: blank torsion, in-plane and disc bending included.
    Bore,
}

/// Depth of the rim below the root circle, in normal modules.
const RIM_DEPTH: f64 = 3.0;
/// The held cylinder is never smaller than this part of the root circle: below it a solid pinion counts as its shaft.
const SMALLEST_HOLD: f64 = 0.3;
/// Outermost radial element of the ring, in normal modules.
const RING_ELEMENT: f64 = 0.55;

/// Radius at which `member` is held.
pub fn hold_radius_m(member: &Member, hold: BodyHold, normal_module_m: f64) -> f64 {
    let root = member.root_radius_m;
    let bore = member.bore_radius_m.min(root - 0.5 * normal_module_m);
    let radius = match hold {
        BodyHold::Rim => bore.max(root - RIM_DEPTH * normal_module_m),
        BodyHold::Bore => bore,
    };
    radius.max(SMALLEST_HOLD * root)
}

/// Degree of the Legendre functions along the face, by the face width in normal modules: about six per wavelength of
/// the shortest wave that teeth and ring follow, four modules.
pub(super) fn width_order(width_modules: f64) -> usize {
    (4.0 + 0.5 * width_modules).ceil().clamp(5.0, 26.0) as usize
}

/// Compliance of one member.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MemberCompliance {
    tooth: Tooth,
    /// All compliance of tooth and body between slices and places of the profile, contact indentation excepted.
    pub bulk: BulkCompliance,
    side: f64,
    path_nodes_m: [f64; NODES],
}

impl MemberCompliance {
    /// The pinion (`side` +1) or the gear (`side` -1) of `pair`, for `slices` of the common face width and teeth up to
    /// `offsets` pitches apart. Tooth and ring have the member's own width, with the common one in their middle.
    ///
    /// # Errors
    /// [`Canceled`].
    pub(super) fn new(
        pair: &Pair,
        side: f64,
        hold: BodyHold,
        slices: usize,
        offsets: usize,
        watch: Watch,
    ) -> Result<MemberCompliance, Canceled> {
        let member = if side > 0.0 { &pair.pinion } else { &pair.gear };
        let rolls = if side > 0.0 {
            (pair.path_start_m, pair.path_end_m)
        } else {
            (pair.line_of_action_m - pair.path_end_m, pair.line_of_action_m - pair.path_start_m)
        };
        let module = pair.spec.normal_module_m;
        let material = &member.material;
        let twist = pair.base_helix_angle_rad.tan() / member.base_radius_m;
        let form = ToothProfile {
            base_radius_m: member.base_radius_m,
            root_radius_m: member.root_radius_m,
            tip_radius_m: member.tip_radius_m,
            base_half_angle_rad: member.base_half_angle_rad,
            root_half_angle_rad: member.root_half_angle_rad(),
            base_helix_angle_rad: pair.base_helix_angle_rad,
            normal_module_m: module,
            half_angle: &|r| member.half_angle_rad(r),
        };
        let (e, nu) = (material.youngs_modulus_pa, material.poissons_ratio);
        let tooth = Tooth::new(&form);
        let ring = Ring {
            outer_radius_m: member.root_radius_m,
            inner_radius_m: hold_radius_m(member, hold, module),
            face_width_m: member.face_width_m,
            element_m: RING_ELEMENT * module,
            youngs_pa: e,
            nu,
        };
        let layout = ToothLayout {
            teeth: member.teeth,
            root_half_angle_rad: member.root_half_angle_rad(),
            twist_per_m: twist,
            root_helix_angle_rad: (member.root_radius_m * twist).atan(),
            normal_module_m: module,
            side,
        };
        // Chebyshev nodes of the path.
        let path_nodes_m: [f64; NODES] = std::array::from_fn(|i| {
            let angle = std::f64::consts::PI * (2 * i + 1) as f64 / (2 * NODES) as f64;
            0.5 * (rolls.0 + rolls.1) - 0.5 * (rolls.1 - rolls.0) * angle.cos()
        });
        let places = path_nodes_m.map(|roll| tooth.at(roll, side));
        let basis = WidthBasis::new(width_order(member.face_width_m / module), member.face_width_m);
        // Excess width of the member over the bearing part, at either end.
        let margin_m = 0.5 * (member.face_width_m - pair.spec.face_width_m);
        let input = BulkInput {
            plate: &plate(&form, nu, &basis),
            root: &RootRemainder::new(&form, nu, &|wave| 1.0 - ring_weight(wave, module)),
            ring: &RingFlexibility::new(&ring, &basis, &layout, offsets, watch)?,
            ends: EndFaces::new(pair.base_helix_angle_rad, side, (pair.spec.face_width_m, margin_m), slices, (e, nu)),
            basis: &basis,
            places: &places,
            compression_m: places.map(|p| compression(&form, nu, p.lever_m)),
            youngs_pa: e,
            root_radius_m: member.root_radius_m,
            root_helix_angle_rad: layout.root_helix_angle_rad,
            slices,
            bearing_m: (margin_m, pair.spec.face_width_m),
        };
        let bulk = BulkCompliance::new(&input, watch)?;
        Ok(MemberCompliance { tooth, bulk, side, path_nodes_m })
    }

    /// Rolls between which the flexibility is interpolated.
    pub(super) fn path_nodes_m(&self) -> &[f64] {
        &self.path_nodes_m
    }

    /// Interpolation weights of the bulk compliance at roll length `roll_m`.
    #[cfg(test)]
    pub(super) fn weights(&self, roll_m: f64) -> [f64; NODES] {
        let places = &self.path_nodes_m;
        std::array::from_fn(|a| {
            (0..NODES).filter(|&b| b != a).map(|b| (roll_m - places[b]) / (places[a] - places[b])).product()
        })
    }

    /// The tooth at roll length `roll_m` of this member.
    pub(super) fn at(&self, roll_m: f64) -> ProfilePoint {
        self.tooth.at(roll_m, self.side)
    }
}
