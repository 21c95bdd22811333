//! The two excitations of the equations: mesh stiffness and mesh-in impact, as periodic functions of the mesh phase.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::error::DynamicsError;
use super::lanes::Real;
use crate::numerics::monotone_cubics;

/// One harmonic of a Fourier series: `amplitude · cos(2π i φ + phase_rad)` for the i-th entry (i from 1).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Harmonic {
    /// Relative to the mean for stiffnesses, in N for forces.
    pub amplitude: f64,
    pub phase_rad: f64,
}

/// Normal mesh stiffness k_m of one half over the mesh phase φ (one period is φ = 0 … 1), N/m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stiffness {
    /// The same at every phase.
    Constant { mean_n_per_m: f64 },
    /// k(φ) = mean (1 + Σ_i amplitude_i cos(2π i φ + phase_i)).
    Fourier { mean_n_per_m: f64, harmonics: Vec<Harmonic> },
    /// Equally spaced over one period, the first at φ = 0. Between samples: the periodic monotone cubic of Fritsch and
    /// Carlson (SIAM J. Numer. Anal. 17 (1980) 238) with Brodlie's harmonic-mean slopes. It passes through every sample, has no
    /// extremum between samples and so keeps a kink as sharp as the sampling does. The methods use the cubics exactly.
    Samples { values_n_per_m: Vec<f64> },
}

impl Stiffness {
    /// Mean over one mesh period (of the interpolant, for samples), N/m.
    pub fn mean_n_per_m(&self) -> f64 {
        match self {
            Stiffness::Constant { mean_n_per_m } | Stiffness::Fourier { mean_n_per_m, .. } => *mean_n_per_m,
            Stiffness::Samples { values_n_per_m } => {
                let pieces = monotone_cubics(values_n_per_m);
                let sum: f64 = pieces.iter().map(|c| c[0] + c[1] / 2.0 + c[2] / 3.0 + c[3] / 4.0).sum();
                sum / pieces.len() as f64
            }
        }
    }

    /// Value at the phase `phase` (any real number), N/m.
    pub fn at(&self, phase: f64) -> f64 {
        let course = StiffnessCourse::new(self, 0.0, 1.0);
        let phase = phase.rem_euclid(1.0);
        course.value(phase, phase)
    }

    pub(super) fn validate(&self) -> Result<(), DynamicsError> {
        let invalid = |value, reason| Err(DynamicsError::InvalidParameter { name: "mesh stiffness", value, reason });
        match self {
            Stiffness::Samples { values_n_per_m } if values_n_per_m.is_empty() => return invalid(0.0, "no samples"),
            Stiffness::Samples { values_n_per_m } => {
                if let Some(&bad) = values_n_per_m.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
                    return invalid(bad, "samples must be finite and not negative");
                }
            }
            Stiffness::Fourier { harmonics, .. } => {
                if let Some(bad) = harmonics.iter().find(|h| !(h.amplitude.is_finite() && h.phase_rad.is_finite())) {
                    return invalid(bad.amplitude, "harmonics must be finite");
                }
            }
            Stiffness::Constant { .. } => {}
        }
        let mean = self.mean_n_per_m();
        if !(mean.is_finite() && mean > 0.0) {
            return invalid(mean, "the mean must be positive and finite");
        }
        Ok(())
    }
}

/// Periodic force F_s along the mesh of one half in the transverse plane, N.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Impact {
    /// F_s(φ) = force · sin(π (φ − start) / duration) while 0 ≤ φ − start < duration, once per mesh period. Pulses longer than
    /// a mesh period overlap and add up.
    HalfSine { force_n: f64, duration_mesh_periods: f64, start_mesh_periods: f64 },
    /// F_s(φ) = Σ_i amplitude_i cos(2π i φ + phase_i), amplitudes in N: any smooth periodic force along the mesh.
    Harmonics { harmonics: Vec<Harmonic> },
}

/// The longest half sine, in mesh periods: beyond it the pulses of a dozen tooth pairs would overlap.
const LONGEST_PULSE_MESH_PERIODS: f64 = 16.0;

impl Impact {
    /// Mean over one mesh period, N.
    pub fn mean_n(&self) -> f64 {
        match self {
            Impact::HalfSine { force_n, duration_mesh_periods, .. } => force_n * duration_mesh_periods * 2.0 / PI,
            Impact::Harmonics { .. } => 0.0,
        }
    }

