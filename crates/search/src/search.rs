//! A whole search: a first sample, runs of a method, and the end on the grid.

use crate::cma_es::CmaEs;
use crate::nelder_mead::NelderMead;
use crate::polish::{Polish, on_grid};
use crate::random::CounterRandom;
use crate::score::{Score, ranking};
use crate::sobol::sobol_point;

/// Method of the runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Nelder and Mead up to three variables, else CMA-ES.
    Auto,
    /// CMA-ES; Nelder and Mead for a single variable.
    CmaEs,
    /// Nelder and Mead.
    NelderMead,
}

/// What a search is to do.
#[derive(Debug, Clone)]
pub struct SearchSettings {
    /// The point that is known: the first one evaluated.
    pub start: Vec<f64>,
    /// Distance of the points of the grid on which each variable has to end; 0: none.
    pub steps: Vec<f64>,
    /// Seed of every random number.
    pub seed: u64,
    /// Most evaluations.
    pub evaluations: usize,
    /// Spread of a run, in the unit of the variables, at which it ends.
    pub accuracy: f64,
    /// Method of the runs.
    pub method: Method,
    /// Whether the known point is to be refined: a small run from it, without a first sample and without further runs.
    pub refines: bool,
}

impl SearchSettings {
    /// Evaluations that are usually enough: 300 + 150 n.
    pub fn usual_evaluations(dimensions: usize) -> usize {
        300 + 150 * dimensions
    }
}

/// What a batch of points is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The point that is known.
    Start,
    /// The first sample.
    Sample,
    /// A run of the method.
    Run,
    /// The neighbours of the best point on the grid.
    Polish,
}

/// Points to be evaluated, in any order or side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// The points.
    pub points: Vec<Vec<f64>>,
    /// What they are for.
    pub phase: Phase,
    /// Number of the batch.
    pub generation: u64,
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoppedBy {
    /// Further runs found nothing better.
    Tolerance,
    /// The evaluations were used up.
    Budget,
    /// The caller ended it.
    Caller,
}

/// A search in progress.
#[derive(Debug, Clone)]
pub struct Search {
    settings: SearchSettings,
    /// Every evaluated point.
    archive: Vec<(Vec<f64>, Score)>,
    best: Option<usize>,
    /// Best score of all points, on the grid or not.
    least: Score,
    step: Step,
    asked: Vec<Vec<f64>>,
    generation: u64,
    runs: u64,
    /// Points of the first sample, apart from each other, from which simplices start, the best first.
    starts: Vec<usize>,
    stopped_by: StoppedBy,
    /// Spread of the run after each batch; none outside of runs.
    spread: Option<f64>,
}

#[derive(Debug, Clone)]
enum Step {
    Start,
    Sample,
    Evolution(Box<Evolution>),
    Simplex(Simplex),
    Polish(Polish),
    End,
}

#[derive(Debug, Clone)]
struct Evolution {
    cma_es: CmaEs,
    /// Best objectives of the generations.
    bests: Vec<f64>,
    /// Best score before the run.
    before: Score,
}

#[derive(Debug, Clone)]
struct Simplex {
    nelder_mead: NelderMead,
    before: Score,
    /// Size at which it ends.
    ends_at: f64,
    /// Whether it is one of the last runs, which end the search where they find nothing better.
    is_last: bool,
}

/// First standard deviation of CMA-ES, and first size of a simplex.
const SIGMA: f64 = 0.25;
const SIMPLEX: f64 = 0.12;
/// Size at which the first simplex ends, before others look elsewhere.
const FIRST_END: f64 = 1e-4;
/// Sizes of the simplices that look elsewhere, from points of the first sample that are apart from each other, at the
/// start and at the end.
const ELSEWHERE: f64 = 0.08;
const ELSEWHERE_END: f64 = 0.02;
const APART: f64 = 0.12;
/// Size of a simplex that starts again at the best point.
const SMALL_SIMPLEX: f64 = 0.03;
/// First standard deviation of a search that refines.
const REFINING_SIGMA: f64 = 0.1;
/// Part of the evaluations that is kept for the grid at most.
const POLISH_PART: usize = 4;

