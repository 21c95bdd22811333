//! Settings of workers, threads and the queue.

use crate::store::WorkClass;
use std::num::NonZeroUsize;
use std::time::Duration;

/// Number of workers and threads, bounds of the queue and of jobs.
#[derive(Debug, Clone, clap::Args)]
pub struct WorkConfig {
    /// Jobs of one operating point that run at the same time; the number of processors when not given.
    #[arg(long, env = "HERRINGBONE_WORKERS", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub workers: Option<u32>,

    /// Sweeps that run at the same time, beside the jobs of one operating point; the others take turns with them.
    #[arg(long, env = "HERRINGBONE_SWEEP_WORKERS", value_name = "N", default_value_t = 2,
          value_parser = clap::value_parser!(u32).range(1..=64))]
    pub sweep_workers: u32,

    /// How long a sweep runs before it makes way for another that waits; it goes on later where it was.
    #[arg(long, env = "HERRINGBONE_SWEEP_TURN_S", value_name = "SECONDS", default_value_t = 60,
          value_parser = clap::value_parser!(u32).range(0..=86_400))]
    pub sweep_turn_s: u32,

    /// Longest time that a job of one operating point may compute; it fails then.
    #[arg(long, env = "HERRINGBONE_JOB_TIME_LIMIT_S", value_name = "SECONDS", default_value_t = 3600,
          value_parser = clap::value_parser!(u32).range(1..=2_592_000))]
    pub job_time_limit_s: u32,

    /// Longest time that a sweep may compute in all its turns; it fails then, and goes on when it is submitted again.
    #[arg(long, env = "HERRINGBONE_SWEEP_TIME_LIMIT_S", value_name = "SECONDS", default_value_t = 604_800,
          value_parser = clap::value_parser!(u32).range(1..=31_536_000))]
    pub sweep_time_limit_s: u32,

    /// Memory that one job may take by the estimate made when it is submitted; a larger one is refused.
    #[arg(long, env = "HERRINGBONE_JOB_MEMORY_MIB", value_name = "MIB", default_value_t = 4096,
          value_parser = clap::value_parser!(u32).range(64..=16_777_216))]
    pub job_memory_mib: u32,

    /// Threads that all running jobs of one operating point share, and threads of each sweep; the number of processors
    /// when not given.
    #[arg(long, env = "HERRINGBONE_THREADS", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// Jobs that may wait; further ones are answered with 503.
    #[arg(long, env = "HERRINGBONE_QUEUE_CAPACITY", value_name = "N", default_value_t = 10_000,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub queue_capacity: u32,

    /// A job is given up when its process has died so often while it ran; shutdowns do not count.
    #[arg(long, env = "HERRINGBONE_MAX_LOSSES", value_name = "N", default_value_t = 3,
          value_parser = clap::value_parser!(u32).range(1..=100))]
    pub max_losses: u32,

    /// How long a shutdown waits for running jobs to stop; they run again after the restart.
    #[arg(long, env = "HERRINGBONE_DRAIN_S", value_name = "SECONDS", default_value_t = 10,
          value_parser = clap::value_parser!(u32).range(0..=3600))]
    pub drain_s: u32,
}

impl Default for WorkConfig {
    fn default() -> Self {
        Self {
            workers: None,
            threads: None,
            sweep_workers: 2,
            sweep_turn_s: 60,
            job_time_limit_s: 3600,
            sweep_time_limit_s: 604_800,
            job_memory_mib: 4096,
            queue_capacity: 10_000,
            max_losses: 3,
            drain_s: 10,
        }
    }
}

impl WorkConfig {
    /// Workers for jobs of one operating point.
    pub fn worker_count(&self) -> usize {
        self.workers.map_or_else(processors, |workers| workers as usize)
    }

    /// Threads of each pool.
    pub fn thread_count(&self) -> usize {
        self.threads.map_or_else(processors, |threads| threads as usize)
    }

    /// Longest computing time of a job of this class.
    pub fn time_limit(&self, class: WorkClass) -> Duration {
        Duration::from_secs(match class {
            WorkClass::Single => self.job_time_limit_s.into(),
            WorkClass::Sweep => self.sweep_time_limit_s.into(),
        })
    }

    /// Longest wait for running jobs at a shutdown.
    pub fn drain(&self) -> Duration {
        Duration::from_secs(self.drain_s.into())
    }
}

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}
