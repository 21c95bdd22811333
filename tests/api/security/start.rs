//! The real program: how it starts, and how it does not.

use super::TOKEN;
use crate::support::Program;
use std::os::unix::fs::PermissionsExt;
use tempfile::TempDir;

const LOCAL: &str = "127.0.0.1:0";
const EVERYWHERE: &str = "0.0.0.0:0";

/// A folder with a token file, and room for a database.
fn folder(token: &str, mode: u32) -> (TempDir, String, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let (file, database) = (path("token"), path("jobs.db"));
    std::fs::write(&file, token).expect("written");
    std::fs::set_permissions(&file, std::fs::Permissions::from_mode(mode)).expect("permitted");
    (folder, file, database)
}

#[test]
fn nothing_listens_to_other_machines_without_a_token_or_a_word() {
    let (folder, _, database) = folder("", 0o600);
    let arguments = ["--listen", EVERYWHERE, "--database", &database];
    for output in [
        Program::refused(&arguments, &[]),
        // As the container does.
        Program::refused(&arguments[2..], &[("HERRINGBONE_LISTEN", EVERYWHERE)]),
    ] {
        let said = String::from_utf8_lossy(&output.stderr);
        for hint in ["--token-file", "HERRINGBONE_TOKEN_FILE", "--insecure"] {
            assert!(said.contains(hint), "{said}");
        }
        assert!(output.stdout.is_empty());
    }
    assert!(!folder.path().join("jobs.db").exists(), "refused before anything is done");
}

#[test]
fn told_to_be_open_it_is_and_says_so() {
    let (_folder, _, database) = folder("", 0o600);
    let program = Program::start(&["--listen", EVERYWHERE, "--insecure", "--database", &database]);
    assert_eq!(program.get("/api/v1/jobs").0, 200);
    let log = program.end();
    assert!(log.contains("WARN") && log.contains("nothing asks for credentials"), "{log}");
}

#[test]
fn a_token_lets_it_listen_and_is_asked_for_and_never_logged() {
    let (_folder, file, database) = folder(&format!("{TOKEN}\n"), 0o600);
    let arguments = ["--listen", EVERYWHERE, "--token-file", &file, "--database", &database, "--log", "trace"];
    let program = Program::start(&arguments);
    assert_eq!(program.get("/healthz").0, 200);
    assert_eq!(program.get("/api/v1/jobs").0, 401);
    let header = format!("authorization: Bearer {TOKEN}\r\ncookie: herringbone_session=0123456789\r\n");
    assert_eq!(program.get_with("/api/v1/jobs", &header).0, 200);
    assert_eq!(program.get_with("/api/v1/jobs", "authorization: Bearer wrong-wrong-wrong-wrong\r\n").0, 401);
    let log = program.end();
    assert!(log.contains("status=401") && !log.contains("every user"), "{log}");
    for secret in [TOKEN, "wrong-wrong", "0123456789"] {
        assert!(!log.contains(secret), "{secret} in {log}");
    }
}

#[test]
fn a_token_that_everybody_can_read_is_warned_about() {
    let (_folder, file, database) = folder(TOKEN, 0o644);
    let program = Program::start(&["--listen", LOCAL, "--token-file", &file, "--database", &database]);
    assert_eq!(program.get("/api/v1/jobs").0, 401, "asked for on this machine too");
    let log = program.end();
    assert!(log.contains("every user of this machine can read the token file"), "{log}");
}

#[test]
fn an_unusable_token_stops_the_start_and_is_not_shown() {
    for (token, what) in
        [("", "is empty"), ("short-token", "too short"), ("sixteen-and more-characters", "not one word")]
    {
        let (_folder, file, database) = folder(token, 0o600);
        let output =
            Program::refused(&["--listen", LOCAL, "--database", &database], &[("HERRINGBONE_TOKEN_FILE", &file)]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(what) && said.contains(&file), "{said}");
        assert!(token.is_empty() || !said.contains(token), "{said}");
    }
    let (_folder, _, database) = folder("", 0o600);
    let output = Program::refused(&["--token-file", "/no/such/file", "--database", &database], &[]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot be read"), "{output:?}");
}

#[test]
fn a_host_that_is_no_name_stops_the_start() {
    let output = Program::refused(&["--allowed-host", "http://gears.example/"], &[]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("without a port"), "{output:?}");
}
