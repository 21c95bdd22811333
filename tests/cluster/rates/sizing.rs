//! How far a service reaches: a calculation from what was measured.

/// What was measured, each in seconds unless it says otherwise.
#[derive(Debug, Default)]
pub(super) struct Sizing {
    /// Time of a point on a thread.
    pub point_s: f64,
    /// Between two chunks of a worker.
    pub gap_s: f64,
    /// Processor time of the service for a row of a sweep.
    pub row_s: f64,
    /// Of one and of three NATS servers: whole jobs in a second; processor time for one of all NATS servers, and of the
    /// service.
    pub chunks: Vec<Chunks>,
}

#[derive(Debug)]
pub(super) struct Chunks {
    pub servers: usize,
    pub nats_s: f64,
    pub service_s: f64,
}

/// Computing time of a chunk that is aimed at, and most points of one.
const CHUNK_S: f64 = 2.0;
const MOST_POINTS: f64 = 5000.0;

impl Sizing {
    /// Prints the table of docs/SCALING.md: points in a second by threads on workers, and where their growth ends.
    ///
    /// A chunk has n = 2 s / t_p points, and there is a gap between two of a thread, which so makes n / (n t_p + gap)
    /// points in a second. One processor of the service passes on 1 / (chunk + n row) chunks in a second, one of NATS
    /// 1 / chunk. A whole job stands for a chunk: it costs the service more than a part of a sweep.
    pub(super) fn print(&self) {
        println!("measured inputs: {self:?}");
        if self.row_s == 0.0 {
            return;
        }
        println!(
            "| time of a point | NATS servers | 10 threads | 100 threads | 1000 threads | threads at the limit | of |"
        );
        println!("|---|---|---|---|---|---|---|");
        for point_s in [2e-3, 15e-3, 150e-3, 2.0] {
            for Chunks { servers, nats_s, service_s, .. } in &self.chunks {
                let n = (CHUNK_S / point_s).clamp(1.0, MOST_POINTS);
                let rate = n / (n * point_s + self.gap_s);
                let (by_service, by_nats) = (n / (service_s + n * self.row_s), n / nats_s);
                let limit = by_service.min(by_nats);
                let points = |threads: f64| (threads * rate).min(limit);
                println!(
                    "| {:.0} ms | {servers} | {:.1}/s | {:.0}/s | {:.0}/s | {:.0} | {} |",
                    1e3 * point_s,
                    points(10.0),
                    points(100.0),
                    points(1000.0),
                    limit / rate,
                    if by_service < by_nats { "service" } else { "NATS" }
                );
            }
        }
    }
}
