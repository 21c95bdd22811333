//! Functions along the face: cubic B-splines on graded cells (de Boor, A Practical Guide to Splines).

use crate::numerics::gauss::{gauss_legendre, on_interval};

/// Order (degree + 1) of the splines.
const ORDER: usize = 4;

/// End cells are this part of an inner cell.
const END_CELL: f64 = 0.7;

/// Borders of `cells` cells on [0, width], the first and last shorter than the others.
pub(super) fn graded_cells(width: f64, cells: usize) -> Vec<f64> {
    if cells < 3 {
        return (0..=cells).map(|i| width * i as f64 / cells as f64).collect();
    }
    let inner = width / (cells as f64 - 2.0 + 2.0 * END_CELL);
    let mut borders = vec![0.0];
    borders.extend((0..cells - 1).map(|i| inner * (END_CELL + i as f64)));
    borders.push(width);
    borders
}

/// A space of splines on [0, b]; open at the ends, so that the first and the last function carry the end values.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SplineSpace {
    order: usize,
    borders: Vec<f64>,
    knots: Vec<f64>,
}

impl SplineSpace {
    /// Twice continuously differentiable cubics on the cells between `borders` (at least two, rising).
    pub(super) fn cubic(borders: Vec<f64>) -> SplineSpace {
        SplineSpace::of_order(ORDER, borders)
    }

    /// The constant alone: what makes a body endless (plane strain) when the face's length is one.
    #[cfg(test)]
    pub(super) fn constant(width: f64) -> SplineSpace {
        SplineSpace::of_order(1, vec![0.0, width])
    }

    fn of_order(order: usize, borders: Vec<f64>) -> SplineSpace {
        let mut knots = vec![borders[0]; order - 1];
        knots.extend(&borders);
        knots.extend(std::iter::repeat_n(borders[borders.len() - 1], order - 1));
        SplineSpace { order, borders, knots }
    }

    /// Number of functions.
    pub(super) fn len(&self) -> usize {
        self.knots.len() - self.order
    }

    /// Interval in which function `i` differs from zero.
    pub(super) fn support(&self, i: usize) -> (f64, f64) {
        (self.knots[i], self.knots[i + self.order])
    }

    /// Index of the first function that differs from zero at `z`, and values and slopes of all that do.
    pub(super) fn at(&self, z: f64) -> (usize, [f64; ORDER], [f64; ORDER]) {
        let k = self.order;
        let last = self.borders.len() - 2;
        let cell = self.borders.partition_point(|&b| b <= z).saturating_sub(1).min(last);
        let span = cell + k - 1;
        let mut values = [0.0; ORDER];
        let mut lower = [0.0; ORDER];
        values[0] = 1.0;
        for degree in 1..k {
            lower = values;
            let mut carried = 0.0;
            for r in 0..degree {
                let right = self.knots[span + r + 1];
                let left = self.knots[span + 1 + r - degree];
                let part = lower[r] / (right - left);
                values[r] = carried + (right - z) * part;
                carried = (z - left) * part;
            }
            values[degree] = carried;
        }
        let mut slopes = [0.0; ORDER];
        if k > 1 {
            let degree = k - 1;
            for r in 0..degree {
                let right = self.knots[span + r + 1];
                let left = self.knots[span + 1 + r - degree];
                let part = degree as f64 * lower[r] / (right - left);
                slopes[r] -= part;
                slopes[r + 1] += part;
            }
        }
        (span + 1 - k, values, slopes)
    }

    fn borders_with(&self, other: &[f64]) -> Vec<f64> {
        let mut all: Vec<f64> = self.borders.iter().chain(other).copied().collect();
        all.sort_by(f64::total_cmp);
        let tiny = 1e-12 * (all[all.len() - 1] - all[0]);
        all.dedup_by(|a, b| *a - *b < tiny);
        all
    }

