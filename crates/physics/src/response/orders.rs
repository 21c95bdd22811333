//! Amplitudes and phases of the mesh orders of a channel.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::statistics::{GAUSS, NODES};

/// Number of mesh orders, from the first.
pub const MESH_ORDERS: usize = 10;

/// One mesh order i of a quantity: `amplitude · cos(2π i φ + phase_rad)` over the mesh phase φ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeshOrder {
    /// Amplitude in the unit of the quantity.
    pub amplitude: f64,
    /// Phase angle, −π … π, rad.
    pub phase_rad: f64,
}

/// Cosines and sines of the mesh orders at the nodes of a segment.
pub(super) struct OrderTable {
    cos: [[f64; NODES]; MESH_ORDERS],
    sin: [[f64; NODES]; MESH_ORDERS],
}

impl OrderTable {
    pub(crate) fn new() -> Box<Self> {
        Box::new(Self { cos: [[0.0; NODES]; MESH_ORDERS], sin: [[0.0; NODES]; MESH_ORDERS] })
    }

    /// Sets the table of a segment from the mesh phase at its start and its length in mesh periods.
    pub(crate) fn set(&mut self, phase: f64, length: f64) {
        for (q, (node, weight)) in GAUSS.iter().enumerate() {
            let (sin1, cos1) = (TAU * (phase + node * length)).sin_cos();
            let (mut sin, mut cos) = (sin1 * weight, cos1 * weight);
            for i in 0..MESH_ORDERS {
                (self.cos[i][q], self.sin[i][q]) = (cos, sin);
                (sin, cos) = (sin * cos1 + cos * sin1, cos * cos1 - sin * sin1);
            }
        }
    }
}

/// Fourier integrals of a channel over whole mesh periods, by Gauss quadrature on every segment: exact to rounding for
/// segments below half a mesh period.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct OrderAccumulator {
    /// Integrals with the cosine and the sine of each order.
    cos: [f64; MESH_ORDERS],
    sin: [f64; MESH_ORDERS],
    length: f64,
}

impl OrderAccumulator {
    /// Adds the values at the nodes of a segment of `length` mesh periods; they may lack a constant.
    #[inline(always)]
    pub(crate) fn add(&mut self, values: &[f64; NODES], table: &OrderTable, length: f64) {
        for i in 0..MESH_ORDERS {
            let (mut c, mut s) = (0.0, 0.0);
            for q in 0..NODES {
                c += values[q] * table.cos[i][q];
                s += values[q] * table.sin[i][q];
            }
            self.cos[i] += length * c;
            self.sin[i] += length * s;
        }
        self.length += length;
    }

    pub(crate) fn finish(&self) -> Vec<MeshOrder> {
        let factor = 2.0 / self.length;
        // f cos(a) and f sin(a) integrate to A cos(phase)/2 and −A sin(phase)/2.
        let order = |(c, s): (&f64, &f64)| MeshOrder {
            amplitude: factor * c.hypot(*s),
            phase_rad: if *c == 0.0 && *s == 0.0 { 0.0 } else { (-s).atan2(*c) },
        };
        self.cos.iter().zip(&self.sin).map(order).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::statistics::MomentAccumulator;

    /// A parabola in each of several uneven segments against its Fourier integrals.
    #[test]
    fn orders_of_a_sawtooth() {
        // f(φ) = φ on 0 … 1: order i has the amplitude 1/(π i) and the phase π/2.
        let mut moments = MomentAccumulator::new(false);
        let mut orders = OrderAccumulator::default();
        let mut table = OrderTable::new();
        let cuts = [0.0, 0.13, 0.5, 0.81, 1.0];
        for cut in cuts.windows(2) {
            let length = cut[1] - cut[0];
            table.set(cut[0], length);
            // Time runs three times as fast as the phase.
            let values = moments.add_with_values(&[cut[0], 1.0 / 3.0], 3.0 * length, false);
            orders.add(&values, &table, length);
        }
        let found = orders.finish();
        assert_eq!(found.len(), MESH_ORDERS);
        for (i, order) in found.iter().enumerate() {
            let expected = 1.0 / (std::f64::consts::PI * (i + 1) as f64);
            assert!((order.amplitude - expected).abs() < 1e-13, "{i} {order:?}");
            assert!((order.phase_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-11, "{i} {order:?}");
        }
    }
}
