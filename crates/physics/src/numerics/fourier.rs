//! Fourier series of periodic functions from equally spaced samples, and back.

use std::cell::RefCell;
use std::sync::Arc;

use nalgebra::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

thread_local! {
    /// Plans depend on the number of samples alone.
    static PLANNER: RefCell<RealFftPlanner<f64>> = RefCell::new(RealFftPlanner::new());
}

/// Transforms of a number of samples, with their memory.
pub(crate) struct Fourier {
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    samples: Vec<f64>,
    spectrum: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl Fourier {
    /// Transforms of `count` samples over the period, an even number.
    pub(crate) fn new(count: usize) -> Self {
        let (forward, inverse) = PLANNER.with(|planner| {
            let mut planner = planner.borrow_mut();
            (planner.plan_fft_forward(count), planner.plan_fft_inverse(count))
        });
        let scratch = vec![Complex::ZERO; forward.get_scratch_len().max(inverse.get_scratch_len())];
        Self { samples: forward.make_input_vec(), spectrum: forward.make_output_vec(), forward, inverse, scratch }
    }

    /// Complex amplitudes of the orders from 0: the function is the sum of amplitude · exp(2πi · order · phase) over
    /// positive and negative orders. The highest order of the samples has no phase and is left out: there are half as
    /// many amplitudes as samples.
    pub(crate) fn amplitudes(&mut self, samples: impl Iterator<Item = f64>, out: &mut [Complex<f64>]) {
        self.samples.iter_mut().zip(samples).for_each(|(to, from)| *to = from);
        let scratch = &mut self.scratch[..self.forward.get_scratch_len()];
        // The lengths are those of the plan, so this cannot fail.
        if self.forward.process_with_scratch(&mut self.samples, &mut self.spectrum, scratch).is_err() {
            self.spectrum.fill(Complex::new(f64::NAN, 0.0));
        }
        let part = 1.0 / self.samples.len() as f64;
        out.iter_mut().zip(&self.spectrum).for_each(|(to, from)| *to = from * part);
    }

    /// Samples of the function with these amplitudes by order from 0.
    pub(crate) fn samples(&mut self, amplitudes: impl Iterator<Item = Complex<f64>>, out: &mut [f64]) {
        self.spectrum.fill(Complex::ZERO);
        self.spectrum.iter_mut().zip(amplitudes).for_each(|(to, from)| *to = from);
        self.spectrum[0].im = 0.0;
        let scratch = &mut self.scratch[..self.inverse.get_scratch_len()];
        if self.inverse.process_with_scratch(&mut self.spectrum, out, scratch).is_err() {
            out.fill(f64::NAN);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_series_is_that_of_its_samples() {
        let mut fourier = Fourier::new(16);
        let function = |phase: f64| 3.0 + 2.0 * (TAU * phase + 0.4).cos() - (3.0 * TAU * phase).sin();
        let mut amplitudes = vec![Complex::ZERO; 8];
        fourier.amplitudes((0..16).map(|i| function(i as f64 / 16.0)), &mut amplitudes);
        for (order, expected) in [
            (0, Complex::new(3.0, 0.0)),
            (1, Complex::from_polar(1.0, 0.4)),
            (2, Complex::ZERO),
            (3, Complex::new(0.0, 0.5)),
        ] {
            assert!((amplitudes[order] - expected).norm() < 1e-14, "{order}: {}", amplitudes[order]);
        }
        let mut finer = vec![0.0; 32];
        Fourier::new(32).samples(amplitudes.into_iter(), &mut finer);
        for (i, value) in finer.iter().enumerate() {
            assert!((value - function(i as f64 / 32.0)).abs() < 1e-13, "{i}");
        }
    }
}
