//! Tests of the documented settings.

use super::Arguments;
use clap::CommandFactory;

#[cfg(feature = "cluster")]
use {clap::Arg, std::collections::BTreeMap};

#[cfg(feature = "cluster")]
const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/OPERATIONS.md");

/// The cells of each table row that begins with a flag, by flag.
#[cfg(feature = "cluster")]
fn documented() -> BTreeMap<String, Vec<String>> {
    let text = std::fs::read_to_string(DOCUMENT).expect("docs/OPERATIONS.md");
    let mut rows = BTreeMap::new();
    for line in text.lines().filter(|line| line.starts_with("| `--")) {
        let mut cells = line.trim_matches('|').split(" | ").map(|cell| cell.trim().to_owned());
        let flag = cells.next().expect("a flag");
        assert!(rows.insert(flag.clone(), cells.collect()).is_none(), "{flag} has two rows");
    }
    rows
}

/// Flag, variable and default of an argument as in a table row.
#[cfg(feature = "cluster")]
fn row(argument: &Arg) -> (String, [String; 2]) {
    let flag = format!("`--{}`", argument.get_long().expect("a long flag"));
    let variable = argument.get_env().map(|name| format!("`{}`", name.to_string_lossy())).unwrap_or_default();
    let default: Vec<_> = match argument.get_action().takes_values() {
        true => argument.get_default_values().iter().map(|value| format!("`{}`", value.to_string_lossy())).collect(),
        false => Vec::new(),
    };
    (flag, [variable, default.join(", ")])
}

#[cfg(feature = "cluster")]
#[test]
fn the_documented_settings_are_those_of_the_program() {
    let mut documented = documented();
    let mut wrong = Vec::new();
    let command = Arguments::command();
    let serve = command.find_subcommand("serve").expect("serve");
    for argument in serve.get_arguments().filter(|argument| argument.get_id() != "help") {
        let (flag, [variable, default]) = row(argument);
        assert!(!variable.is_empty(), "{flag} has no variable");
        let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
        match documented.remove(&flag) {
            None => wrong.push(format!("missing: | {flag} | {variable} | {default} | {help} |")),
            Some(cells) if cells[..2] != [variable.clone(), default.clone()] => {
                wrong.push(format!("{flag} is not {cells:?} but: | {flag} | {variable} | {default} |"));
            }
            Some(cells) => assert!(cells.get(2).is_some_and(|help| !help.is_empty()), "{flag} is not explained"),
        }
    }
    wrong.extend(documented.keys().map(|flag| format!("there is no {flag}")));
    assert!(wrong.is_empty(), "docs/OPERATIONS.md, Settings:\n{}", wrong.join("\n"));
}

/// The files for deployment use only settings that exist.
#[test]
fn the_deployment_files_use_variables_that_exist() {
    let command = Arguments::command();
    let known_to = |names: &[&str]| -> Vec<&str> {
        let found = names.iter().filter_map(|name| command.find_subcommand(name));
        found.flat_map(|one| one.get_arguments()).filter_map(|argument| argument.get_env()?.to_str()).collect()
    };
    let files: [(&str, &[&str]); _] = [
        ("deploy/herringbone.service", &["serve"]),
        ("deploy/compose.yaml", &["serve"]),
        ("docs/OPERATIONS.md", &["serve"]),
        #[cfg(feature = "cluster")]
        ("deploy/cluster/compose.yaml", &["serve", "worker"]),
        #[cfg(feature = "cluster")]
        ("deploy/cluster/herringbone-worker.service", &["worker"]),
    ];
    for (file, programs) in files {
        let known = known_to(programs);
        let path = format!("{}/{file}", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).expect("readable");
        let words = text.split(|character: char| !(character.is_ascii_uppercase() || character == '_'));
        let mut count = 0;
        for word in words.filter(|word| word.starts_with("HERRINGBONE_")) {
            assert!(known.contains(&word), "{file}: {word} is no setting");
            count += 1;
        }
        assert!(count > 2, "{file} names no setting");
    }
}
