//! Recordable channels: names, quantities, and their evaluation from solver coordinates.

use serde::{Deserialize, Serialize};

use crate::dynamics::{
    DynamicModel, LinearOutput, MAX_ORDER, ModalTrain, PER_HALF, Segment, TrainEquations, U, W, YG, YP, ZG, ZP,
    row_product,
};

/// Physical quantity of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChannelQuantity {
    /// m.
    Displacement,
    /// m/s.
    Velocity,
    /// m/s².
    Acceleration,
    /// rad.
    Rotation,
    /// rad/s.
    AngularVelocity,
    /// rad/s².
    AngularAcceleration,
    /// N.
    Force,
    /// N m.
    Moment,
}

impl ChannelQuantity {
    /// Unit of the channel's values.
    pub fn unit(self) -> &'static str {
        match self {
            ChannelQuantity::Displacement => "m",
            ChannelQuantity::Velocity => "m/s",
            ChannelQuantity::Acceleration => "m/s2",
            ChannelQuantity::Rotation => "rad",
            ChannelQuantity::AngularVelocity => "rad/s",
            ChannelQuantity::AngularAcceleration => "rad/s2",
            ChannelQuantity::Force => "N",
            ChannelQuantity::Moment => "N m",
        }
    }

    /// The quantity of a unit.
    fn of_unit(unit: &str) -> Self {
        let all = [
            ChannelQuantity::Displacement,
            ChannelQuantity::Velocity,
            ChannelQuantity::Acceleration,
            ChannelQuantity::Rotation,
            ChannelQuantity::AngularVelocity,
            ChannelQuantity::AngularAcceleration,
            ChannelQuantity::Moment,
        ];
        all.into_iter().find(|quantity| quantity.unit() == unit).unwrap_or(ChannelQuantity::Force)
    }
}

/// Uniformly sampled time series.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    /// Name of the channel, see [`ChannelId`].
    pub name: String,
    /// Physical quantity.
    pub quantity: ChannelQuantity,
    /// Unit of the values.
    pub unit: String,
    /// Time of the first value from the start of the integration, s (0 for a periodic solution: phase 0).
    pub t0_s: f64,
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Values in `unit`.
    pub values: Vec<f64>,
}

/// A displacement, a force of the mesh, or a further quantity of a train.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ChannelKind {
    X,
    S,
    Yp,
    Zp,
    ThetaP,
    Yg,
    Zg,
    ThetaG,
    NormalForce,
    TangentialForce,
    AxialForce,
    ToothForce,
    /// Index in [`ModalTrain::outputs`].
    Output(u16),
}

impl ChannelKind {
    fn is_force(self) -> bool {
        matches!(
            self,
            ChannelKind::NormalForce | ChannelKind::TangentialForce | ChannelKind::AxialForce | ChannelKind::ToothForce
        )
    }
}

const CHANNEL_KINDS: [(&str, ChannelKind); 12] = [
    ("x", ChannelKind::X),
    ("s", ChannelKind::S),
    ("y_p", ChannelKind::Yp),
    ("z_p", ChannelKind::Zp),
    ("theta_p", ChannelKind::ThetaP),
    ("y_g", ChannelKind::Yg),
    ("z_g", ChannelKind::Zg),
    ("theta_g", ChannelKind::ThetaG),
    ("f_n", ChannelKind::NormalForce),
    ("f_y", ChannelKind::TangentialForce),
    ("f_z", ChannelKind::AxialForce),
    ("tooth_force", ChannelKind::ToothForce),
];

/// Identifier of a channel. Names: `x_left` (tangential mesh displacement), `s_right` (along the tooth normal),
/// `y_p_left`, `z_p_…`, `theta_p_…`, `y_g_…`, `z_g_…`, `theta_g_…`, each also with the prefix `v_` (velocity) or `a_`
/// (acceleration); `f_n_…`, `f_y_…`, `f_z_…` (mesh force); `tooth_force_…` (total normal tooth force: mesh force and
/// impact). The further quantities of a train are channels by the names that the train gives them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChannelId {
    kind: ChannelKind,
    /// 0 displacement, 1 velocity, 2 acceleration.
    derivative: u8,
    /// 0 left, 1 right.
    half: u8,
}

