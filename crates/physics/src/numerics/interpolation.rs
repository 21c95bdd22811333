//! Interpolation between tabulated points.

/// Linear interpolation of `y` over ascending `x` at `at`, constant beyond both ends; at least two points.
pub(crate) fn linear(x: &[f64], y: &[f64], at: f64) -> f64 {
    let i = x.partition_point(|&v| v <= at).clamp(1, x.len() - 1);
    let t = ((at - x[i - 1]) / (x[i] - x[i - 1])).clamp(0.0, 1.0);
    y[i - 1] + t * (y[i] - y[i - 1])
}

/// Lagrange's polynomial of node `k` of `nodes` at `x`: 1 at that node, 0 at the others.
pub(crate) fn lagrange(nodes: &[f64], k: usize, x: f64) -> f64 {
    let mut value = 1.0;
    for (i, node) in nodes.iter().enumerate() {
        if i != k {
            value *= (x - node) / (nodes[k] - node);
        }
    }
    value
}
