//! Metrics of work on other machines.

use super::names::{RESULT_CONSUMER, consumer};
use super::shared::Shared;
use async_nats::jetstream::consumer::PullConsumer;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Pause between two readings.
const PAUSE: Duration = Duration::from_secs(5);
/// Time without a result that is taken, while the stream holds some, after which results count as stalled.
const STALLED_AFTER: Duration = Duration::from_secs(60);

/// Whether results wait in their stream and none is taken.
#[derive(Debug, Default)]
struct Stall {
    taken: u64,
    since: Option<Instant>,
}

impl Stall {
    /// A reading: messages in the stream, and the results taken so far. Whether none has been taken for too long.
    fn read(&mut self, now: Instant, messages: u64, taken: u64) -> bool {
        if messages == 0 || taken != self.taken {
            (self.taken, self.since) = (taken, None);
            return false;
        }
        now.saturating_duration_since(*self.since.get_or_insert(now)) >= STALLED_AFTER
    }
}

/// Tells what the metrics mean.
fn describe() {
    metrics::describe_gauge!(
        "herringbone_chunks",
        "Chunks that are not stored, by state: waiting to be published, issued."
    );
    metrics::describe_histogram!(
        "herringbone_chunk_seconds",
        "Computing time of a chunk (work), and the rest of the time from its publication to its end (wait)."
    );
    metrics::describe_counter!(
        "herringbone_results_dropped_total",
        "Results of workers that were not stored, by reason."
    );
    metrics::describe_counter!("herringbone_reissued_total", "Chunks that were published again.");
    metrics::describe_gauge!(
        "herringbone_machines",
        "Workers that were heard of lately, by version of the calculation."
    );
    metrics::describe_counter!("herringbone_nats_reconnects_total", "Connections to NATS that were made again.");
    metrics::describe_histogram!("herringbone_nats_publish_seconds", "Time until NATS acknowledged a chunk.");
    metrics::describe_gauge!("herringbone_nats_stream_messages", "Messages in the streams of work and of results.");
    metrics::describe_gauge!("herringbone_nats_stream_bytes", "Bytes in the streams of work and of results.");
    metrics::describe_gauge!(
        "herringbone_nats_consumer_pending",
        "Messages that a consumer has not delivered yet, by consumer."
    );
    metrics::describe_gauge!(
        "herringbone_nats_consumer_ack_pending",
        "Messages that a consumer has delivered and nobody has acknowledged, by consumer."
    );
    metrics::describe_gauge!(
        "herringbone_results_stalled",
        "1 while results wait in their stream and none was taken for a minute."
    );
    metrics::gauge!("herringbone_results_stalled").set(0.0);
    // Counters exist from the start: an alert on their growth needs a first value.
    for name in ["herringbone_reissued_total", "herringbone_nats_reconnects_total"] {
        metrics::counter!(name).absolute(0);
    }
}

/// Publishes numbers of chunks, workers and messages every few seconds.
pub(super) async fn run_measures(shared: Arc<Shared>) {
    describe();
    let mut versions = BTreeSet::new();
    let (mut stall, mut was_stalled) = (Stall::default(), false);
    while shared.pause(PAUSE).await {
        if let Ok([waiting, issued]) = shared.store().open_chunk_counts().await {
            metrics::gauge!("herringbone_chunks", "state" => "waiting").set(waiting as f64);
            metrics::gauge!("herringbone_chunks", "state" => "issued").set(issued as f64);
        }
        let mut members = shared.state().members.list(Instant::now());
        members.retain(|member| !member.is_lost);
        versions.extend(members.iter().map(|member| member.solver_version.clone()));
        for version in &versions {
            let count = members.iter().filter(|member| member.solver_version == *version).count();
            metrics::gauge!("herringbone_machines", "version" => version.clone()).set(count as f64);
        }
        if !shared.nats.is_up() {
            continue;
        }
        for (name, stream) in [("work", shared.space.work_stream()), ("result", shared.space.result_stream())] {
            if let Ok(stream) = shared.nats.jetstream.get_stream(stream).await {
                let state = &stream.cached_info().state;
                metrics::gauge!("herringbone_nats_stream_messages", "stream" => name).set(state.messages as f64);
                metrics::gauge!("herringbone_nats_stream_bytes", "stream" => name).set(state.bytes as f64);
                if name == "result" {
                    let taken = shared.state().results_taken;
                    let is_stalled = stall.read(Instant::now(), state.messages, taken);
                    metrics::gauge!("herringbone_results_stalled").set(f64::from(u8::from(is_stalled)));
                    if is_stalled && !was_stalled {
                        tracing::error!(
                            messages = state.messages,
                            "results wait in NATS and none was taken for a minute; a consumer without a quorum needs a restart of the NATS servers"
                        );
                    }
                    was_stalled = is_stalled;
                }
            }
        }
        let work: Vec<_> = shared.consumers().iter().map(|(solver, class)| consumer(solver, *class)).collect();
        let consumers = work.into_iter().map(|name| (name, shared.space.work_stream()));
        for (name, stream) in consumers.chain([(RESULT_CONSUMER.to_owned(), shared.space.result_stream())]) {
            let found: Result<PullConsumer, _> =
                shared.nats.jetstream.get_consumer_from_stream(name.clone(), stream).await;
            let Ok(found) = found else { continue };
            let info = found.cached_info();
            metrics::gauge!("herringbone_nats_consumer_pending", "consumer" => name.clone())
                .set(info.num_pending as f64);
            metrics::gauge!("herringbone_nats_consumer_ack_pending", "consumer" => name)
                .set(info.num_ack_pending as f64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_stalled_after_a_minute_without_one() {
        let (start, mut stall) = (Instant::now(), Stall::default());
        let mut at = |seconds, messages, taken| stall.read(start + Duration::from_secs(seconds), messages, taken);
        assert!(!at(0, 0, 0) && !at(300, 4, 0) && !at(355, 4, 0), "they have only just come");
        assert!(at(360, 4, 0) && at(400, 9, 0));
        assert!(!at(405, 8, 1), "one was taken");
        assert!(!at(406, 8, 1) && !at(465, 8, 1) && at(466, 8, 1));
        assert!(!at(500, 0, 1), "none waits");
    }
}