    /// Integrals of every function against every piecewise linear hat between `stations`.
    pub(super) fn hat_integrals(&self, stations: &[f64]) -> Vec<Vec<(usize, f64)>> {
        let mut table = vec![vec![0.0; stations.len()]; self.len()];
        let rule = gauss_legendre(4);
        for piece in self.borders_with(stations).windows(2) {
            for (z, weight) in on_interval(&rule, piece[0], piece[1]) {
                let cell = stations.partition_point(|&s| s <= z).clamp(1, stations.len() - 1) - 1;
                let t = (z - stations[cell]) / (stations[cell + 1] - stations[cell]);
                let (first, values, _) = self.at(z);
                for (r, value) in values.iter().enumerate().take(self.order) {
                    table[first + r][cell] += weight * value * (1.0 - t);
                    table[first + r][cell + 1] += weight * value * t;
                }
            }
        }
        table.into_iter().map(|row| row.into_iter().enumerate().filter(|&(_, v)| v != 0.0).collect()).collect()
    }
}

/// Products of the functions of two spaces, integrated over the face.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SplineProducts {
    columns: usize,
    /// For every function of the first space the functions of the second that overlap it.
    ranges: Vec<(usize, usize)>,
    /// `[∫f g, ∫f g', ∫f' g, ∫f' g']`.
    values: Vec<[f64; 4]>,
}

impl SplineProducts {
    /// Integrals over the common cells of both spaces.
    pub(super) fn new(first: &SplineSpace, second: &SplineSpace) -> SplineProducts {
        let columns = second.len();
        let mut values = vec![[0.0; 4]; first.len() * columns];
        let mut ranges = vec![(usize::MAX, 0); first.len()];
        let rule = gauss_legendre(ORDER);
        for piece in first.borders_with(&second.borders).windows(2) {
            for (z, weight) in on_interval(&rule, piece[0], piece[1]) {
                let (i0, f, df) = first.at(z);
                let (j0, g, dg) = second.at(z);
                for r in 0..first.order {
                    let range = &mut ranges[i0 + r];
                    *range = (range.0.min(j0), range.1.max(j0 + second.order));
                    for s in 0..second.order {
                        let entry = &mut values[(i0 + r) * columns + j0 + s];
                        let products = [f[r] * g[s], f[r] * dg[s], df[r] * g[s], df[r] * dg[s]];
                        for (e, p) in entry.iter_mut().zip(products) {
                            *e += weight * p;
                        }
                    }
                }
            }
        }
        SplineProducts { columns, ranges, values }
    }

    /// First function of the second space that overlaps function `i` of the first, and the products from there on.
    pub(super) fn row(&self, i: usize) -> (usize, &[[f64; 4]]) {
        let (from, to) = self.ranges[i];
        (from, &self.values[i * self.columns + from..i * self.columns + to])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_sum_to_one_and_slopes_to_zero() {
        let space = SplineSpace::cubic(graded_cells(45.0, 7));
        assert_eq!(space.len(), 10);
        for k in 0..=450 {
            let (_, values, slopes) = space.at(f64::from(k) * 0.1);
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(slopes.iter().sum::<f64>().abs() < 1e-13);
        }
    }

    #[test]
    fn products_of_different_spaces_integrate_polynomials_exactly() {
        let (fine, coarse) = (SplineSpace::cubic(graded_cells(2.0, 9)), SplineSpace::cubic(graded_cells(2.0, 4)));
        let products = SplineProducts::new(&fine, &coarse);
        let mut sums = [0.0; 4];
        for i in 0..fine.len() {
            let (_, row) = products.row(i);
            for entry in row {
                sums[0] += entry[0];
                sums[3] += entry[3];
            }
        }
        assert!((sums[0] - 2.0).abs() < 1e-13, "{sums:?}");
        assert!(sums[3].abs() < 1e-11, "{sums:?}");
    }

    #[test]
    fn hats_keep_their_area() {
        let stations = graded_cells(3.0, 6);
        let space = SplineSpace::cubic(graded_cells(3.0, 5));
        let table = space.hat_integrals(&stations);
        let total: f64 = table.iter().flatten().map(|&(_, v)| v).sum();
        assert!((total - 3.0).abs() < 1e-13);
    }
}
