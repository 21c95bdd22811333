//! The gear train: how shafts turn with the pinion's.

use super::model::{Handle, Model};
use super::pair::Pair;
use super::position::axis_sign;
use super::view::View;
use crate::unit::Quantity;
use std::collections::{HashMap, VecDeque};

/// How a shaft turns with the pinion's.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Link {
    /// Speed of the pinion over the speed of this shaft, with its sign.
    pub ratio: f64,
    /// Whether the sign is known: that of bevel gears is not.
    pub sign_known: bool,
    /// Whether it is reached through the mesh of the pair.
    pub beyond_mesh: bool,
    /// Stages and couplings between.
    pub steps: usize,
    /// What lies between, for people.
    pub way: Vec<String>,
}

/// Shafts that turn with the pinion's.
#[derive(Debug)]
pub(super) struct Train {
    links: HashMap<Handle, Link>,
}

impl Train {
    /// Follows stages and connections from the pinion's shaft.
    pub(super) fn of(pair: &Pair) -> Train {
        let view = pair.view;
        let model = view.model;
        let own = pair.stages();
        let start = pair.shaft(0);
        let first = Link { ratio: 1.0, sign_known: true, beyond_mesh: false, steps: 0, way: Vec::new() };
        let mut links = HashMap::from([(start, first)]);
        let mut queue = VecDeque::from([start]);
        let stages = stages_by_shaft(model);
        while let Some(shaft) = queue.pop_front() {
            let link = links[&shaft].clone();
            let mut reach = |next: Handle, ratio: f64, sign_known: bool, mesh: bool, by: Handle| {
                if ratio.is_finite() && ratio != 0.0 && !links.contains_key(&next) {
                    let mut way = link.way.clone();
                    way.push(model.name(by));
                    links.insert(
                        next,
                        Link {
                            ratio: link.ratio * ratio,
                            sign_known: link.sign_known && sign_known,
                            beyond_mesh: link.beyond_mesh || mesh,
                            steps: link.steps + 1,
                            way,
                        },
                    );
                    queue.push_back(next);
                }
            };
            for (connection, beyond) in model.connections(shaft) {
                // What is fitted on the shaft is tied to its own shaft.
                if model.kind(beyond) == "shaft" {
                    reach(beyond, axis_sign(view, shaft, beyond), true, false, connection);
                }
            }
            for mesh in stages.get(&shaft).into_iter().flatten() {
                let teeth = |gear: Handle| {
                    view.number(gear, "number_of_teeth", Quantity::Number).map(|teeth| teeth.value.abs())
                };
                let (Some(near), Some(far)) = (teeth(mesh.near), teeth(mesh.far)) else { continue };
                // Speed of this shaft over that of the next.
                let ratio = match mesh.parallel {
                    true => -far / near * axis_sign(view, shaft, mesh.shaft),
                    false => far / near,
                };
                reach(mesh.shaft, ratio, mesh.parallel, own.contains(&mesh.stage), mesh.stage);
            }
        }
        Train { links }
    }

    pub(super) fn link(&self, shaft: Handle) -> Option<&Link> {
        self.links.get(&shaft)
    }

    /// Shafts, nearest first.
    pub(super) fn shafts(&self) -> Vec<Handle> {
        let mut shafts: Vec<_> = self.links.keys().copied().collect();
        shafts.sort_by_key(|shaft| (self.links[shaft].steps, *shaft));
        shafts
    }
}

/// A mesh of a gear on one shaft with one on another.
struct Mesh {
    stage: Handle,
    near: Handle,
    far: Handle,
    shaft: Handle,
    /// Whether the axes are parallel, so that the sense of rotation is known.
    parallel: bool,
}

fn stages_by_shaft(model: &Model) -> HashMap<Handle, Vec<Mesh>> {
    let mut by_shaft: HashMap<Handle, Vec<Mesh>> = HashMap::new();
    for (kind, gears, parallel) in
        [("cylindrical_stage", "cylindrical_gear", true), ("bevel_stage", "bevel_gear", false)]
    {
        for stage in model.of_kind(kind) {
            let gear = |role| model.related("stage", stage, "stage", role).first().copied();
            let (Some(one), Some(other)) = (gear("gear_1"), gear("gear_2")) else { continue };
            if [one, other].iter().any(|gear| model.kind(*gear) != gears) {
                continue;
            }
            let (Some(first), Some(second)) = (model.shaft_of(one), model.shaft_of(other)) else { continue };
            if first == second {
                continue;
            }
            by_shaft.entry(first).or_default().push(Mesh { stage, near: one, far: other, shaft: second, parallel });
            by_shaft.entry(second).or_default().push(Mesh { stage, near: other, far: one, shaft: first, parallel });
        }
    }
    by_shaft
}

/// External loads of a shaft.
pub(super) fn loads_of(view: &View, shaft: Handle) -> Vec<Handle> {
    view.model.parts(shaft).into_iter().filter(|part| view.model.kind(*part) == "external_load").collect()
}