impl ChannelId {
    /// x'' of a half: the mesh circumferential acceleration.
    pub(super) fn mesh_acceleration(half: u8) -> Self {
        Self { kind: ChannelKind::X, derivative: 2, half }
    }

    /// z_p'' of a half: the axial acceleration of the pinion.
    pub(super) fn pinion_axial_acceleration(half: u8) -> Self {
        Self { kind: ChannelKind::Zp, derivative: 2, half }
    }

    pub(super) fn s(half: u8) -> Self {
        Self { kind: ChannelKind::S, derivative: 0, half }
    }

    pub(super) fn normal_force(half: u8) -> Self {
        Self { kind: ChannelKind::NormalForce, derivative: 0, half }
    }

    /// Normal tooth force of a half, impact included.
    pub(super) fn tooth_force(half: u8) -> Self {
        Self { kind: ChannelKind::ToothForce, derivative: 0, half }
    }

    /// The channels of the further quantities of a train.
    pub fn outputs_of(train: &ModalTrain) -> impl Iterator<Item = Self> {
        (0..train.outputs.len() as u16).map(|i| Self { kind: ChannelKind::Output(i), derivative: 0, half: 0 })
    }

    /// The channel of this name, those of the train included.
    pub fn parse_with(name: &str, train: Option<&ModalTrain>) -> Option<Self> {
        let output = |train: &ModalTrain| {
            Self::outputs_of(train).zip(&train.outputs).find(|(_, output)| output.name == name).map(|(id, _)| id)
        };
        Self::parse(name).or_else(|| train.and_then(output))
    }

    /// Name of the channel, a quantity of the train by the name given there.
    pub fn name_with(self, train: Option<&ModalTrain>) -> String {
        match self.output(train) {
            Some(output) => output.name.clone(),
            None => self.name(),
        }
    }

    /// Physical quantity of the channel, a quantity of the train by its unit.
    pub fn quantity_with(self, train: Option<&ModalTrain>) -> ChannelQuantity {
        self.output(train).map_or_else(|| self.quantity(), |output| ChannelQuantity::of_unit(&output.unit))
    }

    fn output(self, train: Option<&ModalTrain>) -> Option<&LinearOutput> {
        let ChannelKind::Output(index) = self.kind else { return None };
        train?.outputs.get(usize::from(index))
    }

