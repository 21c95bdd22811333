//! Mesh stiffness by ISO 6336-1, method B, and the course over the mesh period of Gu, Velex, Sainsot and Bruyère.
//!
//! Stiffness per width is in N/m² (1 N/(mm um) = 1e9 N/m²) and acts in the transverse plane along the base tangent, as
//! the standard's mesh stiffness does; times the face width of one half it is the stiffness of that half.

mod face_load;

pub use face_load::{PinionArrangement, PinionOnShaft};

use crate::gear::Pair;
use serde::{Deserialize, Serialize};

/// One N/(mm um), the standard's unit.
const N_PER_MM_UM: f64 = 1e9;

/// C1 … C9 of ISO 6336-1, flexibility of a pair of solid steel gears, mm um/N.
const FLEXIBILITY: [f64; 9] =
    [0.047_23, 0.155_51, 0.257_91, -0.006_35, -0.116_54, -0.001_93, -0.241_88, 0.005_29, 0.001_82];

/// Correction factor C_M of ISO 6336-1: measured against theoretical stiffness of solid gears.
pub const MEASURED_TO_THEORETICAL: f64 = 0.8;

/// Young's modulus of the steel the standard's coefficients are for.
const STEEL_PA: f64 = 206e9;

/// Line load below which the stiffness falls, N/m (100 N/mm), and the exponent of its fall.
const LOW_LOAD_N_PER_M: f64 = 100e3;
const LOW_LOAD_EXPONENT: f64 = 0.25;

/// Blank of the gears for the factor C_R.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Blank {
    /// Solid discs, C_R = 1.
    Solid,
    /// A web of width `web_over_face_width` (b_s/b) under a rim of thickness `rim_over_module` (s_R/m_n).
    Web {
        /// b_s/b.
        web_over_face_width: f64,
        /// s_R/m_n.
        rim_over_module: f64,
    },
}

impl Blank {
    /// `C_R = 1 + ln(b_s/b) / (5 exp(s_R/(5 m_n)))`, with the limits of the standard: b_s/b from 0.2 to 1.2, s_R/m_n at
    /// least 1.
    pub fn factor(&self) -> f64 {
        match *self {
            Blank::Solid => 1.0,
            Blank::Web { web_over_face_width, rim_over_module } => {
                let web = web_over_face_width.clamp(0.2, 1.2);
                1.0 + web.ln() / (5.0 * (rim_over_module.max(1.0) / 5.0).exp())
            }
        }
    }
}

/// Errors of method B.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Iso6336Error {
    /// The formula for the tooth flexibility gives no positive value.
    #[error(
        "profile shifts {x1} and {x2} lie so far outside ISO 6336-1 that its tooth flexibility, {flexibility_mm_um_per_n} mm um/N, is not positive"
    )]
    Flexibility {
        /// Profile shift coefficient of the pinion.
        x1: f64,
        /// Profile shift coefficient of the gear.
        x2: f64,
        /// q', mm µm/N.
        flexibility_mm_um_per_n: f64,
    },
    /// The load is not positive.
    #[error("a load of {tangential_force_n} N has no stiffness: it must be positive and finite")]
    Load {
        /// Tangential force of one half, N.
        tangential_force_n: f64,
    },
    /// The basic rack factor is not positive.
    #[error("rack depth and pressure angle give a factor C_B of {rack_factor}: not positive")]
    Rack {
        /// Basic rack factor C_B.
        rack_factor: f64,
    },
}

/// Result of method B, with its factors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodB {
    /// Theoretical single stiffness c'_th, N/m².
    pub theoretical_n_per_m2: f64,
    /// Single stiffness c', N/m².
    pub single_n_per_m2: f64,
    /// Mesh stiffness c_gamma_alpha, mean over the period, N/m².
    pub mesh_n_per_m2: f64,
    /// Mesh stiffness for face load, c_gamma_beta = 0.85 c_gamma_alpha, N/m².
    pub face_load_mesh_n_per_m2: f64,
    /// Gear blank factor C_R.
    pub blank_factor: f64,
    /// Basic rack factor C_B.
    pub rack_factor: f64,
    /// Young's modulus over that of steel; of two materials E = 2 E1 E2 / (E1 + E2).
    pub material_factor: f64,
    /// 1 from 100 N/mm upwards.
    pub low_load_factor: f64,
    /// Sentences on quantities outside the range that the standard states for its formulas.
    pub outside_range: Vec<String>,
}

