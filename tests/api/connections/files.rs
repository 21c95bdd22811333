//! The real program, when files run out.

use crate::support::Program;
use std::net::TcpStream;
use std::time::Duration;

#[test]
fn running_out_of_files_ends_nothing() {
    let directory = tempfile::tempdir().expect("temporary directory");
    let database = directory.path().join("jobs.db");
    let database = database.to_str().expect("UTF-8");
    let program = Program::start_with_files(96, &["--listen", "127.0.0.1:0", "--database", database]);
    let address = program.address();
    let idle: Vec<_> =
        (0..200).filter_map(|_| TcpStream::connect_timeout(&address, Duration::from_secs(20)).ok()).collect();
    assert_eq!(idle.len(), 200);
    assert_eq!(program.get("/api/v1/system").0, 200, "the longest waiting made room");
    let log = program.end();
    assert!(log.contains("connections cannot be accepted"), "{log}");
    let reports = log.matches("cannot be accepted").count();
    assert!(reports < 50, "reported now and then, not each time: {reports}");
}