    /// The channel of this name, if there is one of every pair.
    pub fn parse(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|id| id.name() == name)
    }

    /// All channels of every pair.
    pub fn all() -> Vec<Self> {
        let mut out = Vec::new();
        for half in 0..2 {
            for (_, kind) in CHANNEL_KINDS {
                for derivative in 0..if kind.is_force() { 1 } else { 3 } {
                    out.push(Self { kind, derivative, half });
                }
            }
        }
        out
    }

    /// Name of the channel. See [`ChannelId::name_with`] for the quantities of a train.
    pub fn name(self) -> String {
        if let ChannelKind::Output(index) = self.kind {
            return format!("output_{index}");
        }
        let prefix = ["", "v_", "a_"][usize::from(self.derivative)];
        let base = CHANNEL_KINDS.iter().find(|(_, s)| *s == self.kind).map_or("", |(name, _)| name);
        let half = ["left", "right"][usize::from(self.half)];
        format!("{prefix}{base}_{half}")
    }

    /// Physical quantity of the channel. See [`ChannelId::quantity_with`] for the quantities of a train.
    pub fn quantity(self) -> ChannelQuantity {
        let linear = [ChannelQuantity::Displacement, ChannelQuantity::Velocity, ChannelQuantity::Acceleration];
        let angular =
            [ChannelQuantity::Rotation, ChannelQuantity::AngularVelocity, ChannelQuantity::AngularAcceleration];
        match self.kind {
            kind if kind.is_force() => ChannelQuantity::Force,
            ChannelKind::Output(_) => ChannelQuantity::Force,
            ChannelKind::ThetaP | ChannelKind::ThetaG => angular[usize::from(self.derivative)],
            _ => linear[usize::from(self.derivative)],
        }
    }

    pub(super) fn is_acceleration(self) -> bool {
        self.derivative == 2
    }

    /// Evaluator of the channel from solver coordinates.
    pub(super) fn evaluator<const D: usize>(self, model: &DynamicModel<D>) -> ChannelEvaluator<D> {
        let half = usize::from(self.half);
        if let Some(train) = &model.train {
            return self.evaluator_of_train(model, train);
        }
        // Where one half is solved, the other is its mirror image.
        let (j, mirrored) = if D > PER_HALF { (half, 1.0) } else { (0, if half == 0 { 1.0 } else { -1.0 }) };
        let mut row = [0.0; D];
        let i = j * PER_HALF;
        let h = &model.halves[j];
        let sum = h.reduced_p + h.reduced_g;
        match self.kind {
            ChannelKind::X => (row[i + YP], row[i + YG], row[i + U]) = (1.0, -1.0, 1.0),
            ChannelKind::S => {
                (row[i + YP], row[i + YG], row[i + U]) = (model.cos, -model.cos, model.cos);
                (row[i + ZP], row[i + ZG]) = (h.sin, -h.sin);
            }
            ChannelKind::Yp => row[i + YP] = 1.0,
            ChannelKind::Zp => row[i + ZP] = mirrored,
            ChannelKind::Yg => row[i + YG] = 1.0,
            ChannelKind::Zg => row[i + ZG] = mirrored,
            ChannelKind::ThetaP => {
                (row[i + U], row[i + W]) = (h.reduced_g / sum / model.radius_p, 1.0 / model.radius_p);
            }
            ChannelKind::ThetaG => {
                (row[i + U], row[i + W]) = (-h.reduced_p / sum / model.radius_g, 1.0 / model.radius_g);
            }
            ChannelKind::NormalForce => return ChannelEvaluator::Force { half: j, factor: 1.0 },
            ChannelKind::TangentialForce => return ChannelEvaluator::Force { half: j, factor: model.cos },
            ChannelKind::AxialForce => return ChannelEvaluator::Force { half: j, factor: mirrored * h.sin },
            ChannelKind::ToothForce => return ChannelEvaluator::ToothForce { half: j },
            // Only trains have further quantities.
            ChannelKind::Output(_) => {}
        }
        let factor = model.omega_ref.powi(i32::from(self.derivative));
        let positions: Vec<usize> = (0..D).filter(|&c| row[c] != 0.0).collect();
        ChannelEvaluator::Linear { row: row.map(|c| c * factor), positions, derivative: usize::from(self.derivative) }
    }

    fn evaluator_of_train<const D: usize>(
        self,
        model: &DynamicModel<D>,
        train: &TrainEquations<D>,
    ) -> ChannelEvaluator<D> {
        let half = usize::from(self.half);
        let place = |c: usize| &train.displacements[half * PER_HALF + c];
        let row = match self.kind {
            ChannelKind::X => &train.mesh_x[half],
            ChannelKind::S => &train.mesh[half],
            ChannelKind::Yp => place(0),
            ChannelKind::Zp => place(1),
            ChannelKind::ThetaP => place(2),
            ChannelKind::Yg => place(3),
            ChannelKind::Zg => place(4),
            ChannelKind::ThetaG => place(5),
            ChannelKind::NormalForce => return ChannelEvaluator::Force { half, factor: 1.0 },
            ChannelKind::TangentialForce => return ChannelEvaluator::Force { half, factor: model.cos },
            ChannelKind::AxialForce => return ChannelEvaluator::Force { half, factor: model.halves[half].sin },
            ChannelKind::ToothForce => return ChannelEvaluator::ToothForce { half },
            ChannelKind::Output(index) => {
                let (mut row, mut rate) = ([0.0; D], None);
                if let Some(rows) = train.outputs.get(usize::from(index)) {
                    row = rows.displacement;
                    rate = rows.velocity.iter().any(|c| *c != 0.0).then(|| Box::new(rows.velocity));
                }
                return ChannelEvaluator::Dense { row: Box::new(row), rate, derivative: 0 };
            }
        };
        let derivative = usize::from(self.derivative);
        let factor = model.omega_ref.powi(i32::from(self.derivative));
        ChannelEvaluator::Dense { row: Box::new(row.map(|c| c * factor)), rate: None, derivative }
    }
}

