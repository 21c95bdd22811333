//! Deviations of single halves and deviations in company: their rules, and tolerances of which each half has its own.

use super::{DistributionInput, HalvesScatterInput, JobDocument, MAX_TOLERANCES, ToleranceInput};
use crate::field::Input;
use crate::reader::ObjectPlace;

/// Blocks of modifications of which each half can have its own, the parts of their pointers before it.
const OF_HALVES: [&str; 4] = ["/design/pinion/coast", "/design/gear/coast", "/design/pinion", "/design/gear"];
const HALVES: [&str; 2] = ["left", "right"];

/// The pointers of both halves of a modification; `None` of an input that the halves have in common.
fn pointers_of_halves(document: &mut JobDocument, pointer: &str) -> Option<[String; 2]> {
    let (block, rest) = OF_HALVES.iter().find_map(|block| Some((*block, pointer.strip_prefix(block)?)))?;
    if HALVES.iter().any(|half| rest.starts_with(&format!("/{half}/"))) {
        return None;
    }
    let design = &mut document.design;
    let gear = if block.starts_with("/design/pinion") { &mut design.pinion } else { &mut design.gear };
    let flank = if block.ends_with("coast") { &mut gear.coast.as_mut()?.flank } else { &mut gear.flank };
    flank.slot(rest).filter(crate::field::Slot::is_number)?;
    Some(HALVES.map(|half| format!("{block}/{half}{rest}")))
}

/// Gives both halves of a block modifications of their own, with the values that they have in common.
fn give_own(document: &mut JobDocument, pointer: &str) {
    let design = &mut document.design;
    let gear = if pointer.starts_with("/design/pinion") { &mut design.pinion } else { &mut design.gear };
    let is_coast = pointer.starts_with("/design/pinion/coast") || pointer.starts_with("/design/gear/coast");
    let (flank, halves) = match gear.coast.as_mut().filter(|_| is_coast) {
        Some(coast) => (&coast.flank, [&mut coast.left, &mut coast.right]),
        None => (&gear.flank, [&mut gear.left, &mut gear.right]),
    };
    for half in halves {
        half.get_or_insert_with(|| flank.clone());
    }
}

/// Replaces tolerances with independent halves by one for the left half, in their place, and one for the right half
/// after all others, so that the places of the document stay.
pub(super) fn separate(document: &mut JobDocument, place: &ObjectPlace) {
    let given = document.tolerances.len();
    for index in 0..given {
        let tolerance = document.tolerances[index].clone();
        if tolerance.halves != Some(HalvesScatterInput::Independent) {
            document.tolerances[index].halves = None;
            continue;
        }
        let at = |name: &str| format!("tolerances/{index}/{name}");
        let mut names = vec![at("pointer")];
        names.extend((0..tolerance.also.len()).map(|other| at(&format!("also/{other}"))));
        let all: Vec<String> = std::iter::once(&tolerance.pointer).chain(&tolerance.also).cloned().collect();
        let found: Vec<Option<[String; 2]>> = all.iter().map(|pointer| pointers_of_halves(document, pointer)).collect();
        for ((name, pointer), of_halves) in names.iter().zip(&all).zip(&found) {
            if of_halves.is_none() && !place.is_refused(name) {
                let detail = format!(
                    "\"{pointer}\" is no modification of which each half can have its own, such as \
                     /design/pinion/helix_slope_um; halves independent needs one"
                );
                place.conflict(name, detail);
            }
        }
        let Some(found) = found.into_iter().collect::<Option<Vec<[String; 2]>>>() else { continue };
        if document.tolerances.len() >= MAX_TOLERANCES {
            let detail = format!("makes two tolerances; permitted: at most {MAX_TOLERANCES} together");
            place.conflict(&at("halves"), detail);
            continue;
        }
        all.iter().for_each(|pointer| give_own(document, pointer));
        let of_half = |half: usize| ToleranceInput {
            pointer: found[0][half].clone(),
            also: found[1..].iter().map(|pointers| pointers[half].clone()).collect(),
            halves: None,
            ..tolerance.clone()
        };
        document.tolerances[index] = of_half(0);
        document.tolerances.push(of_half(1));
        for correlation in &mut document.correlations {
            if let Some(at) = correlation.pointers.iter().position(|pointer| *pointer == tolerance.pointer) {
                correlation.pointers[at].clone_from(&found[0][0]);
                correlation.pointers.insert(at + 1, found[0][1].clone());
            }
        }
    }
}

/// The rules of deviations in company, before tolerances are separated by halves.
pub(super) fn correlation_rules(document: &JobDocument, place: &ObjectPlace) {
    let mut taken: Vec<&str> = Vec::new();
    for (index, correlation) in document.correlations.iter().enumerate() {
        let mut count = 0;
        for (item, pointer) in correlation.pointers.iter().enumerate() {
            let at = format!("correlations/{index}/pointers/{item}");
            let tolerance = document.tolerances.iter().find(|tolerance| tolerance.pointer == *pointer);
            match tolerance {
                _ if place.is_refused(&at) => {}
                None => place.conflict(&at, format!("\"{pointer}\" is the pointer of none of tolerances")),
                Some(_) if taken.contains(&pointer.as_str()) => {
                    place.conflict(&at, format!("\"{pointer}\" is named already"));
                }
                Some(tolerance) if tolerance.distribution == DistributionInput::FixedValues => {
                    place.conflict(&at, format!("\"{pointer}\" has fixed values, which have no order to go by"));
                }
                Some(tolerance) => {
                    count += if tolerance.halves == Some(HalvesScatterInput::Independent) { 2 } else { 1 };
                }
            }
            taken.push(pointer);
        }
        let name = |name: &str| format!("correlations/{index}/{name}");
        if place.is_refused(&name("pointers")) || place.is_refused(&name("correlation")) {
            continue;
        }
        if count < 2 {
            place.conflict(&name("pointers"), "needs two inputs, or one with independent halves");
            continue;
        }
        let least = -1.0 / (f64::from(count) - 1.0);
        if !(least..=1.0).contains(&correlation.correlation) {
            let detail = format!(
                "is {}; {count} inputs can have at least {least:.4} each with each other",
                correlation.correlation
            );
            place.outside(&name("correlation"), "", [least, 1.0], detail);
        }
    }
}
