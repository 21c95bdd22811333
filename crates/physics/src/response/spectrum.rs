//! Amplitude spectrum of a recorded channel.

use realfft::RealFftPlanner;
use serde::{Deserialize, Serialize};

use super::channel::Channel;

/// One-sided amplitude spectrum: a sine of amplitude A has the value A at its order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spectrum {
    /// Multiples of the mesh frequency.
    pub mesh_order: Vec<f64>,
    /// Frequencies of the lines, Hz.
    pub frequency_hz: Vec<f64>,
    /// Amplitudes in the unit of the channel, without the mean.
    pub amplitude: Vec<f64>,
}

impl Spectrum {
    /// Spectrum of a channel recorded over whole mesh periods, without a window, so that the mesh orders are lines.
    /// Empty for an empty channel.
    pub fn of(channel: &Channel, mesh_frequency_hz: f64) -> Self {
        let n = channel.values.len();
        if n == 0 {
            return Self { mesh_order: Vec::new(), frequency_hz: Vec::new(), amplitude: Vec::new() };
        }
        let mean = channel.values.iter().sum::<f64>() / n as f64;
        let fft = RealFftPlanner::<f64>::new().plan_fft_forward(n);
        let mut input: Vec<f64> = channel.values.iter().map(|v| v - mean).collect();
        let mut output = fft.make_output_vec();
        // The lengths are those of the plan, so this cannot fail; if it did, the spectrum would be empty.
        if fft.process(&mut input, &mut output).is_err() {
            output.clear();
        }
        let line_hz = 1.0 / (n as f64 * channel.dt_s);
        let scale = |i: usize| if i == 0 || 2 * i == n { 1.0 / n as f64 } else { 2.0 / n as f64 };
        let frequency_hz: Vec<f64> = (0..output.len()).map(|i| i as f64 * line_hz).collect();
        Self {
            mesh_order: frequency_hz.iter().map(|f| f / mesh_frequency_hz).collect(),
            amplitude: output.iter().enumerate().map(|(i, c)| c.norm() * scale(i)).collect(),
            frequency_hz,
        }
    }
}

/// Band amplitudes.
impl Spectrum {
    /// One amplitude for each of the mesh orders 1/`per_order`, 2/`per_order`, … `last_order`: the root of the sum of
    /// squares of the lines nearest to that order. For a single line it is the amplitude of the line; half the sum of
    /// the squares of all bands is the mean square of the channel, except for lines below the first or above the last
    /// band.
    pub fn bands(&self, per_order: usize, last_order: usize) -> Vec<f64> {
        let mut squares = vec![0.0; per_order * last_order];
        for (order, amplitude) in self.mesh_order.iter().zip(&self.amplitude) {
            let band = (order * per_order as f64).round() as usize;
            if let Some(sum) = band.checked_sub(1).and_then(|index| squares.get_mut(index)) {
                *sum += amplitude * amplitude;
            }
        }
        squares.into_iter().map(f64::sqrt).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::ChannelQuantity;

    #[test]
    fn a_sine_shows_as_its_amplitude() {
        let n = 480;
        let values =
            (0..n).map(|i| 3.0 + 2.5 * (std::f64::consts::TAU * 4.0 * f64::from(i) / f64::from(n)).sin()).collect();
        let channel = Channel {
            name: "x_left".into(),
            quantity: ChannelQuantity::Displacement,
            unit: "m".into(),
            t0_s: 0.0,
            dt_s: 1.0 / 480.0,
            values,
        };
        let s = Spectrum::of(&channel, 2.0);
        assert!((s.amplitude[4] - 2.5).abs() < 1e-12 && (s.mesh_order[4] - 2.0).abs() < 1e-12);
        assert!(s.amplitude.iter().enumerate().all(|(i, a)| i == 4 || *a < 1e-12));
        let bands = s.bands(4, 3);
        assert!(bands.len() == 12 && (bands[7] - 2.5).abs() < 1e-12, "order 2 is the eighth quarter: {bands:?}");
    }
}
