//! Metrics of work on other machines.

use super::shared::Shared;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Pause between two readings.
const PAUSE: Duration = Duration::from_secs(5);

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
    // Counters exist from the start: an alert on their growth needs a first value.
    for name in ["herringbone_reissued_total", "herringbone_nats_reconnects_total"] {
        metrics::counter!(name).absolute(0);
    }
}

/// Publishes numbers of chunks, workers and messages every few seconds.
pub(super) async fn run_measures(shared: Arc<Shared>) {
    describe();
    let mut versions = BTreeSet::new();
    while shared.pause(PAUSE).await {
        if let Ok([waiting, issued]) = shared.store().open_chunk_counts().await {
            metrics::gauge!("herringbone_chunks", "state" => "waiting").set(waiting as f64);
            metrics::gauge!("herringbone_chunks", "state" => "issued").set(issued as f64);
        }
        let members = shared.state().members.list(Instant::now());
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
            }
        }
    }
}
