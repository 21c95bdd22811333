//! Compliance of both members of one helix half: tooth, gear body, local contact.
//!
//! Fidelity `analytic`, per member: the tooth (`tooth`) is a clamped plate of its true profile with free end
//! faces (`plate`); the reactions of its root load a three-dimensional elastic ring with free end faces, held at rim or
//! bore (`ring`, `ring_influence`); short waves at the root come from a plane-strain annulus (`annulus`); the corners
//! of the end faces yield like elastic wedges (`edge`). `bulk` puts these together over Legendre functions of the face;
//! the contact itself is Hertzian (`hertz`). Fidelity `fe` takes the flexibilities of [`crate::fe`] instead, with the
//! indentation of half-spaces (`half_space`).
//!
//! Either way a [`Compliance`] is a table of bulk flexibility (`influence`) and a law of local indentation (`local`).
//!
//! Everything is SI; coordinates are those of [`crate::gear`].

mod annulus;
mod bulk;
mod edge;
mod half_space;
mod hertz;
mod influence;
mod local;
mod member;
mod memory;
mod plate;
mod ring;
mod ring_influence;
mod settings;
mod tooth;

#[cfg(test)]
pub(crate) mod fixtures;
#[cfg(test)]
mod tests;

pub use member::{BodyHold, hold_radius_m};
pub use settings::Settings;

#[cfg(test)]
pub(crate) use hertz::LineContact;
pub(crate) use influence::{Influence, LineWeights, STENCIL, Stencil};
pub(crate) use local::{Indentation, LocalModel, line_contact};
pub(crate) use memory::{compliance_memory, offsets, station_count};
pub(crate) use settings::slices;

use self::influence::stencil;
use self::member::MemberCompliance;
use crate::fe::{FlankFlexibility, FlankFlexibilityInput, Resolution};
use crate::gear::{MemberId, Pair};
use crate::watch::{Canceled, Watch};

/// Corner contact is looked for this far beyond the path, in base pitches: gaps there are beyond any deflection that a
/// tooth survives.
pub(crate) const CORNER_REACH: f64 = 0.5;

/// The compliance of both members of one half. It does not depend on load, modification or assembly: both halves share
/// it, and every load of the same teeth.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliance {
    pub(crate) influence: Influence,
    pub(crate) local: LocalModel,
    slices: usize,
}

/// Points of the table of centreline depths.
const DEPTHS: usize = 33;
/// Stations of the uniform foundation, which has no flexibility between them.
const UNIFORM_STATIONS: usize = 4;
/// Places of the path at which finite-element flexibilities are taken over.
const PATH_NODES: usize = 7;

impl Compliance {
    /// Fidelity `analytic`: beams, plates and rings, in milliseconds unless hundreds of pairs are in mesh.
    ///
    /// # Errors
    /// [`Canceled`].
    pub fn analytic(pair: &Pair, settings: &Settings, watch: Watch) -> Result<Compliance, Canceled> {
        let stations = settings.station_count(pair);
        let offsets = pair_offsets(pair, settings.corner_contact);
        let (pinion, gear) = rayon::join(
            || MemberCompliance::new(pair, 1.0, settings.body, stations, offsets, watch),
            || MemberCompliance::new(pair, -1.0, settings.body, stations, offsets, watch),
        );
        let (pinion, gear) = (pinion?, gear?);
        // Places of both members are Chebyshev nodes of the same path, run through in opposite directions.
        let path_nodes_m = pinion.path_nodes_m().to_vec();
        let last = path_nodes_m.len() - 1;
        let step = pair.spec.face_width_m / stations as f64;
        let stations_m = (0..stations).map(|i| (i as f64 + 0.5) * step).collect();
        let influence = Influence::new(path_nodes_m, stations_m, offsets, (4, watch), |offset, (i, a), (j, b)| {
            pinion.bulk.entry(offset, (i, a), (j, b)) + gear.bulk.entry(offset, (i, last - a), (j, last - b))
        })?;
        let depths = (0..DEPTHS)
            .map(|i| {
                let x = pair.path_start_m + (pair.path_end_m - pair.path_start_m) * i as f64 / (DEPTHS - 1) as f64;
                [pinion.at(x).depth_m, gear.at(pair.line_of_action_m - x).depth_m]
            })
            .collect();
        Ok(Compliance { influence, local: LocalModel::CenterlineDepth(depths), slices: settings.slice_count(pair) })
    }

    /// Fidelity `uniform`: the contact lines as a uniform elastic foundation of so much force per length of line and
    /// approach, both along the flank normal; everything else is rigid. A model with exact solutions, for comparisons.
    pub fn uniform(pair: &Pair, settings: &Settings, line_stiffness_n_per_m2: f64) -> Compliance {
        Self::uniform_between(pair, settings, line_stiffness_n_per_m2, UNIFORM_STATIONS)
    }

    /// The same with `stations` over the face width, at least four, between which the flexibility of what the teeth
    /// stand on is given.
    pub fn uniform_between(
        pair: &Pair,
        settings: &Settings,
        line_stiffness_n_per_m2: f64,
        stations: usize,
    ) -> Compliance {
        let stations = stations.max(UNIFORM_STATIONS);
        let step = pair.spec.face_width_m / stations as f64;
        let stations_m = (0..stations).map(|i| (i as f64 + 0.5) * step).collect();
        let influence = Influence::rigid(pair.pitch_point_m(), stations_m);
        let local = LocalModel::Foundation { line_stiffness_n_per_m2 };
        Compliance { influence, local, slices: settings.slice_count(pair) }
    }

