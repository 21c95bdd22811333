//! Clearance oscillator: one degree of freedom of the same equations, against independent amplitudes and jumps.
//!
//! x'' + 2ζ x' + (1 + ε cos Ωt) f(x) = F_m + F_a Ω² cos Ωt, f the backlash function with b = 1, ζ = 0.05, F_m = 0.1.
//! Reference values from a classical Runge–Kutta integration with steps halved until five digits were constant,
//! continued along a sweep of Ω.

use std::f64::consts::TAU;

use crate::dynamics::*;
use crate::watch::Watch;
use herringbone_oracle::Tolerance::{Absolute, Relative};
use herringbone_oracle::check;

const FORCED: &str = "Dynamics: clearance oscillator, forced";
const PARAMETRIC: &str = "Dynamics: clearance oscillator, parametric";

/// All coordinates but the rotation are fixed by very large masses; R = 1 and I = 1, with a very large inertia of the
/// gear, so that m_e = 1.
fn oscillator(omega: f64, epsilon: f64, amplitude: f64) -> Parameters {
    const FAST: f64 = 1e30;
    let half = HalfParameters {
        pinion_mass_kg: FAST,
        pinion_inertia_kg_m2: 1.0,
        gear_mass_kg: FAST,
        gear_inertia_kg_m2: FAST,
        pinion_torque_nm: 0.1,
        pinion_lateral: Spring::default(),
        gear_lateral: Spring::default(),
        pinion_axial: Spring::default(),
        gear_axial: Spring::default(),
        contact_force: None,
        mesh_stiffness: Stiffness::Fourier {
            mean_n_per_m: 1.0,
            harmonics: vec![Harmonic { amplitude: epsilon, phase_rad: 0.0 }],
        },
        mesh_damping_n_s_per_m: 0.1,
        // F_s acts against the torque.
        impact: Some(ImpactExcitation::Harmonics {
            harmonics: vec![Harmonic { amplitude: -amplitude * omega * omega, phase_rad: 0.0 }],
        }),
        displacement_excitation: Vec::new(),
        phase_shift_mesh_periods: 0.0,
    };
    Parameters {
        mesh_frequency_hz: omega / TAU,
        pinion_radius_m: 1.0,
        gear_radius_m: 1.0,
        helix_angle_rad: 0.0,
        half_backlash_m: 1.0,
        damping_in_gap: true,
        impact_acts_on: ImpactActsOn::Torsion,
        halves: [half.clone(), half],
        couplings: Couplings::default(),
        train: None,
    }
}

/// Minimum and maximum of u over one period, and the integrals of u and u² over it.
struct PeakToPeak {
    low: f64,
    high: f64,
    duration: f64,
    first: f64,
    second: f64,
}

impl PeakToPeak {
    const NONE: PeakToPeak =
        PeakToPeak { low: f64::INFINITY, high: f64::NEG_INFINITY, duration: 0.0, first: 0.0, second: 0.0 };

    /// Peak to peak, mean, RMS about the mean.
    fn values(&self) -> [f64; 3] {
        let mean = self.first / self.duration;
        [self.high - self.low, mean, (self.second / self.duration - mean * mean).sqrt()]
    }
}

