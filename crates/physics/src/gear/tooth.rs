//! The tooth form: involute flank and the root fillet a rack cuts with its rounded tip.
//!
//! The rack of ISO 53 has its tip arc in the normal section; the transverse section of that arc is an ellipse whose
//! envelope on the rolling gear is the exact fillet of the gear, spur and helical (Litvin; ISO 21771 for the circles).

use super::involute::{inv_at_radius, roll_length_m};

/// Cutter and blank of one member, from which the tooth form follows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cutter {
    /// Number of teeth.
    pub teeth: u32,
    /// Normal module.
    pub normal_module_m: f64,
    /// Normal pressure angle.
    pub normal_pressure_angle_rad: f64,
    /// Transverse pressure angle.
    pub transverse_pressure_angle_rad: f64,
    /// Helix angle at the reference circle.
    pub helix_angle_rad: f64,
    /// Profile shift coefficient.
    pub profile_shift: f64,
    /// Dedendum coefficient of the rack.
    pub dedendum: f64,
    /// Tip rounding coefficient of the rack.
    pub fillet_radius: f64,
}

impl Cutter {
    /// Largest tip rounding (in normal modules) for which the rack still has a tip: the arc's centre on its centreline,
    /// and an arc that ends below the datum line.
    pub(super) fn fillet_radius_limit(&self) -> f64 {
        let (sin, cos) = self.normal_pressure_angle_rad.sin_cos();
        let centreline =
            (std::f64::consts::FRAC_PI_4 - self.dedendum * self.normal_pressure_angle_rad.tan()) * cos / (1.0 - sin);
        centreline.min(self.dedendum / (1.0 - sin))
    }

    /// Signed roll length at which the straight flank of the rack ends on the involute; negative: the tooth is undercut
    /// (ISO 21771, form diameter by a rack).
    pub(super) fn form_roll_m(&self) -> f64 {
        let sin_n = self.normal_pressure_angle_rad.sin();
        let sin_t = self.transverse_pressure_angle_rad.sin();
        let b = self.normal_module_m * (self.dedendum - self.profile_shift + self.fillet_radius * (sin_n - 1.0));
        self.reference_radius_m() * sin_t - b / sin_t
    }

    /// Least profile shift coefficient without undercut.
    pub(super) fn undercut_limit(&self) -> f64 {
        let sin_n = self.normal_pressure_angle_rad.sin();
        let sin_t = self.transverse_pressure_angle_rad.sin();
        self.dedendum
            - self.fillet_radius * (1.0 - sin_n)
            - f64::from(self.teeth) * sin_t * sin_t / (2.0 * self.helix_angle_rad.cos())
    }

    /// Radius of the root circle.
    pub(super) fn root_radius_m(&self) -> f64 {
        self.reference_radius_m() - self.normal_module_m * (self.dedendum - self.profile_shift)
    }

    /// Radius of the reference circle.
    pub(super) fn reference_radius_m(&self) -> f64 {
        0.5 * f64::from(self.teeth) * self.normal_module_m / self.helix_angle_rad.cos()
    }
}

/// A point of the fillet: radius, half angle of the tooth there.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FilletPoint {
    r_m: f64,
    half_angle_rad: f64,
}

/// The flank of one tooth from root to tip, as half angle over radius.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ToothForm {
    base_radius_m: f64,
    base_half_angle_rad: f64,
    root_radius_m: f64,
    join_radius_m: f64,
    half_pitch_rad: f64,
    reference_radius_m: f64,
    /// Arc centre below the generating pitch line.
    centre_depth_m: f64,
    /// Arc centre from the centreline of the rack tooth, normal section.
    centre_offset_m: f64,
    arc_radius_m: f64,
    cos_helix: f64,
    /// Arc parameter where the straight flank ends (the normal pressure angle).
    start_rad: f64,
}

const END_RAD: f64 = std::f64::consts::FRAC_PI_2;

impl ToothForm {
    /// The tooth cut by `cutter`. The cutter's fillet radius must be within its limit and the root circle positive.
    pub(super) fn new(cutter: &Cutter) -> ToothForm {
        let m = cutter.normal_module_m;
        let (sin_n, cos_n) = cutter.normal_pressure_angle_rad.sin_cos();
        let tan_n = cutter.normal_pressure_angle_rad.tan();
        let rho = cutter.fillet_radius * m;
        let z = f64::from(cutter.teeth);
        let r = cutter.reference_radius_m();
        let r_b = r * cutter.transverse_pressure_angle_rad.cos();
        let psi = (std::f64::consts::PI + 4.0 * cutter.profile_shift * tan_n) / (2.0 * z);
        let mut form = ToothForm {
            base_radius_m: r_b,
            base_half_angle_rad: psi + super::involute::inv(cutter.transverse_pressure_angle_rad),
            root_radius_m: cutter.root_radius_m(),
            join_radius_m: r_b,
            half_pitch_rad: std::f64::consts::PI / z,
            reference_radius_m: r,
            centre_depth_m: m * (cutter.dedendum - cutter.profile_shift) - rho,
            centre_offset_m: std::f64::consts::FRAC_PI_4 * m
                - cutter.dedendum * m * tan_n
                - rho * (1.0 - sin_n) / cos_n,
            arc_radius_m: rho,
            cos_helix: cutter.helix_angle_rad.cos(),
            start_rad: cutter.normal_pressure_angle_rad,
        };
        form.join_radius_m = form.join(cutter.form_roll_m());
        form
    }

