//! Known error of the analytic compliance on short faces.
//!
//! On a face about as wide as the tooth is thick the transverse section of the tooth is a slanted parallelogram: a
//! force normal to the flank also bends it across its own plane, along the trace, which the plate with square ends does
//! not contain. By beam theory the bending compliance is larger by the part sin²β (s_n/b)², s_n the thickness in the
//! normal section, b the face width, which vanishes with β and with s_n/b.

use crate::gear::Pair;

/// Error of the mean mesh stiffness, as a part of it, from which it is worth a warning: the model error of ordinary
/// faces.
pub const SHORT_FACE_NOTICE: f64 = 0.03;

const HELIX_DEG: [f64; 6] = [0.0, 10.0, 20.0, 30.0, 40.0, 45.0];
/// Face width in normal modules.
const WIDTHS: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0];
/// Teeth of a member.
const TEETH: [f64; 2] = [10.0, 17.0];

/// Mean tangent stiffness of a half over that of medium finite elements, less one, in per cent, by teeth, helix angle
/// and face width: the program `short_faces` (`tools/src/bin/short_faces.rs`), the largest by amount of z 10/10 with
/// and without profile shifts of 0.45, and of z 17/44, 25/25 and 30/90.
const PERCENT: [[[f64; 6]; 6]; 2] = [
    [
        [-8.9, -2.2, -0.2, 0.8, 1.4, 1.8],
        [9.4, 2.2, 1.4, 1.4, 4.2, 4.1],
        [34.9, 15.0, 8.9, 6.4, 4.4, 3.6],
        [43.6, 22.4, 13.1, 8.5, 4.4, 3.1],
        [42.2, 24.3, 14.9, 9.6, 4.1, 2.3],
        [40.3, 24.2, 14.8, 9.5, 3.8, 1.9],
    ],
    [
        [-8.0, -2.9, -1.2, 0.7, 1.2, 1.4],
        [6.1, 1.4, 0.9, 0.9, 0.9, 1.0],
        [17.3, 7.2, 3.6, 2.0, 0.7, -0.6],
        [24.8, 12.2, 6.5, 3.5, 0.6, -1.4],
        [31.2, 17.1, 8.9, 4.5, -1.2, -2.5],
        [35.4, 19.7, 9.9, 4.7, -1.8, -3.2],
    ],
];

/// Mean mesh stiffness of the analytic compliance over that of finite elements, less one, interpolated in what was
/// measured: by teeth of both members, helix angle and reciprocal face width (the error is nearly linear in it), below
/// four normal modules; zero on wider faces.
pub fn stiffness_excess(pair: &Pair) -> f64 {
    let width = pair.spec.face_width_m / pair.spec.normal_module_m;
    if width >= WIDTHS[WIDTHS.len() - 1] {
        return 0.0;
    }
    let (b, tb) = bracket(&HELIX_DEG, pair.spec.helix_angle_rad.to_degrees());
    let (w, tw) = bracket(&WIDTHS.map(|width| -1.0 / width), -1.0 / width);
    let mix = |low: f64, high: f64, t: f64| low + (high - low) * t;
    let over_width = |z: usize, b: usize| mix(PERCENT[z][b][w], PERCENT[z][b][w + 1], tw);
    let over_helix = |z: usize| mix(over_width(z, b), over_width(z, b + 1), tb);
    // Each member has about half of the deflection.
    let member = |teeth: u32| {
        let (z, tz) = bracket(&TEETH, f64::from(teeth));
        mix(over_helix(z), over_helix(z + 1), tz)
    };
    0.005 * (member(pair.pinion.teeth) + member(pair.gear.teeth))
}

/// Interval of ascending `nodes` and the place in it; beyond the ends those of the end.
fn bracket(nodes: &[f64], value: f64) -> (usize, f64) {
    let i = nodes.partition_point(|node| *node <= value).clamp(1, nodes.len() - 1);
    (i - 1, ((value - nodes[i - 1]) / (nodes[i] - nodes[i - 1])).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compliance::{Compliance, Settings};
    use crate::contact::solve_half;
    use crate::fe::{FlankFlexibility, Resolution};
    use crate::gear::fixtures::{close, gear, pair, spec};
    use crate::gear::{GearSpec, Half};
    use crate::watch::Watch;

    fn with(teeth: [u32; 2], helix_deg: f64, modules: f64) -> Pair {
        let member = |z: u32| {
            let bore_radius_m = 0.4 * f64::from(z) * 1e-3 / helix_deg.to_radians().cos();
            GearSpec { bore_radius_m, ..gear(z, 0.0) }
        };
        pair(&spec(2.0, 20.0, helix_deg, 2.0 * modules, member(teeth[0]), member(teeth[1])))
    }

    /// Mean stiffness of the analytic compliance over that of finite elements, less one.
    fn measured(pair: &Pair, resolution: Resolution) -> f64 {
        let settings = Settings { positions: Some(16), ..Settings::default() };
        let flanks = Compliance::finite_element_inputs(pair, &settings, resolution)
            .map(|input| FlankFlexibility::new(&input, Watch::none()).expect("a flexibility"));
        let elements = Compliance::finite_elements(pair, &settings, [&flanks[0], &flanks[1]], Watch::none())
            .expect("not canceled");
        let force_n = 20e6 * pair.spec.face_width_m * pair.spec.normal_module_m;
        let mean = |compliance: &Compliance| {
            solve_half(pair, Half::Left, force_n, compliance, &settings, Watch::none()).expect("a cycle").stiffness.mean
        };
        mean(&Compliance::analytic(pair, &settings, Watch::none()).expect("not canceled")) / mean(&elements) - 1.0
    }

    /// Pairs that are not in the table, between its nodes too: what it says is what coarse elements find, within 3 % of
    /// the stiffness.
    #[test]
    fn the_stated_excess_is_what_elements_find() {
        for (teeth, helix_deg, modules) in
            [([10, 10], 40.0, 1.25), ([19, 31], 35.0, 0.8), ([20, 20], 24.0, 1.0), ([13, 22], 38.0, 1.5)]
        {
            let pair = with(teeth, helix_deg, modules);
            close(stiffness_excess(&pair), measured(&pair, Resolution::Coarse), 0.03);
        }
    }

    #[test]
    fn ordinary_faces_have_none() {
        for (helix_deg, modules) in [(0.0, 4.0), (30.0, 4.0), (45.0, 10.0)] {
            close(stiffness_excess(&with([17, 44], helix_deg, modules)), 0.0, 0.0);
        }
        assert!(stiffness_excess(&with([17, 44], 20.0, 3.0)).abs() < SHORT_FACE_NOTICE);
        // At a node of the table, and beyond its end as at its end.
        close(stiffness_excess(&with([17, 44], 30.0, 1.0)), 0.122, 1e-12);
        close(stiffness_excess(&with([17, 44], 30.0, 0.3)), stiffness_excess(&with([17, 44], 30.0, 0.5)), 1e-15);
    }
}