impl MethodB {
    /// Method B for one half: `tangential_force_n` is the force on the reference circle of one half, application factor
    /// included.
    pub fn new(pair: &Pair, blank: &Blank, tangential_force_n: f64) -> Result<MethodB, Iso6336Error> {
        if !(tangential_force_n > 0.0 && tangential_force_n.is_finite()) {
            return Err(Iso6336Error::Load { tangential_force_n });
        }
        let (x1, x2) = (pair.pinion.profile_shift, pair.gear.profile_shift);
        let flexibility_mm_um_per_n = flexibility_mm_um_per_n(pair.virtual_teeth(), [x1, x2]);
        if flexibility_mm_um_per_n <= 0.0 {
            return Err(Iso6336Error::Flexibility { x1, x2, flexibility_mm_um_per_n });
        }
        let rack_factor = rack_factor(pair);
        if rack_factor <= 0.0 {
            return Err(Iso6336Error::Rack { rack_factor });
        }
        let theoretical = N_PER_MM_UM / flexibility_mm_um_per_n;
        let material_factor = pair.reduced_youngs_modulus_pa() / STEEL_PA;
        let line_load = tangential_force_n / pair.spec.face_width_m;
        let low_load_factor = (line_load / LOW_LOAD_N_PER_M).min(1.0).powf(LOW_LOAD_EXPONENT);
        let single = theoretical
            * MEASURED_TO_THEORETICAL
            * blank.factor()
            * rack_factor
            * pair.spec.helix_angle_rad.cos()
            * material_factor
            * low_load_factor;
        let mesh = single * (0.75 * pair.transverse_contact_ratio + 0.25);
        Ok(MethodB {
            theoretical_n_per_m2: theoretical,
            single_n_per_m2: single,
            mesh_n_per_m2: mesh,
            face_load_mesh_n_per_m2: 0.85 * mesh,
            blank_factor: blank.factor(),
            rack_factor,
            material_factor,
            low_load_factor,
            outside_range: outside_range(pair, line_load),
        })
    }

    /// Mean stiffness of one half, `c_gamma_alpha b`, along the transverse base tangent.
    pub fn mean_n_per_m(&self, pair: &Pair) -> f64 {
        self.mesh_n_per_m2 * pair.spec.face_width_m
    }

    /// Stiffness of one half at mesh position `x0_m`: the mean times [`course`].
    pub fn at_n_per_m(&self, pair: &Pair, x0_m: f64) -> f64 {
        self.mean_n_per_m(pair) * course(pair, x0_m)
    }
}

/// `q' = C1 + C2/z_n1 + C3/z_n2 + C4 x1 + C5 x1/z_n1 + C6 x2 + C7 x2/z_n2 + C8 x1² + C9 x2²`.
fn flexibility_mm_um_per_n([z1, z2]: [f64; 2], [x1, x2]: [f64; 2]) -> f64 {
    let terms = [1.0, 1.0 / z1, 1.0 / z2, x1, x1 / z1, x2, x2 / z2, x1 * x1, x2 * x2];
    FLEXIBILITY.iter().zip(terms).map(|(c, term)| c * term).sum()
}

/// `C_B = [1 + 0.5 (1.2 - h_fP/m_n)] [1 - 0.02 (20 deg - alpha_Pn)]`, the mean of both members' racks.
fn rack_factor(pair: &Pair) -> f64 {
    let alpha_deg = pair.spec.normal_pressure_angle_rad.to_degrees();
    let depth = 0.5 * (pair.spec.pinion.dedendum + pair.spec.gear.dedendum);
    (1.0 + 0.5 * (1.2 - depth)) * (1.0 - 0.02 * (20.0 - alpha_deg))
}

fn outside_range(pair: &Pair, line_load_n_per_m: f64) -> Vec<String> {
    let (x1, x2) = (pair.pinion.profile_shift, pair.gear.profile_shift);
    let (ratio, sum, load) = (pair.transverse_contact_ratio, x1 + x2, line_load_n_per_m * 1e-3);
    let checks = [
        (x1 < x2, format!("x1 = {x1} is below x2 = {x2}")),
        (!(-0.5..=2.0).contains(&sum), format!("x1 + x2 = {sum} is outside -0.5 … 2")),
        (
            ratio < 1.2,
            format!("the transverse contact ratio {ratio:.4} is below 1.2: the mesh stiffness may be up to 10 % lower"),
        ),
        (ratio >= 2.5, format!("the transverse contact ratio {ratio:.4} is not below 2.5")),
        (load > 1600.0, format!("the line load {load:.0} N/mm is above 1600 N/mm")),
    ];
    checks.into_iter().filter(|(outside, _)| *outside).map(|(_, words)| words).collect()
}

