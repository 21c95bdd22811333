//! Time that this thread spent computing.

use std::time::{Duration, Instant};

/// A running measurement. On Linux it is the processor time of the thread, which other programs on the machine do not lengthen
/// by taking turns; elsewhere the time that passed.
pub struct Stopwatch {
    begin: Instant,
    spent: Option<Duration>,
}

impl Stopwatch {
    pub fn start() -> Stopwatch {
        Stopwatch { spent: spent(), begin: Instant::now() }
    }

    pub fn seconds(&self) -> f64 {
        let passed = self.begin.elapsed();
        match (self.spent, spent()) {
            (Some(before), Some(now)) => now.saturating_sub(before).as_secs_f64(),
            _ => passed.as_secs_f64(),
        }
    }
}

/// Processor time of the thread; the kernel brings its count up to date when the thread offers its turn.
fn spent() -> Option<Duration> {
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

/// What `run` gives, and the median of its times over `runs` runs, s. What takes less than a fifth of a millisecond is repeated within a run.
pub fn median<T>(runs: usize, mut run: impl FnMut() -> T) -> (T, f64) {
    let watch = Stopwatch::start();
    let mut answer = run();
    let first = watch.seconds();
    let repeats = (2e-4 / first.max(1e-7)).ceil().clamp(1.0, 1e4) as usize;
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let watch = Stopwatch::start();
            for _ in 0..repeats {
                answer = std::hint::black_box(run());
            }
            watch.seconds() / repeats as f64
        })
        .collect();
    if runs == 0 {
        times.push(first);
    }
    times.sort_by(f64::total_cmp);
    (answer, times[times.len() / 2])
}
