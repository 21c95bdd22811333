//! Simplex search.

use crate::cma_es::mirrored;
use crate::score::Score;

/// Simplex search of Nelder and Mead with the coefficients of Gao and Han (2012, doi:10.1007/s10589-010-9329-3) on the
/// unit cube. Points outside are mirrored at its faces. Only the order of the scores matters.
#[derive(Debug, Clone)]
pub struct NelderMead {
    /// Corners from the best to the worst, once all are known.
    corners: Vec<(Vec<f64>, Score)>,
    pending: Pending,
}

#[derive(Debug, Clone)]
enum Pending {
    /// Corners to be evaluated: of the start, or of a simplex that shrank.
    Corners(Vec<Vec<f64>>),
    Reflection(Vec<f64>),
    Expansion {
        reflected: (Vec<f64>, Score),
        point: Vec<f64>,
    },
    /// `limit`: the score that the point has to reach.
    Contraction {
        limit: Score,
        point: Vec<f64>,
    },
}

impl NelderMead {
    /// A simplex with a corner at `start`, which is known, and the others `size` away along each axis, away from the
    /// nearer face.
    pub fn new(start: &[f64], score: Score, size: f64) -> Self {
        let corner = |axis: usize| {
            let mut corner = start.to_vec();
            corner[axis] += if start[axis] <= 0.5 { size } else { -size };
            corner
        };
        let corners = (0..start.len()).map(corner).collect();
        Self { corners: vec![(start.to_vec(), score)], pending: Pending::Corners(corners) }
    }

    fn n(&self) -> f64 {
        self.corners[0].0.len() as f64
    }

    /// Largest distance of a corner from the best one along an axis.
    pub fn size(&self) -> f64 {
        let best = &self.corners[0].0;
        let distances = self.corners.iter().flat_map(|(corner, _)| corner.iter().zip(best).map(|(a, b)| (a - b).abs()));
        distances.fold(0.0, f64::max)
    }

    /// True once every corner has been evaluated.
    pub fn is_complete(&self) -> bool {
        !matches!(self.pending, Pending::Corners(_))
    }

    /// Scores of the best and the worst corner.
    pub fn extremes(&self) -> [Score; 2] {
        [self.corners[0].1, self.corners[self.corners.len() - 1].1]
    }

    /// The points to be evaluated next.
    pub fn ask(&self) -> Vec<Vec<f64>> {
        match &self.pending {
            Pending::Corners(corners) => corners.clone(),
            Pending::Reflection(point) | Pending::Expansion { point, .. } | Pending::Contraction { point, .. } => {
                vec![point.clone()]
            }
        }
    }

    /// Takes the scores of the points of [`NelderMead::ask`].
    pub fn tell(&mut self, scores: &[Score]) {
        let Some(&score) = scores.first() else { return };
        match std::mem::replace(&mut self.pending, Pending::Corners(Vec::new())) {
            Pending::Corners(corners) => self.corners.extend(corners.into_iter().zip(scores.iter().copied())),
            Pending::Reflection(point) => {
                let count = self.corners.len();
                let [best, second_worst, worst] = [0, count.saturating_sub(2), count - 1].map(|at| self.corners[at].1);
                if score.is_better_than(&best) {
                    let expanded = self.along(1.0 + 2.0 / self.n());
                    self.pending = Pending::Expansion { reflected: (point, score), point: expanded };
                    return;
                }
                if score.is_better_than(&second_worst) {
                    self.replace_worst(point, score);
                } else {
                    let part = 0.75 - 0.5 / self.n();
                    let is_outside = score.is_better_than(&worst);
                    let contracted = self.along(if is_outside { part } else { -part });
                    let limit = if is_outside { score } else { worst };
                    self.pending = Pending::Contraction { limit, point: contracted };
                    return;
                }
            }
            Pending::Expansion { reflected, point } => {
                let better = if score.is_better_than(&reflected.1) { (point, score) } else { reflected };
                self.replace_worst(better.0, better.1);
            }
            Pending::Contraction { limit, point } => {
                if !score.is_better_than(&limit) {
                    self.shrink();
                    return;
                }
                self.replace_worst(point, score);
            }
        }
        self.corners.sort_by(|a, b| a.1.compare(&b.1));
        self.pending = Pending::Reflection(self.along(1.0));
    }

    fn replace_worst(&mut self, point: Vec<f64>, score: Score) {
        self.corners.pop();
        self.corners.push((point, score));
    }

    /// The point `part` times the distance of the worst corner from the centre of the others beyond it.
    fn along(&self, part: f64) -> Vec<f64> {
        let (worst, others) = (&self.corners[self.corners.len() - 1].0, &self.corners[..self.corners.len() - 1]);
        let centre = |axis: usize| others.iter().map(|(corner, _)| corner[axis]).sum::<f64>() / others.len() as f64;
        (0..worst.len()).map(|axis| mirrored(centre(axis) + part * (centre(axis) - worst[axis]))).collect()
    }

    fn shrink(&mut self) {
        let part = 1.0 - 1.0 / self.n().max(2.0);
        let best = self.corners[0].0.clone();
        let towards = |corner: &[f64]| corner.iter().zip(&best).map(|(x, b)| b + part * (x - b)).collect();
        let moved = self.corners[1..].iter().map(|(corner, _)| towards(corner)).collect();
        self.corners.truncate(1);
        self.pending = Pending::Corners(moved);
    }
}
