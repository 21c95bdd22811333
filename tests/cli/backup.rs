//! `herringbone backup` where no copy can be made.

use super::*;
use std::fs;

fn refused(database: &Path, target: &Path) -> String {
    refused_with(&[], database, target)
}

fn refused_with(options: &[&str], database: &Path, target: &Path) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_herringbone"))
        .arg("backup")
        .args(options)
        .arg("--database")
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

/// The files beside the database, whatever they are called and whether they exist or not.
#[test]
fn the_files_of_the_database_are_never_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    fs::write(&database, "a letter").expect("written");
    std::os::unix::fs::symlink(folder.path(), folder.path().join("same")).expect("a link");
    let (hard, symbolic) = (folder.path().join("hard"), folder.path().join("symbolic"));
    for suffix in ["-wal", "-shm", "-journal", ".lock"] {
        let name = format!("jobs.db{suffix}");
        let own = folder.path().join(&name);
        for target in [&own, &folder.path().join("same").join(&name)] {
            assert!(refused_with(&["--force"], &database, target).contains("belongs to the database"), "{name}");
            assert!(!own.exists());
        }
        fs::write(&own, "precious").expect("written");
        fs::hard_link(&own, &hard).expect("a link");
        std::os::unix::fs::symlink(&own, &symbolic).expect("a link");
        for target in [&own, &hard, &symbolic] {
            assert!(refused_with(&["--force"], &database, target).contains("belongs to the database"), "{name}");
            assert_eq!(fs::read(&own).expect("readable"), b"precious");
        }
        for path in [&own, &hard, &symbolic] {
            fs::remove_file(path).expect("removed");
        }
    }
    let link = folder.path().join("link.db");
    std::os::unix::fs::symlink(&database, &link).expect("a link");
    assert!(refused_with(&["--force"], &link, &database).contains("is the database itself"));
    assert!(refused_with(&["--force"], &link, &folder.path().join("jobs.db-wal")).contains("belongs to the database"));
}

#[test]
fn unfinished_copies_of_killed_processes_are_removed() {
    let folder = tempfile::tempdir().expect("a folder");
    let (database, target) = (folder.path().join("letter"), folder.path().join("copy.db"));
    fs::write(&database, "a letter").expect("written");
    let names = [
        "copy.db.partial-4000001",
        "copy.db.partial-4000001-journal",
        "copy.db.partial-x",
        "copy.db.partial-",
        "other.db.partial-4000001",
    ];
    for name in names {
        fs::write(folder.path().join(name), "part").expect("written");
    }
    refused(&database, &target);
    let left = names.map(|name| folder.path().join(name).exists());
    assert_eq!(left, [false, false, true, true, true]);
}
