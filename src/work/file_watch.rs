//! Watch over the database file, which may be moved or deleted while nothing is written.

use super::jobs::Jobs;
use std::time::Duration;

/// Pause between two checks.
const PAUSE: Duration = Duration::from_secs(2);

/// Checks the database file every two seconds until the jobs are closed. The store logs when it is lost, and when it is
/// found again.
pub async fn run_file_watch(jobs: Jobs) {
    loop {
        tokio::select! {
            () = tokio::time::sleep(PAUSE) => {}
            () = jobs.closing().cancelled() => return,
        }
        let _ = jobs.store().check_file();
    }
}
