//! Descent between the points of a grid.

use crate::score::Score;

/// Steps from grid point to grid point along single variables, until no neighbour is better. A variable without a grid
/// is only moved to a bound that is near.
#[derive(Debug, Clone)]
pub(crate) struct Polish {
    /// Distance of the grid's points of each variable; 0: no grid.
    steps: Vec<f64>,
    best: (Vec<f64>, Option<Score>),
    /// Points of which the neighbours were asked for.
    rounds: usize,
}

/// Distance from a bound from which the bound itself is tried.
const NEAR: f64 = 0.05;
/// Most rounds.
const ROUNDS: usize = 50;

impl Polish {
    /// From the grid point nearest to `start`.
    pub(crate) fn new(start: &[f64], steps: &[f64]) -> Self {
        let point = start.iter().zip(steps).map(|(x, step)| on_grid(*x, *step)).collect();
        Self { steps: steps.to_vec(), best: (point, None), rounds: 0 }
    }

    /// The grid point nearest to `start` alone.
    pub(crate) fn nearest(start: &[f64], steps: &[f64]) -> Self {
        Self { rounds: ROUNDS, ..Self::new(start, steps) }
    }

    /// The points to be evaluated next; none when it has ended.
    pub(crate) fn ask(&self) -> Vec<Vec<f64>> {
        if self.best.1.is_none() {
            return vec![self.best.0.clone()];
        }
        if self.rounds >= ROUNDS { Vec::new() } else { self.neighbours() }
    }

    fn neighbours(&self) -> Vec<Vec<f64>> {
        let point = &self.best.0;
        let mut found = Vec::new();
        // All near bounds at once.
        let near = |(x, step): (&f64, &f64)| if *step > 0.0 { *x } else { at_near_bound(*x) };
        let together: Vec<f64> = point.iter().zip(&self.steps).map(near).collect();
        if together != *point {
            found.push(together);
        }
        for (axis, step) in self.steps.iter().enumerate() {
            let x = point[axis];
            let targets = match *step > 0.0 {
                true => [x - step, x + step].map(|x| on_grid(x, *step)),
                false => [at_near_bound(x), x],
            };
            for target in targets {
                if target != x {
                    let mut neighbour = point.clone();
                    neighbour[axis] = target;
                    found.push(neighbour);
                }
            }
        }
        found
    }

    /// Takes the scores of the points of [`Polish::ask`].
    pub(crate) fn tell(&mut self, scores: &[Score]) {
        let Some(own) = self.best.1 else {
            self.best.1 = scores.first().copied();
            return;
        };
        self.rounds += 1;
        let neighbours = self.neighbours();
        let best = neighbours.into_iter().zip(scores).fold(None, |best: Option<(Vec<f64>, &Score)>, (point, score)| {
            if best.as_ref().is_none_or(|(_, other)| score.is_better_than(other)) { Some((point, score)) } else { best }
        });
        match best {
            Some((point, score)) if score.is_better_than(&own) => self.best = (point, Some(*score)),
            _ => self.rounds = ROUNDS,
        }
    }
}

/// The bound that is near; else the number itself.
fn at_near_bound(x: f64) -> f64 {
    if x < NEAR {
        0.0
    } else if x > 1.0 - NEAR {
        1.0
    } else {
        x
    }
}

/// The nearest point of a grid that begins at 0, within \[0, 1\].
pub(crate) fn on_grid(x: f64, step: f64) -> f64 {
    if step <= 0.0 {
        return x.clamp(0.0, 1.0);
    }
    let last = (1.0 / step + 1e-9).floor();
    ((x / step).round().clamp(0.0, last) * step).min(1.0)
}
