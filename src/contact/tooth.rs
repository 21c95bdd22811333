//! One tooth as a cantilever: its compliance along the flank normal above the root circle, and the loads it hands to the
//! gear body.
//!
//! The normal section is what bends. The flank normal meets the middle surface of the tooth at the radius y_c, where it has
//! the components cosβ_b cosα' (tangential), cosβ_b sinα' (radial) and sinβ_b (axial), cosα' = r_b / y_c. Its part in
//! the tangent plane of the cylinder through y_c is exactly perpendicular to the tooth trace there, so that in the normal
//! section sinα'_n = cosβ_b sinα', and the tooth is a cantilever of thickness s_t(r) cosβ(r) and length b / cosβ(r):
//!
//! ```text
//! E δ b / F_n = cos²α'_n [ 12 (1-ν²) ∫ (y_c-r)² / (s_t³ cos²β) dr + 2.4 (1+ν) ∫ dr/s_t ] + (1-ν²) sin²α'_n ∫ dr/s_t
//! ```
//!
//! from the root circle to y_c, through fillet and involute (Weber and Banaschek's beam with the true profile, plane
//! strain along the tooth). The displacement meant is that of the centreline along the load line: the contact indentation
//! above it is `hertz`'s.

use super::annulus::arc_flexibility;
use super::plate::{Plate, Spread};

/// Load on a tooth at one point of its profile per unit normal force, as the body at the root circle receives it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RootLoad {
    /// Order: tangential force, moment / r_f (radial traction linear across the tooth), radial force, axial force, radial
    /// dipole along the tooth (N m).
    pub components: [f64; 5],
}

/// Profile and position of one tooth form, in SI.
pub struct ToothForm<'a> {
    pub base_radius_m: f64,
    pub root_radius_m: f64,
    pub tip_radius_m: f64,
    pub base_half_angle_rad: f64,
    pub root_half_angle_rad: f64,
    pub base_helix_angle_rad: f64,
    pub normal_module_m: f64,
    /// Half angle of the tooth at a radius between root and tip.
    pub half_angle: &'a dyn Fn(f64) -> f64,
}

/// Compliance of a tooth along its profile, tabulated once.
#[derive(Debug, Clone, PartialEq)]
pub struct Tooth {
    form: Fixed,
    table: Vec<[f64; 4]>,
    roll_start_m: f64,
    roll_step_m: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Fixed {
    base_radius_m: f64,
    root_radius_m: f64,
    base_half_angle_rad: f64,
    base_helix: (f64, f64),
    root_helix: (f64, f64),
}

/// What the influence matrix needs at one point of the profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// Compliance along the flank normal of a long tooth under uniform load: m per N of normal force per m of face width.
    pub line_compliance_m2_per_n: f64,
    /// Decay length of the tooth's own coupling along the face.
    pub decay_length_m: f64,
    pub root_load: RootLoad,
    /// Decay lengths of what reaches the root: forces, moments.
    pub root_spread_m: [f64; 2],
    /// Depth of the tooth centreline below the contact, along the flank normal.
    pub depth_m: f64,
}

const POINTS: usize = 33;

/// 12-point Gauss-Legendre rule on [0, 1]: abscissae of the lower half and weights (Abramowitz and Stegun, table 25.4).
const GAUSS: [(f64, f64); 6] = [
    (0.125_233_408_511_469, 0.249_147_045_813_403),
    (0.367_831_498_998_180, 0.233_492_536_538_355),
    (0.587_317_954_286_617, 0.203_167_426_723_066),
    (0.769_902_674_194_305, 0.160_078_328_543_346),
    (0.904_117_256_370_475, 0.106_939_325_995_318),
    (0.981_560_634_246_719, 0.047_175_336_386_512),
];

