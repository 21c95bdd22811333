//! The files that an operator installs.

use super::*;
use std::fs;

fn deployed(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("deploy").join(name)).expect("readable")
}

/// The value of a setting of the unit, in seconds.
fn seconds(unit: &str, name: &str) -> u32 {
    let value = unit.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('=')).expect(name);
    value.parse().expect("seconds")
}

#[test]
fn a_stop_outlasts_the_drain() {
    let help = herringbone(&["serve", "--help"]);
    let help = String::from_utf8(help.stdout).expect("UTF-8");
    let line = help.lines().find(|line| line.contains("--drain-s")).expect("--drain-s");
    let drain: u32 =
        line.rsplit("[default: ").next().and_then(|rest| rest.trim_end_matches(']').parse().ok()).expect("a default");
    // What connections are given after the drain.
    let connections = 5;
    assert!(seconds(&deployed("herringbone.service"), "TimeoutStopSec") > drain + connections);
    let compose = deployed("compose.yaml");
    let grace =
        compose.lines().find_map(|line| line.trim().strip_prefix("stop_grace_period: ")).expect("a grace period");
    assert!(grace.trim_end_matches('s').parse::<u32>().expect("seconds") > drain + connections);
}

/// The unit is checked by systemd, if installed.
#[test]
fn systemd_accepts_the_unit() {
    let folder = tempfile::tempdir().expect("a folder");
    let unit = folder.path().join("herringbone.service");
    // The binary is not installed here.
    let text = deployed("herringbone.service");
    assert!(text.contains("ExecStart=/usr/local/bin/herringbone serve"));
    fs::write(&unit, text.replace("/usr/local/bin/herringbone serve", "/bin/true")).expect("written");
    match Command::new("systemd-analyze").arg("verify").arg(&unit).output() {
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success() && said.is_empty(), "{said}");
        }
        Err(error) => eprintln!("not checked: systemd-analyze: {error}"),
    }
}