impl Search {
    /// A search that has evaluated nothing.
    pub fn new(settings: SearchSettings) -> Self {
        Self {
            settings,
            archive: Vec::new(),
            best: None,
            least: Score::infeasible(f64::INFINITY),
            step: Step::Start,
            asked: Vec::new(),
            generation: 0,
            runs: 0,
            starts: Vec::new(),
            stopped_by: StoppedBy::Budget,
            spread: None,
        }
    }

    fn n(&self) -> usize {
        self.settings.start.len()
    }

    /// Index, in the order of evaluation, of the best point; among those on the grid if there is one.
    pub fn best(&self) -> Option<usize> {
        self.best
    }

    /// Every evaluated point with its score, in the order of evaluation.
    pub fn archive(&self) -> &[(Vec<f64>, Score)] {
        &self.archive
    }

    /// Batches that were told.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Why it ended; meaningful once [`Search::ask`] has answered `None`.
    pub fn stopped_by(&self) -> StoppedBy {
        self.stopped_by
    }

    /// Spread of the run that the last batch belonged to.
    pub fn spread(&self) -> Option<f64> {
        self.spread
    }

    /// True of a point whose variables are on the grid.
    fn is_on_grid(&self, point: &[f64]) -> bool {
        point.iter().zip(&self.settings.steps).all(|(x, step)| (on_grid(*x, *step) - x).abs() <= 1e-12)
    }

    /// Evaluations that runs may use: the others are for the grid.
    fn limit_of_runs(&self) -> usize {
        let all = self.settings.evaluations;
        all - (4 * self.n() + 1).min(all / POLISH_PART)
    }

    /// Ends the search before its time: what is left is the grid point next to the best point.
    pub fn stop(&mut self) {
        if matches!(self.step, Step::End) {
            return;
        }
        self.stopped_by = StoppedBy::Caller;
        self.spread = None;
        self.step = match self.ranked().first() {
            Some(&best) if !self.is_on_grid(&self.archive[best].0) => {
                Step::Polish(Polish::nearest(&self.archive[best].0, &self.settings.steps))
            }
            _ => Step::End,
        };
    }

    /// The next points; `None` at the end.
    pub fn ask(&mut self) -> Option<Batch> {
        loop {
            let (points, phase, limit) = match &mut self.step {
                Step::Start => (vec![self.settings.start.clone()], Phase::Start, self.settings.evaluations),
                Step::Sample => (self.sample(), Phase::Sample, self.settings.evaluations),
                Step::Evolution(run) => (run.cma_es.ask(), Phase::Run, self.limit_of_runs()),
                Step::Simplex(run) => (run.nelder_mead.ask(), Phase::Run, self.limit_of_runs()),
                Step::Polish(polish) => (polish.ask(), Phase::Polish, self.settings.evaluations),
                Step::End => return None,
            };
            let left = limit.saturating_sub(self.archive.len());
            let (fits, is_empty) = (points.len() <= left, points.is_empty());
            match phase {
                _ if fits && !is_empty => {
                    self.asked.clone_from(&points);
                    return Some(Batch { points, phase, generation: self.generation });
                }
                // A sample may be cut.
                Phase::Sample if left > 0 => {
                    self.asked = points[..left].to_vec();
                    return Some(Batch { points: self.asked.clone(), phase, generation: self.generation });
                }
                Phase::Start | Phase::Polish => self.step = Step::End,
                Phase::Sample | Phase::Run => {
                    self.stopped_by = StoppedBy::Budget;
                    self.begin_polish();
                }
            }
        }
    }

