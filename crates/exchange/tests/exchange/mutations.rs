//! Mutated files end in a report or a refusal with reasons, never in a panic.

use super::gearbox::Gearbox;
use super::*;
use proptest::prelude::*;

/// A file as text, to be mutated.
fn originals() -> Vec<String> {
    let text = |name: &str| String::from_utf8(data(name)).expect("UTF-8");
    vec![
        Gearbox::double_helical("1.7").with_shafts().xml(),
        Gearbox::double_helical("1.0").with_shafts().json(),
        text("FVA-Industriegetriebe_2stufig_1-4.rexs"),
        text("FVA-Industriegetriebe_2stufig_1-4.rexsj"),
        text("herringbone_pair_1_7.rexs"),
    ]
}

/// What is done to a file; places are parts of its length.
#[derive(Debug, Clone)]
enum Mutation {
    Truncate(f64),
    /// The unit after a place becomes another one.
    Unit(f64, &'static str),
    /// A number after a place becomes another one.
    Number(f64, &'static str),
    /// An id after a place becomes that of another place.
    Id(f64, f64),
    /// A line moves elsewhere.
    Move(f64, f64),
    /// A line is left out.
    Drop(f64),
    /// A line stands twice.
    Double(f64),
    /// A name of an attribute, type or role becomes that of another place.
    Name(f64, f64),
    Byte(f64, u8),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let place = || 0.0..1.0f64;
    const UNITS: [&str; 14] =
        ["inch", "", "none", "deg", "°", "rad", "mm", "m", "mum", "N m", "1 / min", "kW", "MPa", "%"];
    const NUMBERS: [&str; 13] =
        ["0", "-1", "1e308", "-1e-308", "NaN", "1,5", "", "1e23", "0.5", "17", "100000", "-0", "inf"];
    prop_oneof![
        1 => place().prop_map(Mutation::Truncate),
        4 => (place(), proptest::sample::select(&UNITS[..])).prop_map(|(at, unit)| Mutation::Unit(at, unit)),
        6 => (place(), proptest::sample::select(&NUMBERS[..])).prop_map(|(at, number)| Mutation::Number(at, number)),
        3 => (place(), place()).prop_map(|(at, from)| Mutation::Id(at, from)),
        2 => (place(), place()).prop_map(|(from, to)| Mutation::Move(from, to)),
        3 => place().prop_map(Mutation::Drop),
        2 => place().prop_map(Mutation::Double),
        2 => (place(), place()).prop_map(|(at, from)| Mutation::Name(at, from)),
        1 => (place(), any::<u8>()).prop_map(|(at, byte)| Mutation::Byte(at, byte)),
    ]
}

/// Byte ranges of the values of these members or attributes.
fn values(text: &str, names: &[&str]) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    for name in names {
        for (start, matched) in text.match_indices(name) {
            let start = start + matched.len();
            let rest = &text[start..];
            let end = rest.find(['"', '<', ',', '\n', '}']).unwrap_or(rest.len());
            found.push(start..start + end);
        }
    }
    found
}

fn pick(ranges: &[std::ops::Range<usize>], at: f64) -> Option<std::ops::Range<usize>> {
    ranges.get((at * ranges.len() as f64) as usize).cloned()
}

fn mutate(text: &mut String, mutation: &Mutation) {
    const IDS: [&str; 2] = [" id=\"", "\"id\":"];
    const NUMBERS: [&str; 4] = ["unit=\"mm\">", "unit=\"none\">", "\"floating_point\":", "\"]>"];
    let lines = |text: &str| text.split_inclusive('\n').map(str::to_owned).collect::<Vec<_>>();
    let line = |lines: &[String], at: f64| ((at * lines.len() as f64) as usize).min(lines.len().saturating_sub(1));
    match mutation {
        Mutation::Truncate(at) => {
            let mut end = (at * text.len() as f64) as usize;
            while !text.is_char_boundary(end) {
                end -= 1;
            }
            text.truncate(end);
        }
        Mutation::Unit(at, unit) => {
            if let Some(range) = pick(&values(text, &["unit=\"", "\"unit\":\"", "\"unit\": \""]), *at) {
                text.replace_range(range, unit);
            }
        }
        Mutation::Number(at, number) => {
            if let Some(range) = pick(&values(text, &NUMBERS), *at) {
                text.replace_range(range, number);
            }
        }
        Mutation::Id(at, from) => {
            let ids = values(text, &IDS);
            if let (Some(range), Some(other)) = (pick(&ids, *at), pick(&ids, *from)) {
                let other = text[other].to_owned();
                text.replace_range(range, &other);
            }
        }
        Mutation::Name(at, from) => {
            let names = values(text, &[" type=\"", " role=\"", "<attribute id=\"", "\"type\":\"", "\"role\":\""]);
            if let (Some(range), Some(other)) = (pick(&names, *at), pick(&names, *from)) {
                let other = text[other].to_owned();
                text.replace_range(range, &other);
            }
        }
        Mutation::Move(from, to) => {
            let mut all = lines(text);
            let (from, to) = (line(&all, *from), line(&all, *to));
            if !all.is_empty() {
                let moved = all.remove(from);
                all.insert(to.min(all.len()), moved);
            }
            *text = all.concat();
        }
        Mutation::Drop(at) => {
            let mut all = lines(text);
            if all.len() > 1 {
                all.remove(line(&all, *at));
            }
            *text = all.concat();
        }
        Mutation::Double(at) => {
            let mut all = lines(text);
            if !all.is_empty() {
                let index = line(&all, *at);
                all.insert(index, all[index].clone());
            }
            *text = all.concat();
        }
        Mutation::Byte(at, byte) => {
            let mut bytes = std::mem::take(text).into_bytes();
            let place = (at * bytes.len() as f64) as usize;
            if let Some(target) = bytes.get_mut(place) {
                *target = *byte;
            }
            *text = String::from_utf8_lossy(&bytes).into_owned();
        }
    }
}

/// Either a document that can be read, with every line of its report true, or reasons.
fn answered(bytes: &[u8], options: &ImportOptions) -> Result<bool, TestCaseError> {
    match import(bytes, options) {
        Ok(import) => {
            let document = herringbone_job::parse_value(&import.document);
            prop_assert!(document.is_ok(), "{:?}", document);
            for line in &import.taken {
                prop_assert_eq!(import.document.pointer(&line.pointer), Some(&line.value), "{:?}", line);
            }
            prop_assert!(!import.operating_points.is_empty());
            Ok(true)
        }
        Err(refusal) => {
            prop_assert!(!refusal.errors.is_empty() && !refusal.summary.is_empty());
            prop_assert!(
                refusal.errors.iter().all(|error| !error.detail.is_empty() && error.detail.len() < 4000),
                "{:?}",
                refusal
            );
            Ok(false)
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn a_mutated_file_is_answered(
        which in 0..5usize,
        mutations in proptest::collection::vec(mutation(), 1..6),
        pair in proptest::option::of(1..4u64),
        mirror in any::<bool>(),
    ) {
        let mut text = originals().swap_remove(which);
        mutations.iter().for_each(|mutation| mutate(&mut text, mutation));
        let mirror = mirror || text.contains("FVA") || text.contains("Bearinx");
        answered(text.as_bytes(), &ImportOptions { pair, mirror, ..ImportOptions::default() })?;
    }
}

/// Of single mutations most leave a document: the reader is not one that refuses everything.
#[test]
fn most_single_mutations_leave_a_document() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::{Config, RngSeed, TestRunner};
    let mut runner = TestRunner::new(Config { rng_seed: RngSeed::Fixed(7), ..Config::default() });
    let (mut taken, mut refused) = (0, 0);
    for _ in 0..200 {
        let mutation = mutation().new_tree(&mut runner).expect("generated").current();
        let mut text = originals().swap_remove(0);
        mutate(&mut text, &mutation);
        match answered(text.as_bytes(), &ImportOptions { mirror: true, ..ImportOptions::default() }).expect("answered")
        {
            true => taken += 1,
            false => refused += 1,
        }
    }
    assert!(taken > 80 && refused > 20, "{taken} documents, {refused} refusals");
}