/// Evaluation of a channel on a segment.
#[derive(Debug, Clone)]
pub(super) enum ChannelEvaluator<const D: usize> {
    Linear {
        row: [f64; D],
        positions: Vec<usize>,
        derivative: usize,
    },
    /// Of a train: a row of the coordinates (or a derivative of them), and one of their rates in scaled time.
    Dense {
        row: Box<[f64; D]>,
        rate: Option<Box<[f64; D]>>,
        derivative: usize,
    },
    Force {
        half: usize,
        factor: f64,
    },
    ToothForce {
        half: usize,
    },
}

impl<const D: usize> ChannelEvaluator<D> {
    /// Polynomial of the channel in scaled time since the start of the segment; returns its degree.
    #[inline(always)]
    pub(crate) fn polynomial(&self, segment: &Segment<'_, D>, out: &mut [f64; MAX_ORDER + 1]) -> usize {
        match self {
            ChannelEvaluator::Linear { row, positions, derivative } => {
                let degree = segment.degree - derivative;
                for n in 0..=degree {
                    let from = &segment.rows[n + derivative];
                    let value: f64 = positions.iter().map(|&c| row[c] * from[c]).sum();
                    let factor = match derivative {
                        0 => 1.0,
                        1 => (n + 1) as f64,
                        _ => ((n + 1) * (n + 2)) as f64,
                    };
                    out[n] = value * factor;
                }
                degree
            }
            ChannelEvaluator::Dense { row, rate, derivative } => {
                let degree = segment.degree - derivative.max(&usize::from(rate.is_some()));
                for n in 0..=degree {
                    let value = row_product(row, &segment.rows[n + derivative]);
                    let factor = match derivative {
                        0 => 1.0,
                        1 => (n + 1) as f64,
                        _ => ((n + 1) * (n + 2)) as f64,
                    };
                    out[n] = value * factor;
                    if let Some(rate) = rate {
                        out[n] += row_product(rate, &segment.rows[n + 1]) * (n + 1) as f64;
                    }
                }
                degree
            }
            ChannelEvaluator::Force { half, factor } => {
                let degree = segment.degree - 2;
                for n in 0..=degree {
                    out[n] = factor * segment.force[*half][n];
                }
                degree
            }
            ChannelEvaluator::ToothForce { half } => {
                let degree = segment.degree - 2;
                if DynamicModel::<D>::IS_TRAIN {
                    segment.model.tooth_force_of_train(*half, segment, out);
                    return degree;
                }
                for n in 0..=degree {
                    out[n] = segment.model.tooth_force_coefficient(*half, n, segment.rows);
                }
                degree
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_understood_and_unique() {
        let all = ChannelId::all();
        assert_eq!(all.len(), 2 * (8 * 3 + 4));
        for id in &all {
            assert_eq!(ChannelId::parse(&id.name()), Some(*id));
        }
        for name in ["x_left", "a_x_right", "v_theta_g_left", "f_n_right", "tooth_force_left", "s_left", "a_z_p_left"] {
            assert!(ChannelId::parse(name).is_some(), "{name}");
        }
        assert!(ChannelId::parse("x_middle").is_none());
    }
}