    /// The first sample: 4 n + 8 scrambled Sobol points.
    fn sample(&self) -> Vec<Vec<f64>> {
        let seed = CounterRandom::new(self.settings.seed, &[0]).bits() as u32;
        (0..4 * self.n() as u32 + 8).map(|index| sobol_point(index, self.n(), seed)).collect()
    }

    /// Takes the scores of the points of the last [`Search::ask`].
    pub fn tell(&mut self, scores: &[Score]) {
        let asked = std::mem::take(&mut self.asked);
        if asked.len() != scores.len() || asked.is_empty() {
            return;
        }
        for (point, score) in asked.into_iter().zip(scores) {
            self.archive.push((point, *score));
            if score.is_better_than(&self.least) {
                self.least = *score;
            }
            let index = self.archive.len() - 1;
            let is_candidate = self.is_on_grid(&self.archive[index].0);
            if is_candidate && self.best.is_none_or(|best| score.is_better_than(&self.archive[best].1)) {
                self.best = Some(index);
            }
        }
        self.generation += 1;
        match std::mem::replace(&mut self.step, Step::End) {
            Step::Start if self.settings.refines => self.begin_run(),
            Step::Start => self.step = Step::Sample,
            Step::Sample => self.begin_run(),
            Step::Evolution(run) => self.go_on_with_evolution(run, scores),
            Step::Simplex(run) => self.go_on_with_simplex(run, scores),
            Step::Polish(mut polish) => {
                polish.tell(scores);
                self.step = Step::Polish(polish);
            }
            Step::End => {}
        }
    }

    fn uses_simplex(&self) -> bool {
        match self.settings.method {
            Method::Auto => self.n() <= 3,
            Method::CmaEs => self.n() == 1,
            Method::NelderMead => true,
        }
    }

    fn ranked(&self) -> Vec<usize> {
        ranking(&self.archive.iter().map(|(_, score)| *score).collect::<Vec<_>>())
    }

    fn begin_run(&mut self) {
        let (run, before) = (self.runs, self.least);
        self.runs += 1;
        let order = self.ranked();
        if self.uses_simplex() {
            if run == 0 {
                self.starts = self.starts_apart(&order);
            }
            let end = self.least_spread();
            let start = usize::try_from(run).ok().and_then(|run| self.starts.get(run).copied());
            let has_room = self.archive.len() + 20 * self.n() < self.limit_of_runs();
            let (from, size, ends_at, is_last) = match start {
                Some(start) if run == 0 && !self.settings.refines => (start, SIMPLEX, end.max(FIRST_END), false),
                Some(start) if has_room && !self.settings.refines => (start, ELSEWHERE, end.max(ELSEWHERE_END), false),
                _ => (order[0], SMALL_SIMPLEX, end, true),
            };
            let (point, score) = &self.archive[from];
            let nelder_mead = NelderMead::new(point, *score, size);
            self.step = Step::Simplex(Simplex { nelder_mead, before, ends_at, is_last });
            return;
        }
        let usual = CmaEs::usual_candidates(self.n());
        let (start, candidates) = if run == 0 {
            // The known point where it is among the best quarter.
            let quarter = &order[..order.len().div_ceil(4)];
            let from = if quarter.contains(&0) && self.archive[0].1.is_feasible() { 0 } else { order[0] };
            (self.archive[from].0.clone(), usual)
        } else {
            let mut random = CounterRandom::new(self.settings.seed, &[1, run]);
            ((0..self.n()).map(|_| random.uniform()).collect(), usual << run.min(6))
        };
        let sigma = if self.settings.refines { REFINING_SIGMA } else { SIGMA };
        let cma_es = CmaEs::new(&start, sigma, candidates, self.settings.seed, 2 + run);
        self.step = Step::Evolution(Box::new(Evolution { cma_es, bests: Vec::new(), before }));
    }

