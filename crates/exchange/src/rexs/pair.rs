//! The chosen pair: its stages with the components of each member.

use super::model::{Handle, Model};
use super::position::{FacePlace, face};
use super::stages::{Stage, flanks_of};
use super::view::View;
use crate::draft::Reading;
use crate::unit::Quantity;

/// Names of the members in the document.
pub(super) const MEMBERS: [&str; 2] = ["pinion", "gear"];

/// The pair that a document is made of.
#[derive(Debug)]
pub(super) struct Pair<'a, 'm> {
    pub view: &'a View<'m>,
    /// Left half first; one stage where it is mirrored.
    pub halves: Vec<Stage>,
    pub mirrored: bool,
}

impl<'m> Pair<'_, 'm> {
    pub(super) fn model(&self) -> &'m Model {
        self.view.model
    }

    /// The gears of a member, one for each half.
    pub(super) fn gears(&self, member: usize) -> Vec<Handle> {
        self.halves.iter().map(|half| if member == 0 { half.pinion } else { half.wheel }).collect()
    }

    /// The shaft of a member.
    pub(super) fn shaft(&self, member: usize) -> Handle {
        match member {
            0 => self.halves[0].pinion_shaft,
            _ => self.halves[0].wheel_shaft,
        }
    }

    pub(super) fn teeth(&self, member: usize) -> f64 {
        self.halves[0].teeth[member].into()
    }

    pub(super) fn all_gears(&self) -> Vec<Handle> {
        [0, 1].into_iter().flat_map(|member| self.gears(member)).collect()
    }

    /// The stages.
    pub(super) fn stages(&self) -> Vec<Handle> {
        self.halves.iter().map(|half| half.stage).collect()
    }

    /// The faces of a member on its shaft, one for each half.
    pub(super) fn faces(&self, member: usize) -> Vec<Option<FacePlace>> {
        self.gears(member).into_iter().map(|gear| face(self.view, gear, self.shaft(member))).collect()
    }

    /// Both flanks of a gear.
    pub(super) fn flanks(&self, gear: Handle) -> Vec<Handle> {
        flanks_of(self.model(), gear).into_iter().map(|(_, flank)| flank).collect()
    }

    /// Readings of an attribute of several components.
    pub(super) fn numbers(&self, of: &[Handle], id: &'static str, quantity: Quantity) -> Vec<Reading> {
        of.iter().filter_map(|handle| self.view.number(*handle, id, quantity)).collect()
    }

    /// Data of a gear in its stage.
    pub(super) fn stage_data(&self, half: usize, member: usize) -> Option<Handle> {
        let gear = self.gears(member)[half];
        self.model()
            .relations_of(gear)
            .filter(|relation| relation.kind == "stage_gear_data")
            .filter(|relation| relation.role("stage") == Some(self.halves[half].stage))
            .find_map(|relation| relation.role("stage_gear_data"))
    }

    /// Why an attribute of one of several components is not there.
    pub(super) fn missing(&self, of: &[Handle], id: &str) -> String {
        let reason = of.iter().find_map(|handle| {
            let reason = self.view.reason(*handle, id)?;
            Some(format!("{}.{id} {reason}", self.model().label(*handle)))
        });
        reason.unwrap_or_else(|| {
            let names: Vec<_> = of.iter().map(|handle| self.model().label(*handle)).collect();
            format!("{id} is missing on {}", names.join(", "))
        })
    }
}

/// Mean of readings.
pub(super) fn mean(readings: &[Reading]) -> f64 {
    readings.iter().map(|reading| reading.value).sum::<f64>() / readings.len().max(1) as f64
}

/// Largest difference of readings.
pub(super) fn spread(readings: &[Reading]) -> f64 {
    let values = || readings.iter().map(|reading| reading.value);
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    if readings.is_empty() { 0.0 } else { most - least }
}

/// Value with component and attribute of each reading, for messages.
pub(super) fn listed(readings: &[Reading]) -> String {
    let one = |reading: &Reading| format!("{} {} {}", reading.from(), reading.file_value, reading.file_unit);
    readings.iter().map(|reading| one(reading).trim_end().to_owned()).collect::<Vec<_>>().join(", ")
}
