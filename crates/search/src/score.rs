//! How good a point is.

use std::cmp::Ordering;

/// Objective and violation of the constraints at a point. Ordered feasibility first (Deb 2000,
/// doi:10.1016/S0045-7825(99)00389-8): points without violation before all others, those by their objective, the others
/// by their violation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Score {
    /// To be made as small as possible; not used while there is a violation.
    pub objective: f64,
    /// Sum of the normalised violations: 0 of a feasible point.
    pub violation: f64,
}

impl Score {
    /// A feasible point.
    pub fn feasible(objective: f64) -> Self {
        Self { objective, violation: 0.0 }
    }

    /// A point that violates constraints, or has no objective.
    pub fn infeasible(violation: f64) -> Self {
        Self { objective: f64::NAN, violation }
    }

    /// True of a point without violation that has an objective.
    pub fn is_feasible(&self) -> bool {
        self.violation <= 0.0 && !self.objective.is_nan()
    }

    /// Order of two points, the better one first.
    pub fn compare(&self, other: &Self) -> Ordering {
        let rank = |score: &Self| u8::from(!score.is_feasible());
        rank(self).cmp(&rank(other)).then_with(|| match self.is_feasible() {
            true => self.objective.total_cmp(&other.objective),
            false => self.violation.total_cmp(&other.violation),
        })
    }

    /// True if this point is better than the other one.
    pub fn is_better_than(&self, other: &Self) -> bool {
        self.compare(other) == Ordering::Less
    }
}

/// Indices of scores from the best to the worst; equal ones in their own order.
pub(crate) fn ranking(scores: &[Score]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scores.len()).collect();
    order.sort_by(|a, b| scores[*a].compare(&scores[*b]));
    order
}