    /// Inputs of the finite elements whose flexibilities [`Compliance::finite_elements`] takes: pinion and gear.
    pub fn finite_element_inputs(
        pair: &Pair,
        settings: &Settings,
        resolution: Resolution,
    ) -> [FlankFlexibilityInput; 2] {
        let offsets = pair_offsets(pair, settings.corner_contact);
        [(MemberId::Pinion, &pair.pinion), (MemberId::Gear, &pair.gear)].map(|(side, member)| {
            let hold_m = hold_radius_m(member, settings.body, pair.spec.normal_module_m);
            FlankFlexibilityInput::new(pair, side, hold_m, offsets, resolution)
        })
    }

    /// Fidelity `fe`: from the finite elements of pinion and gear.
    ///
    /// A force on the line of contact goes to the hats of the load grid about it and the displacement there is read
    /// between them; a hat is represented by its centre of gravity.
    ///
    /// # Errors
    /// [`Canceled`].
    pub fn finite_elements(
        pair: &Pair,
        settings: &Settings,
        flanks: [&FlankFlexibility; 2],
        watch: Watch,
    ) -> Result<Compliance, Canceled> {
        let path_nodes_m: Vec<f64> = (0..PATH_NODES)
            .map(|i| {
                let angle = std::f64::consts::PI * (2 * i + 1) as f64 / (2 * PATH_NODES) as f64;
                let (low, high) = (pair.path_start_m, pair.path_end_m);
                0.5 * (low + high) - 0.5 * (high - low) * angle.cos()
            })
            .collect();
        let rolls = [path_nodes_m.clone(), path_nodes_m.iter().map(|x| pair.line_of_action_m - x).collect::<Vec<_>>()];
        let members = [&pair.pinion, &pair.gear];
        // Places of either member between the hats along its profile.
        let profiles: [Vec<_>; 2] = std::array::from_fn(|side| {
            let flank = flanks[side];
            let centers = hat_centers(flank.profile_m());
            let form = flank.rolls_m()[0];
            let base = members[side].base_radius_m;
            rolls[side].iter().map(|roll| stencil(&centers, (roll * roll - form * form) / (2.0 * base))).collect()
        });
        let common_m = pair.spec.face_width_m;
        let stations_of = |side: usize| hat_centers(flanks[side].stations_m());
        // The narrower member's stations are those of both; the other's flexibility is read between its own.
        let bearing = usize::from(members[0].face_width_m > common_m && members[1].face_width_m <= common_m);
        let stations_m = stations_of(bearing);
        let across: [Option<Vec<Stencil>>; 2] = std::array::from_fn(|side| {
            let margin_m = 0.5 * (members[side].face_width_m - common_m);
            let own = stations_of(side);
            (own != stations_m).then(|| stations_m.iter().map(|z| stencil(&own, z + margin_m)).collect())
        });
        let offsets = flanks[0].offsets().min(flanks[1].offsets());
        // Four by four hats of either member, of which each may stand between four stations.
        let operations = if across.iter().any(Option::is_some) { 512 } else { 32 };
        let influence =
            Influence::new(path_nodes_m, stations_m, offsets, (operations, watch), |offset, (i, a), (j, b)| {
                (0..2)
                    .map(|side| {
                        let nodes = flanks[side].nodes();
                        let Some(bulk) = flanks[side].bulk(offset) else { return 0.0 };
                        let (pa, pb) = (&profiles[side][a], &profiles[side][b]);
                        let stations = flanks[side].stations_m().len();
                        if let Some(across) = &across[side] {
                            return between(bulk, (stations, nodes), [pa, pb], [&across[i], &across[j]]);
                        }
                        let mut sum = 0.0;
                        for (k, wa) in pa.weights.iter().enumerate() {
                            let row = &bulk[((pa.first + k) * stations + i) * nodes..];
                            for (l, wb) in pb.weights.iter().enumerate() {
                                sum += wa * wb * row[(pb.first + l) * stations + j];
                            }
                        }
                        sum
                    })
                    .sum()
            })?;
        Ok(Compliance { influence, local: LocalModel::HalfSpace, slices: settings.slice_count(pair) })
    }

    /// Number of width slices that the contact lines are cut into.
    pub fn slices(&self) -> usize {
        self.slices
    }
}

/// A table of finite elements between two places read between its nodes along the profile and along the face.
fn between(bulk: &[f64], (stations, nodes): (usize, usize), profile: [&Stencil; 2], face: [&Stencil; 2]) -> f64 {
    let places = |side: usize| {
        let (along, across) = (profile[side], face[side]);
        along.weights.iter().enumerate().flat_map(move |(k, w)| {
            let row = (along.first + k) * stations + across.first;
            across.weights.iter().enumerate().map(move |(l, v)| (row + l, w * v))
        })
    };
    places(0).map(|(at, w)| w * places(1).map(|(load, v)| v * bulk[at * nodes + load]).sum::<f64>()).sum()
}

/// Centres of gravity of the hats on `nodes`.
fn hat_centers(nodes: &[f64]) -> Vec<f64> {
    let last = nodes.len() - 1;
    (0..=last).map(|i| (nodes[i.saturating_sub(1)] + nodes[i] + nodes[(i + 1).min(last)]) / 3.0).collect()
}

/// Tooth pairs that can be in contact at once lie up to this many pitches apart: points lie within the path and, with
/// corner contact, half a base pitch beyond either end.
fn pair_offsets(pair: &Pair, corner_contact: bool) -> usize {
    offsets(pair.total_contact_ratio(), corner_contact)
}