impl Observer<6> for PeakToPeak {
    fn segment(&mut self, g: &Segment<'_, 6>) {
        for i in 0..=64 {
            let t = g.h * f64::from(i) / 64.0;
            let u = g.rows[..=g.degree].iter().rev().fold(0.0, |s, row| s * t + row[U]);
            self.low = self.low.min(u);
            self.high = self.high.max(u);
            // Simpson's rule.
            let weight = g.h / 192.0 * if i == 0 || i == 64 { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
            self.duration += weight;
            self.first += weight * u;
            self.second += weight * u * u;
        }
    }
}

/// Steady motion at `omega` from the displacement and velocity (per unit of time) `from`, which is set to its end.
/// Returns peak to peak, mean, RMS about the mean.
fn motion(omega: f64, epsilon: f64, amplitude: f64, from: &mut (f64, f64)) -> [f64; 3] {
    let model = DynamicModel::<6>::new(&oscillator(omega, epsilon, amplitude)).unwrap();
    let mut state = model.state_from(&[0.0; 24]);
    (state.x[U], state.v[U]) = (from.0, from.1 / model.omega_ref);
    state.contact = [model.contact_of(0, from.0, 0.0); 2];
    let mut path = Motion::new(&model, state, Integrator::Taylor, 1e-9, u64::MAX);
    for _ in 0..200 {
        path.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
    }
    let mut out = PeakToPeak::NONE;
    path.advance_period(&mut out, &Watch::none(), 0.0).unwrap();
    *from = (path.state.x[U], path.state.v[U] * model.omega_ref);
    out.values()
}

fn peak_to_peak(omega: f64, epsilon: f64, amplitude: f64, from: &mut (f64, f64)) -> f64 {
    motion(omega, epsilon, amplitude, from)[0]
}

/// Peak-to-peak values along Ω from `first` to `last` in steps of 1, all in thousandths.
fn sweep(first: i32, last: i32, epsilon: f64, amplitude: f64) -> Vec<(i32, f64)> {
    let mut from = (1.1, 0.0);
    let step = (last - first).signum();
    (0..=(last - first).abs())
        .map(|i| first + i * step)
        .map(|omega| (omega, peak_to_peak(f64::from(omega) / 1000.0, epsilon, amplitude, &mut from)))
        .collect()
}

fn check_peak_to_peak(topic: &str, way: &str, sweep: &[(i32, f64)], expected: &[(i32, f64)]) {
    for (omega, swing) in expected {
        let found = sweep.iter().find(|(o, _)| o == omega).unwrap().1;
        let quantity = format!("peak to peak at Ω = {}, Ω {way}", f64::from(*omega) / 1000.0);
        check(topic, &quantity, found, *swing, Relative(2e-4));
    }
}

/// Ω of the first jump, known to two thousandths; twice that and half a step are allowed.
fn check_jump(topic: &str, way: &str, sweep: &[(i32, f64)], expected: f64) {
    let (a, b) = jump(sweep);
    check(topic, &format!("jump, Ω {way}"), f64::from(a + b) / 2000.0, expected, Absolute(2.5e-3));
}

/// The first of two neighbours between which the peak-to-peak value changes by more than a quarter.
fn jump(sweep: &[(i32, f64)]) -> (i32, i32) {
    let at = sweep.windows(2).position(|w| (w[1].1 / w[0].1).ln().abs() > 0.25).unwrap();
    (sweep[at].0, sweep[at + 1].0)
}

#[test]
fn forced_amplitudes_are_met() {
    for (omega, p2p) in [
        (500, 0.013304),
        (700, 0.038072),
        (800, 0.069418),
        (850, 0.099567),
        (1000, 0.276825),
        (1100, 0.203195),
        (1200, 0.126282),
    ] {
        let found = peak_to_peak(f64::from(omega) / 1000.0, 0.0, 0.02, &mut (1.1, 0.0));
        check(FORCED, &format!("peak to peak at Ω = {}", f64::from(omega) / 1000.0), found, p2p, Relative(2e-4));
        // Where contact is kept the linear amplitude holds.
        if omega == 500 || omega == 1200 {
            let o = f64::from(omega) / 1000.0;
            let linear = 2.0 * 0.02 * o * o / ((1.0 - o * o).powi(2) + (0.1 * o).powi(2)).sqrt();
            check(FORCED, &format!("the same by the linear amplitude, Ω = {o}"), found, linear, Relative(1e-4));
        }
    }
}

#[test]
fn parametric_amplitudes_are_met() {
    for (omega, p2p) in [(500, 0.094955), (700, 0.079515), (1000, 0.260238), (1200, 0.084516)] {
        let found = peak_to_peak(f64::from(omega) / 1000.0, 0.2, 0.0, &mut (1.1, 0.0));
        check(PARAMETRIC, &format!("peak to peak at Ω = {}", f64::from(omega) / 1000.0), found, p2p, Relative(2e-4));
    }
}

/// Case A: jump up between 0.926 and 0.928, down between 0.888 and 0.886, both branches at 0.9.
#[test]
fn forced_jumps_are_bracketed() {
    let up = sweep(890, 932, 0.0, 0.02);
    check_peak_to_peak(FORCED, "rising", &up, &[(900, 0.154111)]);
    check_jump(FORCED, "rising", &up, 0.927);
    let down = sweep(960, 880, 0.0, 0.02);
    check_peak_to_peak(FORCED, "falling", &down, &[(950, 0.31424), (900, 0.347418)]);
    check_jump(FORCED, "falling", &down, 0.887);
    let [_, mean, rms] = motion(0.95, 0.0, 0.02, &mut (1.1, 0.0));
    check(FORCED, "mean at Ω = 0.95", mean, 1.085945, Relative(2e-4));
    check(FORCED, "RMS about it at Ω = 0.95", rms, 0.112026, Relative(2e-4));
}

/// Case B: jump up between 0.906 and 0.908, down between 0.836 and 0.834.
#[test]
fn parametric_jumps_are_bracketed() {
    let up = sweep(840, 912, 0.2, 0.0);
    check_peak_to_peak(PARAMETRIC, "rising", &up, &[(850, 0.145013), (900, 0.204059)]);
    check_jump(PARAMETRIC, "rising", &up, 0.907);
    let down = sweep(960, 828, 0.2, 0.0);
    check_peak_to_peak(PARAMETRIC, "falling", &down, &[(950, 0.305133), (900, 0.354166), (850, 0.405168)]);
    check_jump(PARAMETRIC, "falling", &down, 0.835);
}