impl Tooth {
    /// Tabulates the tooth between the rolls `from_m` and `to_m`. `weight(κ)` is the part of the body's flexibility at
    /// circumferential wave number κ (rad/m, across the tooth) that the body model leaves to the tooth's own root.
    pub fn new(
        form: &ToothForm<'_>,
        youngs_pa: f64,
        nu: f64,
        (from_m, to_m): (f64, f64),
        weight: &dyn Fn(f64) -> f64,
    ) -> Tooth {
        let tan_base = form.base_helix_angle_rad.tan();
        let angle_at_root = (form.root_radius_m * tan_base / form.base_radius_m).atan();
        let fixed = Fixed {
            base_radius_m: form.base_radius_m,
            root_radius_m: form.root_radius_m,
            base_half_angle_rad: form.base_half_angle_rad,
            base_helix: form.base_helix_angle_rad.sin_cos(),
            root_helix: angle_at_root.sin_cos(),
        };
        let root = RootRemainder::new(form, fixed.root_helix.1, nu, weight);
        let step = (to_m - from_m) / (POINTS - 1) as f64;
        let crossings: Vec<Crossing> = (0..POINTS).map(|i| fixed.crossing(from_m + step * i as f64)).collect();
        let plate = Plate {
            height_m: form.tip_radius_m - form.root_radius_m,
            nu,
            normal_module_m: form.normal_module_m,
            thickness: &|above| {
                let r = form.root_radius_m + above;
                2.0 * r * (form.half_angle)(r) / (1.0 + (r * tan_base / form.base_radius_m).powi(2)).sqrt()
            },
        };
        let heights: Vec<f64> = crossings.iter().map(|at| at.lever_m).collect();
        let table = crossings
            .iter()
            .zip(plate.spreads(&heights))
            .map(|(at, spread)| {
                let beam = Beam::new(form, tan_base, at.lever_m + form.root_radius_m, nu);
                let sin2 = at.normal_sin * at.normal_sin;
                let own = (1.0 - sin2) * (beam.bending + beam.shear) + sin2 * beam.axial;
                let local = root.compliance(at);
                let total = own + local;
                let Spread { deflection_m, force_m, moment_m } = spread;
                // The root's short waves see the load after it has spread and spread its answer again.
                let decay2 = own * deflection_m.powi(2) + local * (2.0 * force_m.powi(2) + root.decay2);
                [total / youngs_pa, (decay2 / total.max(1e-30)).sqrt(), force_m, moment_m]
            })
            .collect();
        Tooth { form: fixed, table, roll_start_m: from_m, roll_step_m: step }
    }

