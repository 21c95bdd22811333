//! Metrics of work on other machines.

use super::shared::Shared;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Pause between two readings.
const PAUSE: Duration = Duration::from_secs(5);

/// Publishes numbers of chunks, workers and messages every few seconds.
pub(super) async fn run_measures(shared: Arc<Shared>) {
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
            metrics::gauge!("herringbone_workers", "version" => version.clone()).set(count as f64);
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