    /// Radius at which fillet and involute meet: the rack's form circle, or with undercut the point where the fillet
    /// cuts the involute.
    fn join(&self, form_roll_m: f64) -> f64 {
        let form_radius = form_roll_m.hypot(self.base_radius_m);
        if form_roll_m >= 0.0 {
            return form_radius;
        }
        // The fillet starts on the mirrored branch of the involute (outside the tooth) and cuts into the flank further
        // in.
        let excess = |r: f64| self.fillet_half_angle_rad(r) - self.involute_half_angle_rad(r);
        let (mut cut, mut free) = (self.base_radius_m, form_radius);
        if excess(cut) >= 0.0 {
            return self.base_radius_m;
        }
        for _ in 0..80 {
            let mid = 0.5 * (cut + free);
            if excess(mid) < 0.0 {
                cut = mid;
            } else {
                free = mid;
            }
        }
        0.5 * (cut + free)
    }

    fn involute_half_angle_rad(&self, r_m: f64) -> f64 {
        self.base_half_angle_rad - inv_at_radius(r_m, self.base_radius_m)
    }

    fn fillet_point(&self, gamma_rad: f64) -> FilletPoint {
        let (sin, cos) = gamma_rad.sin_cos();
        let x_t = (self.centre_offset_m + self.arc_radius_m * cos) / self.cos_helix;
        // The normal at the generated point passes through the pitch point: the rack has rolled by l.
        let depth = self.centre_depth_m + self.arc_radius_m * sin;
        let x = depth * cos * self.cos_helix / sin;
        let y = self.reference_radius_m - depth;
        let l = x_t - x;
        FilletPoint {
            r_m: x.hypot(y),
            half_angle_rad: self.half_pitch_rad - (x.atan2(y) + l / self.reference_radius_m),
        }
    }

    /// Half angle on the fillet: its radius falls monotonically along the arc parameter; found by bracketed regula
    /// falsi (Illinois).
    fn fillet_half_angle_rad(&self, r_m: f64) -> f64 {
        let (mut lo, mut hi) = (self.start_rad, END_RAD);
        let (mut f_lo, mut f_hi) = (self.fillet_point(lo).r_m - r_m, self.fillet_point(hi).r_m - r_m);
        if f_lo <= 0.0 {
            return self.fillet_point(lo).half_angle_rad;
        }
        if f_hi >= 0.0 {
            return self.fillet_point(hi).half_angle_rad;
        }
        let tolerance = 4.0 * f64::EPSILON * r_m;
        let mut side = 0;
        for _ in 0..100 {
            let mid = (lo * f_hi - hi * f_lo) / (f_hi - f_lo);
            let point = self.fillet_point(mid);
            let f = point.r_m - r_m;
            if f.abs() <= tolerance || hi - lo <= 4.0 * f64::EPSILON {
                return point.half_angle_rad;
            }
            if f > 0.0 {
                lo = mid;
                f_lo = f;
                if side == 1 {
                    f_hi *= 0.5;
                }
                side = 1;
            } else {
                hi = mid;
                f_hi = f;
                if side == -1 {
                    f_lo *= 0.5;
                }
                side = -1;
            }
        }
        self.fillet_point(0.5 * (lo + hi)).half_angle_rad
    }

    /// Half angle of the tooth at a radius; below the root circle its value there, above the tip the involute goes on.
    pub(super) fn half_angle_rad(&self, r_m: f64) -> f64 {
        if r_m >= self.join_radius_m {
            self.involute_half_angle_rad(r_m)
        } else {
            self.fillet_half_angle_rad(r_m.max(self.root_radius_m))
        }
    }

    /// Half angle of the tooth where the fillet ends on the root circle.
    pub(super) fn root_half_angle_rad(&self) -> f64 {
        self.fillet_point(END_RAD).half_angle_rad
    }

    /// Radius at which fillet and involute join.
    pub(super) fn join_radius_m(&self) -> f64 {
        self.join_radius_m
    }

    /// Radius of the root circle.
    pub(super) fn root_radius_m(&self) -> f64 {
        self.root_radius_m
    }

    /// Radius of the base circle.
    pub(super) fn base_radius_m(&self) -> f64 {
        self.base_radius_m
    }

    /// Half angle of the tooth at the base circle.
    pub(super) fn base_half_angle_rad(&self) -> f64 {
        self.base_half_angle_rad
    }

    /// Roll length at the join of fillet and involute.
    pub(super) fn join_roll_m(&self) -> f64 {
        roll_length_m(self.join_radius_m, self.base_radius_m)
    }
}
