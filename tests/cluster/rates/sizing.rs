//! How far a service reaches: a calculation from what was measured.

/// What was measured, each in seconds unless it says otherwise.
#[derive(Debug, Default)]
pub(super) struct Sizing {
    /// Time of a point on a thread.
    pub point_s: f64,
    /// Between two chunks of a worker.
    pub gap_s: f64,
    /// Rows that the service stores in a second, and its processor time for one.
    pub rows_per_s: f64,
    pub row_s: f64,
    /// Processor time of NATS for a chunk of a sweep.
    pub nats_chunk_s: Vec<f64>,
    /// Number of NATS servers, chunks in a second, processor time of all servers for one.
    pub chunks_per_s: Vec<(usize, f64, f64)>,
}

/// Computing time of a chunk that is aimed at.
const CHUNK_S: f64 = 2.0;

impl Sizing {
    /// Prints the table of docs/SCALING.md: points per second of N threads on workers, and what ends their growth.
    ///
    /// A thread makes 1 / (t_p + gap · t_p / 2 s) points in a second: chunks take two seconds, and there is a gap
    /// between two of them. The service stores at most so many rows in a second, and NATS passes on so many chunks.
    pub(super) fn print(&self) {
        println!("measured inputs: {self:?}");
        if self.rows_per_s == 0.0 || self.chunks_per_s.is_empty() {
            return;
        }
        println!(
            "| time of a point | servers | 10 threads | 100 threads | 1000 threads | threads that the service feeds | by |"
        );
        println!("|---|---|---|---|---|---|---|");
        for point_s in [2e-3, 15e-3, 150e-3, 2.0] {
            for (servers, chunks_per_s, _) in &self.chunks_per_s {
                let rate = 1.0 / (point_s * (1.0 + self.gap_s / CHUNK_S.max(point_s)));
                let of_chunk = (CHUNK_S / point_s).clamp(1.0, 5000.0);
                let (by_rows, by_chunks) = (self.rows_per_s, chunks_per_s * of_chunk);
                let limit = by_rows.min(by_chunks);
                let points = |threads: f64| (threads * rate).min(limit);
                println!(
                    "| {:.0} ms | {servers} | {:.0}/s | {:.0}/s | {:.0}/s | {:.0} | {} |",
                    1e3 * point_s,
                    points(10.0),
                    points(100.0),
                    points(1000.0),
                    limit / rate,
                    if by_rows < by_chunks { "rows" } else { "chunks" }
                );
            }
        }
    }
}
