//! One tooth: its profile, the points at which loads meet its middle surface, and the short-wave compliance of its
//! root.
//!
//! The normal section is what bends. The flank normal meets the middle surface of the tooth at the radius y_c, where it
//! has the components cosβ_b cosα' (tangential), cosβ_b sinα' (radial) and sinβ_b (axial), cosα' = r_b / y_c. Its part
//! in the tangent plane of the cylinder through y_c is exactly perpendicular to the tooth trace there, so that in the
//! normal section sinα'_n = cosβ_b sinα': the part cosα'_n bends the tooth as a plate (`plate`), the part sinα'_n
//! presses it along its height. The axial component moves the meeting point along the face by depth × sinβ_b: on the
//! acute side of a helical tooth's end face beyond its end, on the obtuse side inwards.
//!
//! The displacement meant is that of the middle surface along the load line: the contact indentation above it is
//! `hertz`'s.

use super::annulus::arc_flexibility;
use super::plate::{Plate, PlateModes};
use super::ring::WidthBasis;
use crate::numerics::gauss::gauss_12;

/// Profile and position of one tooth form, in SI.
pub(super) struct ToothProfile<'a> {
    /// Base radius.
    pub base_radius_m: f64,
    /// Radius of the root circle.
    pub root_radius_m: f64,
    /// Radius of the tip circle.
    pub tip_radius_m: f64,
    /// Half angle of the tooth at the base circle.
    pub base_half_angle_rad: f64,
    /// Half angle of the tooth at the root circle.
    pub root_half_angle_rad: f64,
    /// Base helix angle.
    pub base_helix_angle_rad: f64,
    /// Normal module.
    pub normal_module_m: f64,
    /// Half angle of the tooth at a radius between root and tip.
    pub half_angle: &'a dyn Fn(f64) -> f64,
}

/// One tooth of a member.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tooth {
    base_radius_m: f64,
    root_radius_m: f64,
    base_half_angle_rad: f64,
    base_helix: (f64, f64),
}

/// Unit normal force at one place of the profile, as the tooth takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ProfilePoint {
    /// Components of the flank normal: tangential, radial (outwards), axial (with the sign of the member's side).
    pub tangential: f64,
    /// Radial component, outwards.
    pub radial: f64,
    /// Axial component, with the sign of the member's side.
    pub axial: f64,
    /// In the normal section: across the tooth and along its height.
    pub lateral: f64,
    /// Component along the height of the tooth in the normal section.
    pub normal_sin: f64,
    /// Height of the meeting point with the middle surface above the root circle.
    pub lever_m: f64,
    /// Distance of the meeting point along the flank normal.
    pub depth_m: f64,
    /// Way of the meeting point along the face, from the contact.
    pub shift_m: f64,
}

impl Tooth {
    /// The tooth of a profile.
    pub(super) fn new(form: &ToothProfile<'_>) -> Tooth {
        Tooth {
            base_radius_m: form.base_radius_m,
            root_radius_m: form.root_radius_m,
            base_half_angle_rad: form.base_half_angle_rad,
            base_helix: form.base_helix_angle_rad.sin_cos(),
        }
    }

    /// The place at roll length `roll_m`; `side` is +1 or -1, the sign of the axial force in the body's coordinates.
    pub(super) fn at(&self, roll_m: f64, side: f64) -> ProfilePoint {
        let (sin_b, cos_b) = self.base_helix;
        let at = self.crossing(roll_m);
        ProfilePoint {
            tangential: cos_b * at.cos,
            radial: -cos_b * at.sin,
            axial: side * sin_b,
            lateral: (1.0 - at.normal_sin * at.normal_sin).sqrt(),
            normal_sin: at.normal_sin,
            lever_m: at.lever_m,
            depth_m: at.depth_m,
            shift_m: side * at.depth_m * sin_b,
        }
    }
}

/// Intersection of the load line with the centreline of the tooth.
struct LoadLineCrossing {
    sin: f64,
    cos: f64,
    /// sin of the load angle in the normal section.
    normal_sin: f64,
    /// Crossing radius minus root radius.
    lever_m: f64,
    /// Distance from the contact to the crossing along the flank normal.
    depth_m: f64,
}

