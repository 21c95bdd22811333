//! `herringbone backup` where no copy can be made.

use super::*;
use std::fs;

fn refused(database: &Path, target: &Path) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_herringbone"))
        .args(["backup", "--database"])
        .args([database, target])
        .output()
        .expect("the binary runs");
    let text = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{text}");
    assert!(text.starts_with("herringbone backup: ") && text.lines().count() == 1, "{text}");
    text
}

#[test]
fn a_backup_of_nothing_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let (missing, letter, target) =
        (folder.path().join("none.db"), folder.path().join("letter"), folder.path().join("copy.db"));
    fs::write(&letter, "a letter that is no database\n".repeat(100)).expect("written");
    assert!(refused(&missing, &target).contains("there is no database"));
    assert!(refused(&letter, &target).contains("file is not a database"));
    assert!(refused(&letter, &letter).contains("is the database itself"));
    assert!(refused(&letter, &folder.path().join("none/copy.db")).contains("No such file or directory"));
    let mut left: Vec<_> =
        fs::read_dir(folder.path()).expect("a folder").map(|entry| entry.expect("entry").file_name()).collect();
    left.sort();
    assert_eq!(left, ["letter"]);
}

#[test]
fn a_target_is_overwritten_only_when_asked_and_never_while_it_is_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let (database, target) = (folder.path().join("letter"), folder.path().join("copy.db"));
    fs::write(&database, "a letter").expect("written");
    fs::write(&target, "precious").expect("written");
    assert!(refused(&database, &target).contains("--force"));
    fs::write(folder.path().join("copy.db-wal"), "").expect("written");
    assert!(refused(&database, &target).contains("in use"));
    assert_eq!(fs::read(&target).expect("readable"), b"precious");
}