    /// Whether there is no force at any phase.
    pub fn is_zero(&self) -> bool {
        match self {
            Impact::HalfSine { force_n, .. } => *force_n == 0.0,
            Impact::Harmonics { harmonics } => harmonics.iter().all(|h| h.amplitude == 0.0),
        }
    }

    pub(super) fn validate(&self) -> Result<(), DynamicsError> {
        let check = |ok: bool, value, reason| {
            if ok { Ok(()) } else { Err(DynamicsError::InvalidParameter { name: "impact", value, reason }) }
        };
        match self {
            Impact::HalfSine { force_n, duration_mesh_periods: d, start_mesh_periods } => {
                check(force_n.is_finite(), *force_n, "the force must be finite")?;
                check(start_mesh_periods.is_finite(), *start_mesh_periods, "the start must be finite")?;
                check(
                    *d >= 1e-9 && *d <= LONGEST_PULSE_MESH_PERIODS,
                    *d,
                    "the duration must be 1e-9 to 16 mesh periods",
                )
            }
            Impact::Harmonics { harmonics } => harmonics.iter().try_for_each(|h| {
                check(h.amplitude.is_finite() && h.phase_rad.is_finite(), h.amplitude, "harmonics must be finite")
            }),
        }
    }
}

/// Taylor coefficients of one parity: 0, 2, 4 … or 1, 3, 5 ….
const PER_PARITY: usize = MAX_ORDER / 2 + 1;

/// Truncated Fourier series with the tables that give its Taylor coefficients in scaled time.
#[derive(Debug, Clone)]
pub(crate) struct Series<R> {
    constant: R,
    terms: Vec<Term<R>>,
}

/// One harmonic a cos(iθ + φ).
#[derive(Debug, Clone)]
struct Term<R> {
    /// a cosφ and a sinφ.
    cos: R,
    sin: R,
    /// (i ω/ω_ref)^n / n! with the signs of the derivatives of the cosine: n even, multiplying a cos(iθ + φ), and n odd, multiplying
    /// a sin(iθ + φ).
    even: [R; PER_PARITY],
    odd: [R; PER_PARITY],
}

impl Series<f64> {
    fn new(constant: f64, factor: f64, harmonics: &[Harmonic], shift: f64, period_tau: f64) -> Self {
        let term = |(i, h): (usize, &Harmonic)| {
            let order = (i + 1) as f64;
            let (sin, cos) = (h.phase_rad - TAU * order * shift).sin_cos();
            let (mut even, mut odd) = ([0.0; PER_PARITY], [0.0; PER_PARITY]);
            let mut power = 1.0;
            for n in 0..2 * PER_PARITY {
                let sign = if matches!(n % 4, 0 | 3) { 1.0 } else { -1.0 };
                if n % 2 == 0 {
                    even[n / 2] = sign * power
                } else {
                    odd[n / 2] = sign * power
                }
                power *= TAU * order / (period_tau * (n + 1) as f64);
            }
            Term { cos: factor * h.amplitude * cos, sin: factor * h.amplitude * sin, even, odd }
        };
        Self { constant, terms: harmonics.iter().enumerate().map(term).collect() }
    }

    fn value(&self, phase: f64) -> f64 {
        self.terms.iter().enumerate().fold(self.constant, |sum, (i, term)| {
            let (sin, cos) = (TAU * (i + 1) as f64 * phase).sin_cos();
            sum + term.cos * cos - term.sin * sin
        })
    }
}

impl<R: Real> Series<R> {
    pub fn zero() -> Self {
        Self { constant: R::splat(0.0), terms: Vec::new() }
    }

    /// Puts one motion's series into a lane. Shorter series have zero terms.
    pub fn put(&mut self, lane: usize, one: &Series<f64>) {
        let zero = R::splat(0.0);
        while self.terms.len() < one.terms.len() {
            self.terms.push(Term { cos: zero, sin: zero, even: [zero; PER_PARITY], odd: [zero; PER_PARITY] });
        }
        self.constant.set(lane, one.constant);
        for (i, to) in self.terms.iter_mut().enumerate() {
            let from = one.terms.get(i);
            to.cos.set(lane, from.map_or(0.0, |t| t.cos));
            to.sin.set(lane, from.map_or(0.0, |t| t.sin));
            for k in 0..PER_PARITY {
                to.even[k].set(lane, from.map_or(0.0, |t| t.even[k]));
                to.odd[k].set(lane, from.map_or(0.0, |t| t.odd[k]));
            }
        }
    }

    /// No lane has harmonics.
    #[inline(always)]
    pub fn is_constant(&self) -> bool {
        self.terms.is_empty()
    }

