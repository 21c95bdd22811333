//! Computing time of the current thread.

use std::time::{Duration, Instant};

/// A running measurement. On Linux it is the processor time of the thread, which other programs on the machine do not
/// lengthen; elsewhere the time that passed. Belongs to the thread that started it.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch {
    start: Instant,
    processor: Option<Duration>,
}

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        Self { processor: processor_time(), start: Instant::now() }
    }

    /// Time since the start, s.
    pub fn seconds(&self) -> f64 {
        let passed = self.start.elapsed();
        match (self.processor, processor_time()) {
            (Some(before), Some(now)) => now.saturating_sub(before).as_secs_f64(),
            _ => passed.as_secs_f64(),
        }
    }
}

/// Processor time of the thread so far; the kernel updates the count when the thread yields.
fn processor_time() -> Option<Duration> {
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

/// The value of a repeated calculation and the median of its times, s, over `runs` runs; with 0 runs the time of the
/// first. What takes less than a fifth of a millisecond is repeated within a run.
pub fn median_time<T>(runs: usize, mut run: impl FnMut() -> T) -> (T, f64) {
    let watch = Stopwatch::start();
    let mut value = run();
    let first = watch.seconds();
    if runs == 0 {
        return (value, first);
    }
    let repeats = (2e-4 / first.max(1e-7)).ceil().clamp(1.0, 1e4) as usize;
    let times: Vec<f64> = (0..runs)
        .map(|_| {
            let watch = Stopwatch::start();
            for _ in 0..repeats {
                value = std::hint::black_box(run());
            }
            watch.seconds() / repeats as f64
        })
        .collect();
    (value, crate::statistics::median(times))
}
