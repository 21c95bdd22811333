//! Measured durations and their statistics.

use std::time::{Duration, Instant};

#[derive(Default)]
pub(crate) struct Times(Vec<Duration>);

impl Times {
    pub(crate) fn add(&mut self, time: Duration) {
        self.0.push(time);
    }

    pub(crate) fn append(&mut self, mut other: Times) {
        self.0.append(&mut other.0);
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Durations of `runs` runs of an operation.
    pub(crate) async fn of<F: Future>(runs: usize, mut something: impl FnMut() -> F) -> Self {
        let mut times = Self::default();
        for _ in 0..runs {
            let began = Instant::now();
            something().await;
            times.add(began.elapsed());
        }
        times
    }

    /// In milliseconds; `part` 0.5 is the median, 1 the longest.
    pub(crate) fn ms(&mut self, part: f64) -> f64 {
        self.0.sort_unstable();
        let last = self.0.len().saturating_sub(1);
        self.0.get((part * last as f64).round() as usize).map_or(f64::NAN, |time| time.as_secs_f64() * 1e3)
    }

    pub(crate) fn mean_ms(&self) -> f64 {
        self.0.iter().sum::<Duration>().as_secs_f64() * 1e3 / self.0.len() as f64
    }

    /// Median and longest.
    pub(crate) fn told(&mut self) -> String {
        format!("{:.2} ms / {:.2} ms", self.ms(0.5), self.ms(1.0))
    }
}