    /// Taylor coefficients in scaled time, orders 0 to `order`.
    #[inline(always)]
    pub fn fill(&self, phase: R, order: usize, out: &mut [R; MAX_ORDER + 1]) {
        let zero = R::splat(0.0);
        if self.is_constant() {
            out[..=order].fill(zero);
            out[0] = self.constant;
            return;
        }
        let (mut even, mut odd) = ([zero; PER_PARITY], [zero; PER_PARITY]);
        let count = order / 2 + 1;
        let (mut sin1, mut cos1) = (zero, zero);
        for lane in 0..R::LANES {
            let (sin, cos) = (TAU * phase.get(lane)).sin_cos();
            sin1.set(lane, sin);
            cos1.set(lane, cos);
        }
        let (mut sin, mut cos) = (sin1, cos1);
        for term in &self.terms {
            let (c, s) = (term.cos * cos - term.sin * sin, term.cos * sin + term.sin * cos);
            for k in 0..count {
                even[k] += term.even[k] * c;
                odd[k] += term.odd[k] * s;
            }
            (sin, cos) = (sin * cos1 + cos * sin1, cos * cos1 - sin * sin1);
        }
        for (n, value) in out[..=order].iter_mut().enumerate() {
            *value = if n % 2 == 0 { even[n / 2] } else { odd[n / 2] };
        }
        out[0] += self.constant;
    }
}

/// Highest order of the Taylor method.
pub(crate) const MAX_ORDER: usize = 24;
/// Taylor coefficients of one quantity.
pub(crate) type Coefficients = [f64; MAX_ORDER + 1];

/// A stiffness made ready for the methods. Scaled time τ is time times a reference frequency; `period_tau` is one mesh
/// period in it.
#[derive(Debug, Clone)]
pub(crate) struct StiffnessCourse {
    kind: StiffnessKind,
    shift: f64,
    period_tau: f64,
}

#[derive(Debug, Clone)]
enum StiffnessKind {
    Fourier(Series<f64>),
    Pieces(Vec<[f64; 4]>),
}

impl StiffnessCourse {
    pub fn new(stiffness: &Stiffness, shift: f64, period_tau: f64) -> Self {
        let kind = match stiffness {
            Stiffness::Constant { mean_n_per_m } => {
                StiffnessKind::Fourier(Series::new(*mean_n_per_m, 0.0, &[], shift, period_tau))
            }
            Stiffness::Fourier { mean_n_per_m, harmonics } => {
                StiffnessKind::Fourier(Series::new(*mean_n_per_m, *mean_n_per_m, harmonics, shift, period_tau))
            }
            Stiffness::Samples { values_n_per_m } => StiffnessKind::Pieces(monotone_cubics(values_n_per_m)),
        };
        Self { kind, shift, period_tau }
    }

    /// Phases at which the course is not smooth.
    pub fn breakpoints(&self, out: &mut Vec<f64>) {
        if let StiffnessKind::Pieces(pieces) = &self.kind
            && pieces.len() > 1
        {
            out.extend((0..pieces.len()).map(|i| (i as f64 / pieces.len() as f64 + self.shift).rem_euclid(1.0)));
        }
    }

    /// Index of the cubic that holds around `inside`, and the position of `phase` in it.
    fn piece(&self, count: usize, phase: f64, inside: f64) -> (usize, f64) {
        let n = count as f64;
        let index = (((inside - self.shift).rem_euclid(1.0) * n) as usize).min(count - 1);
        let mut u = (phase - self.shift).rem_euclid(1.0) * n - index as f64;
        // The start of a piece may be its neighbour's end, one period away.
        if u > 0.5 * n + 0.5 {
            u -= n;
        } else if u < 0.5 - 0.5 * n {
            u += n;
        }
        (index, u)
    }

    /// Value at `phase`; `inside` is a phase in the interior of the smooth stretch that is meant.
    pub fn value(&self, phase: f64, inside: f64) -> f64 {
        match &self.kind {
            StiffnessKind::Fourier(series) => series.value(phase),
            StiffnessKind::Pieces(pieces) => {
                let (i, u) = self.piece(pieces.len(), phase, inside);
                let c = &pieces[i];
                c[0] + u * (c[1] + u * (c[2] + u * c[3]))
            }
        }
    }

    /// The series, where the course is one (a constant is a series without terms).
    pub fn series(&self) -> Option<&Series<f64>> {
        match &self.kind {
            StiffnessKind::Fourier(series) => Some(series),
            StiffnessKind::Pieces(_) => None,
        }
    }