impl Tooth {
    fn crossing(&self, roll_m: f64) -> LoadLineCrossing {
        let (_, cos_b) = self.base_helix;
        let r_b = self.base_radius_m;
        // Along the base tangent the centreline is `tangent` away; along the flank normal it is met `depth` away, after
        // the part depth cosβ_b of the base tangent (the tooth turns as the normal runs along the axis).
        let tangent = roll_m - r_b * (roll_m / r_b - self.base_half_angle_rad).tan();
        let depth_m = (tangent * cos_b).max(1e-3 * self.base_half_angle_rad * r_b);
        let roll = roll_m - depth_m * cos_b;
        let radius = r_b.hypot(roll);
        LoadLineCrossing {
            sin: roll / radius,
            cos: r_b / radius,
            normal_sin: cos_b * roll / radius,
            lever_m: radius - self.root_radius_m,
            depth_m,
        }
    }
}

/// The tooth of `form` as a plate over the functions of `basis`; Young's modulus is one.
pub(super) fn plate(form: &ToothProfile<'_>, nu: f64, basis: &WidthBasis) -> PlateModes {
    let tan_base = form.base_helix_angle_rad.tan();
    let cos_at = |r: f64| 1.0 / (1.0 + (r * tan_base / form.base_radius_m).powi(2)).sqrt();
    let plate = Plate {
        height_m: form.tip_radius_m - form.root_radius_m,
        nu,
        cos_trace: cos_at(0.5 * (form.tip_radius_m + form.root_radius_m)),
        thickness: &|above| {
            let r = form.root_radius_m + above;
            2.0 * r * (form.half_angle)(r) * cos_at(r)
        },
    };
    plate.modes(basis)
}

/// Compression of the tooth from the root circle to `lever_m` above it per force along its height and per unit face
/// width, times Young's modulus.
pub(super) fn compression(form: &ToothProfile<'_>, nu: f64, lever_m: f64) -> f64 {
    let mut sum = 0.0;
    for (x, w) in gauss_12() {
        let t = 0.5 * (1.0 + x);
        let r = form.root_radius_m + lever_m.max(0.0) * t * t;
        sum += w * t * lever_m.max(0.0) / (2.0 * r * (form.half_angle)(r));
    }
    sum * (1.0 - nu * nu)
}

/// Part of the root's flexibility with short waves across the tooth: plane strain in the normal section, on the virtual
/// annulus of that section (radius r_f / cos²β).
pub(super) struct RootRemainder {
    /// Over tangential force, moment / virtual radius and radial force, times Young's modulus and face width.
    pub matrix: [[f64; 3]; 3],
    /// Radius of the virtual root circle in the normal section, r_f / cos²β.
    pub virtual_radius_m: f64,
    /// Decay length of its displacement along the face.
    pub decay_m: f64,
}

impl RootRemainder {
    /// `weight(κ)` is the part of the body's flexibility at circumferential wave number κ (rad/m, across the tooth)
    /// that the ring leaves to the tooth's own root.
    pub(super) fn new(form: &ToothProfile<'_>, nu: f64, weight: &dyn Fn(f64) -> f64) -> RootRemainder {
        let tan = form.root_radius_m * form.base_helix_angle_rad.tan() / form.base_radius_m;
        let cos = 1.0 / (1.0 + tan * tan).sqrt();
        let r = form.root_radius_m / (cos * cos);
        let theta = form.root_half_angle_rad * form.root_radius_m * cos / r;
        let inner = (1.0 - 3.0 * form.normal_module_m / r).max(0.3);
        // Harmonics up to 30 waves over the root arc: the tail is below 1e-3 of the whole.
        let terms = (30.0 * std::f64::consts::PI / theta).ceil().min(20_000.0) as u32;
        let matrix = arc_flexibility(inner, theta, 0.0, nu, terms, |n| weight(n as f64 / r)).matrix;
        let half_width = theta * r;
        RootRemainder {
            matrix: matrix.map(|row| row.map(|v| v * cos)),
            virtual_radius_m: r,
            decay_m: 0.5 * half_width * cos,
        }
    }
}