/// Weight of a point of the path of contact, `v` from -1 at its start to 1 at its end: `1.15 - 0.45 v²`, mean 1.
///
/// Gu, Velex, Sainsot and Bruyère 2015 (J. Mech. Des. 137, 063301), equation 10, give its Fourier transform.
fn path_weight(v: f64) -> f64 {
    1.15 - 0.45 * v * v
}

/// Stiffness over its mean at mesh position `x0_m`: the lines of contact, each weighted over the path as in the
/// analytical mesh stiffness of Gu and others. Summed over the lines rather than as the series, which overshoots at the
/// steps of a spur gear.
pub fn course(pair: &Pair, x0_m: f64) -> f64 {
    let span = pair.path_end_m - pair.path_start_m;
    let weight = |x_m: f64| path_weight(2.0 * (x_m - pair.path_start_m) / span - 1.0);
    let sum: f64 = pair
        .contact_lines(x0_m)
        .iter()
        .map(|line| {
            let [start, end] = line.x_m;
            // Simpson's rule, exact for the parabola.
            line.width_m() * (weight(start) + 4.0 * weight(0.5 * (start + end)) + weight(end)) / 6.0
        })
        .sum();
    sum / (pair.transverse_contact_ratio * pair.spec.face_width_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::fixtures::{close, gear, pair, spec};
    use crate::gear::{GearSpec, Material, PairSpec};
    use herringbone_oracle::Tolerance::Absolute;
    use herringbone_oracle::{check, check_worst};
    use std::f64::consts::PI;

    /// ISO/TR 6336-30, annex A, example 1; the values of a commercial calculation of it, made with x1 = 0.145 (the
    /// standard states 0.14522).
    fn example() -> Pair {
        let rack = |teeth, x| GearSpec { dedendum: 1.4, fillet_radius: 0.39, ..gear(teeth, x) };
        let free = spec(8.0, 20.0, 15.8, 100.0, rack(17, 0.145), rack(103, 0.0));
        pair(&PairSpec { center_distance_m: Some(0.5), ..free })
    }

    #[test]
    fn iso_tr_6336_30_example_1() -> Result<(), Iso6336Error> {
        let p = example();
        let b = MethodB::new(&p, &Blank::Solid, 20e3)?;
        let topic = "Contact: ISO 6336-1 method B, ISO/TR 6336-30 example 1";
        let theoretical = b.theoretical_n_per_m2 * 1e-9;
        check(topic, "theoretical single stiffness c'_th, N/(mm µm)", theoretical, 17.855_84, Absolute(2e-5));
        check(topic, "single stiffness c', N/(mm µm)", b.single_n_per_m2 * 1e-9, 12.370_47, Absolute(2e-5));
        // The reference's mesh stiffness belongs to its contact ratio of 1.54909.
        let mesh = b.single_n_per_m2 * 1e-9 * (0.75 * 1.549_09 + 0.25);
        check(topic, "c_γα with the reference's contact ratio, N/(mm µm)", mesh, 17.464_85, Absolute(2e-5));
        close(b.mesh_n_per_m2 / b.single_n_per_m2, 0.75 * p.transverse_contact_ratio + 0.25, 1e-12);
        close(b.face_load_mesh_n_per_m2 / b.mesh_n_per_m2, 0.85, 1e-12);
        close(b.mean_n_per_m(&p), b.mesh_n_per_m2 * 0.1, 1.0);
        check(
            topic,
            "c_γα with the contact ratio found here, N/(mm µm)",
            b.mesh_n_per_m2 * 1e-9,
            17.467,
            Absolute(5e-4),
        );
        assert_eq!(b.outside_range, Vec::<String>::new());
        Ok(())
    }

    /// The finite-element pair z 29/67 at 199 N/mm: 7.4e8 N/m per half.
    #[test]
    fn pair_29_67() -> Result<(), Iso6336Error> {
        let p = pair(&spec(4.0, 20.0, 30.0, 45.0, gear(29, 0.0), gear(67, 0.0)));
        let b = MethodB::new(&p, &Blank::Solid, 199e3 * 0.045)?;
        let topic = "Contact: ISO 6336-1 method B, pair 29/67";
        check(topic, "mean stiffness of a half at 199 N/mm, N/µm", b.mean_n_per_m(&p) * 1e-6, 740.0, Absolute(5.0));
        Ok(())
    }

    #[test]
    fn light_loads_and_soft_materials() -> Result<(), Iso6336Error> {
        let mut p = example();
        let full = MethodB::new(&p, &Blank::Solid, 10e3)?;
        let light = MethodB::new(&p, &Blank::Solid, 10e3 / 16.0)?;
        close(full.low_load_factor, 1.0, 0.0);
        close(light.mesh_n_per_m2 / full.mesh_n_per_m2, 0.5, 1e-12);
        let (steel, soft) = (p.pinion.material, Material { youngs_modulus_pa: 103e9, ..Material::STEEL });
        (p.pinion.material, p.gear.material) = (soft, soft);
        close(MethodB::new(&p, &Blank::Solid, 10e3)?.mesh_n_per_m2 / full.mesh_n_per_m2, 0.5, 1e-12);
        // Two materials: 2 E1 E2 / (E1 + E2), whichever member has which.
        for materials in [(steel, soft), (soft, steel)] {
            (p.pinion.material, p.gear.material) = materials;
            close(MethodB::new(&p, &Blank::Solid, 10e3)?.mesh_n_per_m2 / full.mesh_n_per_m2, 2.0 / 3.0, 1e-12);
        }
        assert!(MethodB::new(&p, &Blank::Solid, 0.0).is_err());
        Ok(())
    }

    #[test]
    fn thin_webs_are_softer() {
        let factor = |web, rim| Blank::Web { web_over_face_width: web, rim_over_module: rim }.factor();
        close(factor(1.0, 3.0), 1.0, 1e-15);
        close(factor(0.3, 3.0), 1.0 + 0.3_f64.ln() / (5.0 * 0.6_f64.exp()), 1e-15);
        close(factor(0.01, 0.1), factor(0.2, 1.0), 0.0);
        close(Blank::Solid.factor(), 1.0, 0.0);
    }

    /// A pair with given contact ratios: tooth height and width are chosen for them.
    fn with_ratios(transverse: f64, overlap: f64) -> Pair {
        let at = |addendum: f64, width: f64| {
            let side = |z| GearSpec { addendum, dedendum: addendum + 0.25, fillet_radius: 0.2, ..gear(z, 0.0) };
            pair(&spec(5.0, 20.0, 20.0, width, side(40), side(60)))
        };
        let (mut low, mut high) = (0.6, 1.3);
        for _ in 0..60 {
            let mid = 0.5 * (low + high);
            if at(mid, 50.0).transverse_contact_ratio < transverse {
                low = mid;
            } else {
                high = mid;
            }
        }
        at(low, 50.0 * overlap / at(low, 50.0).overlap_ratio)
    }

    /// The published series, equation 10, at time `tau` (periods).
    fn series(transverse: f64, overlap: f64, tau: f64) -> f64 {
        let sinc = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
        1.0 + (1..2000)
            .map(|n| {
                let n = f64::from(n);
                let q = 0.09 / (n * transverse).powi(2);
                let weight = (0.7 + q) * sinc(n * transverse) - q * (PI * n * transverse).cos();
                2.0 * weight * sinc(n * overlap) * (PI * n * (2.0 * tau - transverse - overlap)).cos()
            })
            .sum::<f64>()
    }

    #[test]
    fn course_is_the_published_series() {
        for (transverse, overlap, swing) in [(1.6, 0.5, 0.3989), (1.55, 1.083, 0.0395), (1.43, 2.4, 0.0821)] {
            let p = with_ratios(transverse, overlap);
            close(p.transverse_contact_ratio, transverse, 1e-9);
            let n = 400;
            let mut errors = Vec::new();
            let (mut least, mut greatest, mut mean) = (f64::MAX, 0.0_f64, 0.0);
            for i in 0..n {
                let tau = f64::from(i) / f64::from(n);
                // At tau = 0 a pair starts: its mesh-in end is at the start of the path.
                let x0 = p.path_start_m - overlap * p.base_pitch_m + tau * p.base_pitch_m;
                let k = course(&p, x0);
                errors.push(k - series(transverse, overlap, tau));
                least = least.min(k);
                greatest = greatest.max(k);
                mean += k / f64::from(n);
            }
            let topic = "Contact: stiffness course of Gu, Velex and others";
            let of = |what: &str| format!("{what}, ε_α {transverse}, ε_β {overlap}");
            check_worst(topic, &of("course over its mean against the series"), errors, 1.5e-3);
            check(topic, &of("swing over the mean"), greatest - least, swing, Absolute(1.2e-3));
            check(topic, &of("mean"), mean, 1.0, Absolute(1e-4));
        }
    }
}