    /// Taylor coefficients about `phase`, those above the third zero; None where the course is a series.
    #[inline(always)]
    pub fn cubic(&self, phase: f64, inside: f64) -> Option<[f64; 4]> {
        let StiffnessKind::Pieces(pieces) = &self.kind else { return None };
        let (i, u) = self.piece(pieces.len(), phase, inside);
        let c = &pieces[i];
        let scale = pieces.len() as f64 / self.period_tau;
        Some([
            c[0] + u * (c[1] + u * (c[2] + u * c[3])),
            (c[1] + u * (2.0 * c[2] + u * 3.0 * c[3])) * scale,
            (c[2] + 3.0 * u * c[3]) * scale * scale,
            c[3] * scale * scale * scale,
        ])
    }
}

/// An impact made ready for the methods.
#[derive(Debug, Clone)]
pub(crate) enum ImpactCourse {
    None,
    HalfSine { force_n: f64, duration: f64, start: f64, power: Coefficients },
    Harmonics(Series<f64>),
}

impl ImpactCourse {
    pub fn new(impact: Option<&Impact>, shift: f64, period_tau: f64) -> Self {
        match impact {
            None => ImpactCourse::None,
            Some(Impact::HalfSine { force_n, .. }) if *force_n == 0.0 => ImpactCourse::None,
            Some(Impact::HalfSine { force_n, duration_mesh_periods: duration, start_mesh_periods }) => {
                let mut power = [1.0; MAX_ORDER + 1];
                for n in 1..=MAX_ORDER {
                    power[n] = power[n - 1] * PI / (duration * period_tau * n as f64);
                }
                let start = (start_mesh_periods + shift).rem_euclid(1.0);
                ImpactCourse::HalfSine { force_n: *force_n, duration: *duration, start, power }
            }
            Some(Impact::Harmonics { harmonics }) => {
                ImpactCourse::Harmonics(Series::new(0.0, 1.0, harmonics, shift, period_tau))
            }
        }
    }

    /// An upper estimate of the force's size, N.
    pub fn largest_n(&self) -> f64 {
        match self {
            ImpactCourse::None => 0.0,
            ImpactCourse::HalfSine { force_n, duration, .. } => force_n.abs() * duration.ceil(),
            ImpactCourse::Harmonics(series) => series.terms.iter().map(|t| t.cos.hypot(t.sin)).sum(),
        }
    }

    pub fn breakpoints(&self, out: &mut Vec<f64>) {
        if let ImpactCourse::HalfSine { duration, start, .. } = self {
            out.push(start.rem_euclid(1.0));
            out.push((start + duration).rem_euclid(1.0));
        }
    }

    /// Sine and cosine parts of the pulses under way at `phase` (those that are under way at `inside`).
    fn sine(phase: f64, inside: f64, duration: f64, start: f64) -> (f64, f64) {
        let mut offset = inside - start;
        offset -= offset.floor();
        // offset is the age of the youngest pulse at `inside`; older ones are whole periods older.
        let age = offset + (phase - inside);
        let (mut sin, mut cos, mut older) = (0.0, 0.0, 0.0);
        while offset + older < duration {
            let (s, c) = (PI * (age + older) / duration).sin_cos();
            sin += s;
            cos += c;
            older += 1.0;
        }
        (sin, cos)
    }

    pub fn value(&self, phase: f64, inside: f64) -> f64 {
        match self {
            ImpactCourse::None => 0.0,
            ImpactCourse::HalfSine { force_n, duration, start, .. } => {
                force_n * Self::sine(phase, inside, *duration, *start).0
            }
            ImpactCourse::Harmonics(series) => series.value(phase),
        }
    }

    /// F sin and F cos of the pulses under way at `phase` (those that are under way at `inside`); None where the force is no pulse.
    #[inline(always)]
    pub fn pulse(&self, phase: f64, inside: f64) -> Option<(f64, f64)> {
        let ImpactCourse::HalfSine { force_n, duration, start, .. } = self else { return None };
        let (sin, cos) = Self::sine(phase, inside, *duration, *start);
        Some((force_n * sin, force_n * cos))
    }

    /// (π/(duration · period))^n / n! of a half sine.
    pub fn powers(&self) -> Option<&Coefficients> {
        match self {
            ImpactCourse::HalfSine { power, .. } => Some(power),
            _ => None,
        }
    }

    pub fn series(&self) -> Option<&Series<f64>> {
        match self {
            ImpactCourse::Harmonics(series) => Some(series),
            _ => None,
        }
    }
}
