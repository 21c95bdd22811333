//! Scrambled Sobol points.

/// Number of points of a sequence: more are not independent of each other.
pub const MAX_SOBOL_POINTS: u32 = 1 << 16;

/// A point of the Sobol sequence with the Owen scrambling of a seed (Burley 2020, Journal of Computer Graphics
/// Techniques 9 (4)), in the open unit cube. The coordinates have 24 bits.
pub fn sobol_point(index: u32, dimensions: usize, seed: u32) -> Vec<f64> {
    let half_step = 0.5 / f64::from(1u32 << 24);
    let index = index % MAX_SOBOL_POINTS;
    (0..dimensions as u32)
        .map(|dimension| f64::from(sobol_burley::sample(index, dimension, seed)) + half_step)
        .collect()
}