    /// The best points of the first sample that are apart from each other: one, and two more for each variable.
    fn starts_apart(&self, order: &[usize]) -> Vec<usize> {
        let mut starts: Vec<usize> = Vec::new();
        for &index in order {
            let is_apart = |other: &usize| {
                let [a, b] = [index, *other].map(|at| &self.archive[at].0);
                a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > APART
            };
            if starts.len() <= 2 * self.n() && starts.iter().all(is_apart) {
                starts.push(index);
            }
        }
        starts
    }

    /// True if a run has improved on what was known before by more than rounding.
    fn has_improved(&self, before: Score) -> bool {
        let now = self.least;
        match (now.is_feasible(), before.is_feasible()) {
            (true, true) => now.objective < before.objective - self.settings.accuracy * self.range_of_objectives(),
            (true, false) => true,
            (false, _) => now.violation < before.violation,
        }
    }

    /// Scale of differences between objectives: distance of the best one from the median of the first sample, at most
    /// the magnitude of the best one.
    fn range_of_objectives(&self) -> f64 {
        let first = &self.archive[..self.archive.len().min(4 * self.n() + 9)];
        let feasible = first.iter().filter(|(_, score)| score.is_feasible()).map(|(_, score)| score.objective);
        let mut objectives: Vec<f64> = feasible.collect();
        objectives.sort_by(f64::total_cmp);
        let best = self.least.objective;
        objectives.get(objectives.len() / 2).map_or(0.0, |median| (median - best).abs().min(best.abs()))
    }

    /// Ends the search where a run, `is_last` of its kind, has found nothing better; else begins the next one.
    fn end_run(&mut self, before: Score, is_last: bool) {
        let is_confirmed = is_last && self.least.is_feasible() && !self.has_improved(before);
        if is_confirmed || self.settings.refines {
            self.stopped_by = StoppedBy::Tolerance;
            self.begin_polish();
        } else {
            self.begin_run();
        }
    }

    fn go_on_with_evolution(&mut self, mut run: Box<Evolution>, scores: &[Score]) {
        run.cma_es.tell(scores);
        let best = scores.iter().filter(|score| score.is_feasible()).map(|score| score.objective).reduce(f64::min);
        run.bests.extend(best);
        self.spread = Some(run.cma_es.spread());
        let n = self.n() as f64;
        let count = 10 + (30.0 * n / run.cma_es.candidates() as f64).ceil() as usize;
        let last = run.bests.len().checked_sub(count).map(|from| &run.bests[from..]);
        let is_flat = last.is_some_and(|last| {
            let (least, most) =
                last.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
            most - least <= self.settings.accuracy * self.range_of_objectives()
        });
        if run.cma_es.spread() < self.least_spread() || is_flat {
            self.end_run(run.before, self.runs > 1);
        } else {
            self.step = Step::Evolution(run);
        }
    }

    /// Spread at which a run ends: half a step where every variable has a grid.
    fn least_spread(&self) -> f64 {
        let finest = self.settings.steps.iter().copied().fold(f64::INFINITY, f64::min);
        if finest > 0.0 && finest.is_finite() {
            self.settings.accuracy.max(0.5 * finest)
        } else {
            self.settings.accuracy
        }
    }

    fn go_on_with_simplex(&mut self, mut run: Simplex, scores: &[Score]) {
        run.nelder_mead.tell(scores);
        self.spread = Some(run.nelder_mead.size());
        let [best, worst] = run.nelder_mead.extremes();
        // Rounding is all that is left where every corner has the same objective.
        let is_level = run.nelder_mead.is_complete() && best.is_feasible() && best.objective == worst.objective;
        if run.nelder_mead.is_complete() && (run.nelder_mead.size() < run.ends_at || is_level) {
            self.end_run(run.before, run.is_last);
        } else {
            self.step = Step::Simplex(run);
        }
    }

    fn begin_polish(&mut self) {
        self.spread = None;
        let Some(&best) = self.ranked().first() else { return };
        self.step = Step::Polish(Polish::new(&self.archive[best].0, &self.settings.steps));
    }
}
