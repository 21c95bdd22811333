//! A database that cannot be used: one sentence, exit code 1, and the file as it was.

use super::*;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;

/// Serving must not start; what is said on standard error.
fn refusal(command: &mut Command, database: &Path) -> String {
    let output = command
        .args(["serve", "--listen", "127.0.0.1:0", "--log", "error", "--database"])
        .arg(database)
        .output()
        .expect("the binary runs");
    let text = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.starts_with("herringbone serve: ") && text.contains(&*database.to_string_lossy()), "{text}");
    text
}

fn binary() -> Command {
    Command::new(env!("CARGO_BIN_EXE_herringbone"))
}

/// The binary under a user who may not write everywhere, as root may.
fn as_somebody(directory: &Path) -> Command {
    let mut command = binary();
    if fs::metadata(directory).is_ok_and(|metadata| std::os::unix::fs::MetadataExt::uid(&metadata) == 0) {
        // The program itself lies where others may not look, perhaps: run a copy.
        let copy = directory.join("herringbone");
        // Copied by a process of its own: a file that this process has open for writing may be inherited by what other
        // tests start meanwhile, and such a program cannot be run.
        let copied = Command::new("cp").args([Path::new(env!("CARGO_BIN_EXE_herringbone")), &copy]).status();
        assert!(copied.expect("cp runs").success());
        command = Command::new(copy);
        command.uid(65_534).gid(65_534);
    }
    command
}

fn permit(path: &Path, mode: u32) {
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("permissions set");
}

#[test]
fn what_is_no_database_is_said_and_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("jobs.db");
    fs::write(&file, "a letter\n").expect("written");
    assert!(refusal(&mut binary(), &file).contains("is not an SQLite database"));
    assert_eq!(fs::read_to_string(&file).expect("readable"), "a letter\n");
    assert!(refusal(&mut binary(), folder.path()).contains("is not a file"));
    assert!(refusal(&mut binary(), &folder.path().join("none/jobs.db")).contains("does not exist"));
}

#[test]
fn what_may_not_be_written_is_said_and_left_alone() {
    let programs = tempfile::tempdir().expect("a folder");
    permit(programs.path(), 0o755);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("jobs.db");
    let output = herringbone(&["backup", "--database", "/no/such.db", "/dev/null"]);
    assert_eq!(output.status.code(), Some(1));
    // A directory in which nothing can be made.
    permit(folder.path(), 0o555);
    assert!(refusal(&mut as_somebody(programs.path()), &file).contains("cannot be written"));
    // A directory that can be written, and in it a file that cannot.
    permit(folder.path(), 0o777);
    fs::write(&file, "content").expect("written");
    permit(&file, 0o444);
    assert!(refusal(&mut as_somebody(programs.path()), &file).contains("cannot be written"));
    assert_eq!(fs::read(&file).expect("readable"), b"content");
}
