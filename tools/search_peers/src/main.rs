//! Evaluations that our CMA-ES and that of the crate `cmaes` need on a rotated ellipsoid of condition 1e6 until it is
//! below 1e-8, and the time that our search takes for an evaluation that costs nothing.

use cmaes::{CMAESOptions, DVector};
use herringbone_search::{CmaEs, CounterRandom, Method, Score, Search, SearchSettings};
use std::time::Instant;

const GOAL: f64 = 1e-8;
const SEEDS: u64 = 15;
const START: f64 = 0.3;
const SIGMA: f64 = 0.25;

/// An ellipsoid about 0.6 with axes in random directions (Gram and Schmidt).
struct Ellipsoid {
    directions: Vec<Vec<f64>>,
}

impl Ellipsoid {
    fn new(n: usize) -> Self {
        let mut random = CounterRandom::new(7, &[n as u64]);
        let mut directions: Vec<Vec<f64>> = Vec::new();
        while directions.len() < n {
            let mut one: Vec<f64> = (0..n).map(|_| random.normal()).collect();
            for other in &directions {
                let along: f64 = one.iter().zip(other).map(|(a, b)| a * b).sum();
                one.iter_mut().zip(other).for_each(|(a, b)| *a -= along * b);
            }
            let length = one.iter().map(|part| part * part).sum::<f64>().sqrt();
            directions.push(one.into_iter().map(|part| part / length).collect());
        }
        Self { directions }
    }

    fn value(&self, x: &[f64]) -> f64 {
        let last = (self.directions.len() - 1) as f64;
        let along = |direction: &Vec<f64>| direction.iter().zip(x).map(|(d, x)| d * (x - 0.6)).sum::<f64>();
        self.directions.iter().map(along).enumerate().map(|(i, y)| 1e6f64.powf(i as f64 / last) * y * y).sum()
    }
}

/// Evaluations of our CMA-ES.
fn own(function: &Ellipsoid, n: usize, seed: u64) -> usize {
    let mut cma_es = CmaEs::new(&vec![START; n], SIGMA, CmaEs::usual_candidates(n), seed, 0);
    for generation in 1.. {
        let scores: Vec<_> = cma_es.ask().iter().map(|x| Score::feasible(function.value(x))).collect();
        if scores.iter().any(|score| score.objective < GOAL) || generation > 100_000 {
            return generation * scores.len();
        }
        cma_es.tell(&scores);
    }
    0
}

/// Evaluations of the crate's, with the same number of candidates, start and spread.
fn of_crate(function: &Ellipsoid, n: usize, seed: u64) -> usize {
    let objective = |x: &DVector<f64>| function.value(x.as_slice());
    let mut state = CMAESOptions::new(vec![START; n], SIGMA)
        .population_size(CmaEs::usual_candidates(n))
        .fun_target(GOAL)
        .seed(seed)
        .build(objective)
        .expect("valid options");
    let _ = state.run();
    state.function_evals()
}

fn median(mut values: Vec<usize>) -> usize {
    values.sort_unstable();
    values[values.len() / 2]
}

/// Microseconds of the search for each of `evaluations` that cost nothing.
fn overhead_us(n: usize, evaluations: usize) -> f64 {
    let mut search = Search::new(SearchSettings {
        start: vec![0.5; n],
        steps: vec![0.0; n],
        seed: 1,
        evaluations,
        accuracy: 1e-12,
        method: Method::Auto,
        refines: false,
    });
    let started = Instant::now();
    while let Some(batch) = search.ask() {
        let score = |x: &Vec<f64>| Score::feasible(x.iter().map(|x| (x - 0.4).abs()).sum());
        let scores: Vec<_> = batch.points.iter().map(score).collect();
        search.tell(&scores);
    }
    1e6 * started.elapsed().as_secs_f64() / search.archive().len() as f64
}

fn main() {
    println!("Ellipsoid, condition 1e6, rotated, to {GOAL:e}: median evaluations of {SEEDS} seeds");
    println!("{:>4} {:>10} {:>10} {:>6}", "n", "own", "cmaes", "ratio");
    for n in [2, 3, 5, 8, 12] {
        let function = Ellipsoid::new(n);
        let all = |run: &dyn Fn(u64) -> usize| median((0..SEEDS).map(run).collect());
        let (own, other) = (all(&|seed| own(&function, n, seed)), all(&|seed| of_crate(&function, n, seed)));
        println!("{n:>4} {own:>10} {other:>10} {:>6.2}", own as f64 / other as f64);
    }
    for (n, evaluations) in [(3, 750), (6, 1200), (12, 2100), (12, 20_000), (12, 100_000)] {
        let time_us = overhead_us(n, evaluations);
        println!("search itself, n = {n}, {evaluations} evaluations at most: {time_us:.1} us each");
    }
}
