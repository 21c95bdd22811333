//! Excitations of the equations as periodic functions of the mesh phase: mesh stiffness and mesh-in impact.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::error::DynamicsError;
use super::lanes::Real;
use crate::numerics::fourier::Fourier;
use crate::numerics::monotone_cubics;

/// One harmonic of a Fourier series: `amplitude · cos(2π i φ + phase_rad)` for entry i, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Harmonic {
    /// Relative to the mean for a stiffness, N for a force, m for a displacement.
    pub amplitude: f64,
    /// Phase angle, rad.
    pub phase_rad: f64,
}

/// Normal mesh stiffness k_m of one half over the mesh phase φ (one period is φ = 0 … 1), N/m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stiffness {
    /// Constant stiffness.
    Constant {
        /// Stiffness, N/m.
        mean_n_per_m: f64,
    },
    /// k(φ) = mean (1 + Σ_i amplitude_i cos(2π i φ + phase_i)).
    Fourier {
        /// Mean, N/m.
        mean_n_per_m: f64,
        /// Harmonics from the first, relative to the mean.
        harmonics: Vec<Harmonic>,
    },
    /// Samples, equally spaced over one period, the first at φ = 0. Interpolation: periodic monotone cubic (F. N.
    /// Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17 (1980) 238–246, doi:10.1137/0717021) with the harmonic-mean
    /// slopes of Brodlie. It passes through all samples and has no extremum between them. The integrators use the
    /// cubics exactly.
    Samples {
        /// Samples, N/m; not negative.
        values_n_per_m: Vec<f64>,
    },
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

    /// Value at any phase, N/m; of many phases by [`Stiffness::curve`].
    pub fn at(&self, phase: f64) -> f64 {
        self.curve().at_n_per_m(phase)
    }

    /// The stiffness for its evaluation at many phases.
    pub fn curve(&self) -> StiffnessCurve {
        StiffnessCurve(StiffnessWaveform::new(self, 0.0, 1.0))
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

/// A mesh stiffness in the form in which it is evaluated.
#[derive(Debug, Clone)]
pub struct StiffnessCurve(StiffnessWaveform);

impl StiffnessCurve {
    /// Value at any phase, N/m.
    pub fn at_n_per_m(&self, phase: f64) -> f64 {
        let phase = phase.rem_euclid(1.0);
        self.0.value(phase, phase)
    }
}

/// Periodic impact force F_s of one half, tangential in the transverse plane, N.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ImpactExcitation {
    /// F_s(φ) = force · sin(π (φ − start) / duration) for 0 ≤ φ − start < duration, once per mesh period. Pulses longer
    /// than a mesh period overlap and add up.
    HalfSine {
        /// Amplitude, N.
        force_n: f64,
        /// Duration in mesh periods, 1e-9 to 16.
        duration_mesh_periods: f64,
        /// Start in mesh periods.
        start_mesh_periods: f64,
    },
    /// F_s(φ) = Σ_i amplitude_i cos(2π i φ + phase_i), amplitudes in N.
    Harmonics {
        /// Harmonics from the first, amplitudes in N.
        harmonics: Vec<Harmonic>,
    },
}

/// Longest half sine, in mesh periods; up to 16 pulses then overlap.
const MAX_PULSE_MESH_PERIODS: f64 = 16.0;

impl ImpactExcitation {
    /// Mean over one mesh period, N.
    pub fn mean_n(&self) -> f64 {
        match self {
            ImpactExcitation::HalfSine { force_n, duration_mesh_periods, .. } => {
                force_n * duration_mesh_periods * 2.0 / PI
            }
            ImpactExcitation::Harmonics { .. } => 0.0,
        }
    }

    /// Whether the force is zero at all phases.
    pub fn is_zero(&self) -> bool {
        match self {
            ImpactExcitation::HalfSine { force_n, .. } => *force_n == 0.0,
            ImpactExcitation::Harmonics { harmonics } => harmonics.iter().all(|h| h.amplitude == 0.0),
        }
    }

    pub(super) fn validate(&self) -> Result<(), DynamicsError> {
        let check = |ok: bool, value, reason| {
            if ok { Ok(()) } else { Err(DynamicsError::InvalidParameter { name: "impact", value, reason }) }
        };
        match self {
            ImpactExcitation::HalfSine { force_n, duration_mesh_periods: d, start_mesh_periods } => {
                check(force_n.is_finite(), *force_n, "the force must be finite")?;
                check(start_mesh_periods.is_finite(), *start_mesh_periods, "the start must be finite")?;
                check(*d >= 1e-9 && *d <= MAX_PULSE_MESH_PERIODS, *d, "the duration must be 1e-9 to 16 mesh periods")
            }
            ImpactExcitation::Harmonics { harmonics } => harmonics.iter().try_for_each(|h| {
                check(h.amplitude.is_finite() && h.phase_rad.is_finite(), h.amplitude, "harmonics must be finite")
            }),
        }
    }
}