    /// The tooth at roll length `roll_m`; `side` is +1 or -1, the sign of the axial force in the body's coordinates.
    pub fn at(&self, roll_m: f64, side: f64) -> ProfilePoint {
        let position = ((roll_m - self.roll_start_m) / self.roll_step_m).clamp(0.0, (POINTS - 1) as f64);
        let i = (position as usize).clamp(1, POINTS - 3);
        let t = position - i as f64;
        // Cubic through four neighbours.
        let w = [
            -t * (t - 1.0) * (t - 2.0) / 6.0,
            (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
            -(t + 1.0) * t * (t - 2.0) / 2.0,
            (t + 1.0) * t * (t - 1.0) / 6.0,
        ];
        let value = |c: usize| (0..4).map(|k| w[k] * self.table[i + k - 1][c]).sum::<f64>();
        let clamped = self.roll_start_m + position * self.roll_step_m;
        let at = self.form.crossing(clamped);
        let (sin_b, cos_b) = self.form.base_helix;
        let (sin_f, cos_f) = self.form.root_helix;
        let lever = at.lever_m;
        let lateral = (1.0 - at.normal_sin * at.normal_sin).sqrt();
        let r_f = self.form.root_radius_m;
        let tangential = cos_b * at.cos;
        let root_load = RootLoad {
            components: [
                tangential * (1.0 + lever / r_f),
                lateral * lever / (cos_f * r_f),
                -cos_b * at.sin,
                side * sin_b,
                -side * lateral * lever * sin_f,
            ],
        };
        ProfilePoint {
            line_compliance_m2_per_n: value(0).max(1e-24),
            decay_length_m: value(1).max(0.0),
            root_load,
            root_spread_m: [value(2).max(0.0), value(3).max(0.0)],
            depth_m: at.depth_m,
        }
    }
}

/// Where the load line crosses the tooth centreline.
struct Crossing {
    sin: f64,
    cos: f64,
    /// sin of the load angle in the normal section.
    normal_sin: f64,
    /// Crossing radius minus root radius.
    lever_m: f64,
    /// Distance from the contact to the crossing along the flank normal.
    depth_m: f64,
}

impl Fixed {
    fn crossing(&self, roll_m: f64) -> Crossing {
        let (_, cos_b) = self.base_helix;
        let r_b = self.base_radius_m;
        // Along the base tangent the centreline is `tangent` away; along the flank normal it is met `depth` away, after
        // the part depth cosβ_b of the base tangent (the tooth turns as the normal runs along the axis).
        let tangent = roll_m - r_b * (roll_m / r_b - self.base_half_angle_rad).tan();
        let depth_m = (tangent * cos_b).max(1e-3 * self.base_half_angle_rad * r_b);
        let roll = roll_m - depth_m * cos_b;
        let radius = r_b.hypot(roll);
        Crossing {
            sin: roll / radius,
            cos: r_b / radius,
            normal_sin: cos_b * roll / radius,
            lever_m: radius - self.root_radius_m,
            depth_m,
        }
    }
}

/// Integrals of the cantilever up to the crossing radius, times Young's modulus.
struct Beam {
    bending: f64,
    shear: f64,
    axial: f64,
}

impl Beam {
    /// `crossing_m` is y_c. The substitution r = r_f + h t² takes the square root out of the fillet at the root circle.
    fn new(form: &ToothForm<'_>, tan_base: f64, crossing_m: f64, nu: f64) -> Beam {
        let height = crossing_m - form.root_radius_m;
        let mut beam = Beam { bending: 0.0, shear: 0.0, axial: 0.0 };
        if height <= 0.0 {
            return beam;
        }
        let mut nodes = [(0.0, 0.0); 12];
        for (k, &(x, w)) in GAUSS.iter().enumerate() {
            nodes[5 - k] = (0.5 - 0.5 * x, 0.5 * w);
            nodes[6 + k] = (0.5 + 0.5 * x, 0.5 * w);
        }
        for (t, w) in nodes {
            let above = height * t * t;
            let weight = w * 2.0 * t * height;
            let r = form.root_radius_m + above;
            let s = 2.0 * r * (form.half_angle)(r);
            let tan = r * tan_base / form.base_radius_m;
            let cos2 = 1.0 / (1.0 + tan * tan);
            let arm = height - above;
            beam.bending += arm * arm / (s.powi(3) * cos2) * weight;
            beam.axial += weight / s;
        }
        beam.bending *= 12.0 * (1.0 - nu * nu);
        beam.shear = 2.4 * (1.0 + nu) * beam.axial;
        beam.axial *= 1.0 - nu * nu;
        beam
    }
}

/// Part of the root's flexibility with short waves across the tooth: plane strain in the normal section, on the virtual
/// annulus of that section (radius r_f / cos²β).
struct RootRemainder {
    matrix: [[f64; 3]; 3],
    virtual_radius_m: f64,
    cos: f64,
    decay2: f64,
}

impl RootRemainder {
    fn new(form: &ToothForm<'_>, cos: f64, nu: f64, weight: &dyn Fn(f64) -> f64) -> RootRemainder {
        let r = form.root_radius_m / (cos * cos);
        let theta = form.root_half_angle_rad * form.root_radius_m * cos / r;
        let inner = (1.0 - 3.0 * form.normal_module_m / r).max(0.3);
        // Harmonics up to 30 waves over the root arc: the tail is below 1e-3 of the whole.
        let terms = (30.0 * std::f64::consts::PI / theta).ceil().min(20_000.0) as u32;
        let matrix = arc_flexibility(inner, theta, 0.0, nu, terms, |n| weight(n as f64 / r)).matrix;
        let half_width = theta * r;
        RootRemainder { matrix, virtual_radius_m: r, cos, decay2: (0.5 * half_width).powi(2) }
    }

    /// E times displacement per normal force per unit face width.
    fn compliance(&self, at: &Crossing) -> f64 {
        let lateral = (1.0 - at.normal_sin * at.normal_sin).sqrt();
        let f = [lateral, lateral * at.lever_m / self.virtual_radius_m, -at.normal_sin];
        let sum: f64 = (0..3).map(|a| (0..3).map(|b| f[a] * self.matrix[a][b] * f[b]).sum::<f64>()).sum();
        sum.max(0.0) * self.cos
    }
}