/// Number of Taylor coefficients of one parity (orders 0, 2, 4 … or 1, 3, 5 …).
const PER_PARITY: usize = MAX_ORDER / 2 + 1;

/// Truncated Fourier series with the tables of its Taylor coefficients in scaled time.
#[derive(Debug, Clone)]
pub(crate) struct FourierSeries<R> {
    constant: R,
    terms: Vec<HarmonicTerm<R>>,
}

/// One harmonic a cos(iθ + φ).
#[derive(Debug, Clone)]
struct HarmonicTerm<R> {
    /// a cosφ and a sinφ.
    cos: R,
    sin: R,
    /// (i ω/ω_ref)^n / n! with the signs of the derivatives of the cosine: n even, factor of a cos(iθ + φ); n odd,
    /// factor of a sin(iθ + φ).
    even: [R; PER_PARITY],
    odd: [R; PER_PARITY],
}

impl FourierSeries<f64> {
    fn new(constant: f64, factor: f64, harmonics: &[Harmonic], shift: f64, period_tau: f64) -> Self {
        let term = |(i, h): (usize, &Harmonic)| {
            let order = (i + 1) as f64;
            let (sin, cos) = (h.phase_rad - TAU * order * shift).sin_cos();
            let (mut even, mut odd) = ([0.0; PER_PARITY], [0.0; PER_PARITY]);
            let mut power = 1.0;
            for n in 0..2 * PER_PARITY {
                let sign = if matches!(n % 4, 0 | 3) { 1.0 } else { -1.0 };
                if n % 2 == 0 {
                    even[n / 2] = sign * power;
                } else {
                    odd[n / 2] = sign * power;
                }
                power *= TAU * order / (period_tau * (n + 1) as f64);
            }
            HarmonicTerm { cos: factor * h.amplitude * cos, sin: factor * h.amplitude * sin, even, odd }
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

impl FourierSeries<f64> {
    /// Series of a displacement; None without harmonics.
    pub(crate) fn of_displacement(harmonics: &[Harmonic], shift: f64, period_tau: f64) -> Option<Self> {
        let moves = harmonics.iter().any(|h| h.amplitude != 0.0);
        moves.then(|| Self::new(0.0, 1.0, harmonics, shift, period_tau))
    }

    /// Complex amplitude of a mesh order: the series is the sum of amplitude · exp(2πi · order · phase) over positive
    /// and negative orders.
    pub(super) fn amplitude(&self, order: usize) -> Complex<f64> {
        if order == 0 {
            return Complex::new(self.constant, 0.0);
        }
        self.terms.get(order - 1).map_or(Complex::ZERO, |term| Complex::new(0.5 * term.cos, 0.5 * term.sin))
    }

    /// Highest order.
    pub(super) fn orders(&self) -> usize {
        self.terms.len()
    }

    /// Value and derivative by the phase.
    pub(crate) fn value_and_rate(&self, phase: f64) -> (f64, f64) {
        self.terms.iter().enumerate().fold((self.constant, 0.0), |(value, rate), (i, term)| {
            let order = TAU * (i + 1) as f64;
            let (sin, cos) = (order * phase).sin_cos();
            (value + term.cos * cos - term.sin * sin, rate - order * (term.cos * sin + term.sin * cos))
        })
    }
}

impl<R: Real> FourierSeries<R> {
    pub(crate) fn zero() -> Self {
        Self { constant: R::splat(0.0), terms: Vec::new() }
    }

    /// Sets the series of one lane. Shorter series are padded with zero terms.
    pub(crate) fn put(&mut self, lane: usize, one: &FourierSeries<f64>) {
        let zero = R::splat(0.0);
        while self.terms.len() < one.terms.len() {
            self.terms.push(HarmonicTerm { cos: zero, sin: zero, even: [zero; PER_PARITY], odd: [zero; PER_PARITY] });
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

    /// Whether no lane has harmonics.
    #[inline(always)]
    pub(crate) fn is_constant(&self) -> bool {
        self.terms.is_empty()
    }

    /// Taylor coefficients in scaled time, orders 0 to `order`.
    #[inline(always)]
    pub(crate) fn fill(&self, phase: R, order: usize, out: &mut [R; MAX_ORDER + 1]) {
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

/// Stiffness waveform in the form the integrators use. `period_tau` is one mesh period in scaled time.
#[derive(Debug, Clone)]
pub(crate) struct StiffnessWaveform {
    kind: StiffnessKind,
    shift: f64,
    period_tau: f64,
}

#[derive(Debug, Clone)]
enum StiffnessKind {
    Fourier(FourierSeries<f64>),
    Pieces(Vec<[f64; 4]>),
}

impl StiffnessWaveform {
    pub(crate) fn new(stiffness: &Stiffness, shift: f64, period_tau: f64) -> Self {
        let kind = match stiffness {
            Stiffness::Constant { mean_n_per_m } => {
                StiffnessKind::Fourier(FourierSeries::new(*mean_n_per_m, 0.0, &[], shift, period_tau))
            }
            Stiffness::Fourier { mean_n_per_m, harmonics } => {
                StiffnessKind::Fourier(FourierSeries::new(*mean_n_per_m, *mean_n_per_m, harmonics, shift, period_tau))
            }
            Stiffness::Samples { values_n_per_m } => StiffnessKind::Pieces(monotone_cubics(values_n_per_m)),
        };
        Self { kind, shift, period_tau }
    }

    /// Values at equally spaced phases from 0, N/m; `fourier`: of as many samples.
    pub(super) fn sample(&self, fourier: &mut Fourier, out: &mut [f64]) {
        match &self.kind {
            StiffnessKind::Fourier(series) if 2 * series.orders() < out.len() => {
                fourier.samples((0..=series.orders()).map(|order| series.amplitude(order)), out);
            }
            _ => {
                let count = out.len() as f64;
                for (i, value) in out.iter_mut().enumerate() {
                    let phase = i as f64 / count;
                    *value = self.value(phase, phase);
                }
            }
        }
    }

    /// Appends the phases at which the waveform is not smooth.
    pub(crate) fn breakpoints(&self, out: &mut Vec<f64>) {
        if let StiffnessKind::Pieces(pieces) = &self.kind
            && pieces.len() > 1
        {
            out.extend((0..pieces.len()).map(|i| (i as f64 / pieces.len() as f64 + self.shift).rem_euclid(1.0)));
        }
    }

    /// Index of the cubic that contains `interior`, and the position of `phase` in it.
    fn piece(&self, count: usize, phase: f64, interior: f64) -> (usize, f64) {
        let n = count as f64;
        let index = (((interior - self.shift).rem_euclid(1.0) * n) as usize).min(count - 1);
        let mut u = (phase - self.shift).rem_euclid(1.0) * n - index as f64;
        // The start of a piece can be the end of its neighbour, one period away.
        if u > 0.5 * n + 0.5 {
            u -= n;
        } else if u < 0.5 - 0.5 * n {
            u += n;
        }
        (index, u)
    }

    /// Value at `phase`, on the smooth interval that contains `interior`, N/m.
    pub(crate) fn value(&self, phase: f64, interior: f64) -> f64 {
        match &self.kind {
            StiffnessKind::Fourier(series) => series.value(phase),
            StiffnessKind::Pieces(pieces) => {
                let (i, u) = self.piece(pieces.len(), phase, interior);
                let c = &pieces[i];
                c[0] + u * (c[1] + u * (c[2] + u * c[3]))
            }
        }
    }

    /// The Fourier series, if the waveform is one (a constant is a series without terms).
    pub(crate) fn series(&self) -> Option<&FourierSeries<f64>> {
        match &self.kind {
            StiffnessKind::Fourier(series) => Some(series),
            StiffnessKind::Pieces(_) => None,
        }
    }

    /// Taylor coefficients about `phase`, orders 0 to 3; the higher ones are zero. None for a Fourier series.
    #[inline(always)]
    pub(crate) fn cubic(&self, phase: f64, interior: f64) -> Option<[f64; 4]> {
        let StiffnessKind::Pieces(pieces) = &self.kind else { return None };
        let (i, u) = self.piece(pieces.len(), phase, interior);
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

/// Impact waveform in the form the integrators use.
#[derive(Debug, Clone)]
pub(crate) enum ImpactWaveform {
    None,
    HalfSine { force_n: f64, duration: f64, start: f64, power: Coefficients },
    Harmonics(FourierSeries<f64>),
}

impl ImpactWaveform {
    pub(crate) fn new(impact: Option<&ImpactExcitation>, shift: f64, period_tau: f64) -> Self {
        match impact {
            None => ImpactWaveform::None,
            Some(ImpactExcitation::HalfSine { force_n, .. }) if *force_n == 0.0 => ImpactWaveform::None,
            Some(ImpactExcitation::HalfSine { force_n, duration_mesh_periods: duration, start_mesh_periods }) => {
                let mut power = [1.0; MAX_ORDER + 1];
                for n in 1..=MAX_ORDER {
                    power[n] = power[n - 1] * PI / (duration * period_tau * n as f64);
                }
                let start = (start_mesh_periods + shift).rem_euclid(1.0);
                ImpactWaveform::HalfSine { force_n: *force_n, duration: *duration, start, power }
            }
            Some(ImpactExcitation::Harmonics { harmonics }) => {
                ImpactWaveform::Harmonics(FourierSeries::new(0.0, 1.0, harmonics, shift, period_tau))
            }
        }
    }

    /// Upper bound of the magnitude of the force, N.
    pub(crate) fn largest_n(&self) -> f64 {
        match self {
            ImpactWaveform::None => 0.0,
            ImpactWaveform::HalfSine { force_n, duration, .. } => force_n.abs() * duration.ceil(),
            ImpactWaveform::Harmonics(series) => series.terms.iter().map(|t| t.cos.hypot(t.sin)).sum(),
        }
    }

    /// Taylor coefficients in scaled time about `phase`, orders 0 to `order`, of the force on the smooth interval that
    /// contains `interior`, N. False, with `out` unchanged, where there is none.
    pub(crate) fn taylor(&self, phase: f64, interior: f64, order: usize, out: &mut [f64; MAX_ORDER + 1]) -> bool {
        match self {
            ImpactWaveform::None => false,
            ImpactWaveform::HalfSine { force_n, duration, start, power } => {
                let (sin, cos) = Self::sine(phase, interior, *duration, *start);
                let signed = [sin, cos, -sin, -cos];
                for n in 0..=order {
                    out[n] = force_n * power[n] * signed[n & 3];
                }
                sin != 0.0 || cos != 0.0
            }
            ImpactWaveform::Harmonics(series) => {
                series.fill(phase, order, out);
                true
            }
        }
    }

    pub(crate) fn breakpoints(&self, out: &mut Vec<f64>) {
        if let ImpactWaveform::HalfSine { duration, start, .. } = self {
            out.push(start.rem_euclid(1.0));
            out.push((start + duration).rem_euclid(1.0));
        }
    }

    /// Sine and cosine of the pulses that are active at `interior`, at `phase`, summed.
    fn sine(phase: f64, interior: f64, duration: f64, start: f64) -> (f64, f64) {
        let mut offset = interior - start;
        offset -= offset.floor();
        // `offset` is the age of the youngest pulse at `interior`; the others are older by whole periods.
        let age = offset + (phase - interior);
        let (mut sin, mut cos, mut older) = (0.0, 0.0, 0.0);
        while offset + older < duration {
            let (s, c) = (PI * (age + older) / duration).sin_cos();
            sin += s;
            cos += c;
            older += 1.0;
        }
        (sin, cos)
    }

    pub(crate) fn value(&self, phase: f64, interior: f64) -> f64 {
        match self {
            ImpactWaveform::None => 0.0,
            ImpactWaveform::HalfSine { force_n, duration, start, .. } => {
                force_n * Self::sine(phase, interior, *duration, *start).0
            }
            ImpactWaveform::Harmonics(series) => series.value(phase),
        }
    }

    /// F sin and F cos of the active pulses at `phase` (those that are active at `interior`), N; None for harmonics.
    #[inline(always)]
    pub(crate) fn pulse(&self, phase: f64, interior: f64) -> Option<(f64, f64)> {
        let ImpactWaveform::HalfSine { force_n, duration, start, .. } = self else { return None };
        let (sin, cos) = Self::sine(phase, interior, *duration, *start);
        Some((force_n * sin, force_n * cos))
    }

    /// (π/(duration · period))^n / n! of a half sine.
    pub(crate) fn powers(&self) -> Option<&Coefficients> {
        match self {
            ImpactWaveform::HalfSine { power, .. } => Some(power),
            _ => None,
        }
    }

    pub(crate) fn series(&self) -> Option<&FourierSeries<f64>> {
        match self {
            ImpactWaveform::Harmonics(series) => Some(series),
            _ => None,
        }
    }
}
