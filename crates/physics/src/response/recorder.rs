//! Recording of channels during an integration: statistics, time series, contact times.

use super::channel::{ChannelEvaluator, ChannelId};
use super::orders::{MeshOrder, OrderAccumulator, OrderTable};
use super::statistics::{MomentAccumulator, horner};
use crate::dynamics::{DynamicModel, MAX_ORDER, Observer, PER_HALF, Segment};
use crate::simd::vectorised;

/// Recording of one channel.
struct ChannelTrack<const D: usize> {
    id: ChannelId,
    evaluator: ChannelEvaluator<D>,
    accumulator: MomentAccumulator,
    extremes: bool,
    samples: Option<Vec<f64>>,
    orders: Option<OrderAccumulator>,
}

/// Observer of the recorded mesh periods.
pub(super) struct ChannelRecorder<const D: usize> {
    tracks: Vec<ChannelTrack<D>>,
    samples_per_mesh_period: usize,
    /// Mesh period of the last segment, and the index of the next sample within it.
    period: u64,
    next_sample: usize,
    sampling: bool,
    /// Scaled time on driving flank, apart, and on back flank, per solved half.
    contact: [[f64; 3]; 2],
    /// Some if a channel has its mesh orders recorded.
    order_table: Option<Box<OrderTable>>,
}

impl<const D: usize> ChannelRecorder<D> {
    /// `statistics`: channels with statistics, and whether extremes are needed. `series`: channels that are sampled,
    /// over `periods` mesh periods.
    pub(crate) fn new(
        model: &DynamicModel<D>,
        statistics: &[(ChannelId, bool)],
        series: &[ChannelId],
        samples_per_mesh_period: usize,
        periods: u64,
    ) -> Self {
        // Limited: long records grow during recording.
        let capacity = samples_per_mesh_period.saturating_mul(periods as usize).min(1 << 20);
        let mut tracks: Vec<ChannelTrack<D>> = Vec::new();
        let mut add = |id: ChannelId, extremes: bool, sampled: bool| {
            let samples = sampled.then(|| Vec::with_capacity(capacity));
            match tracks.iter_mut().find(|t| t.id == id) {
                Some(track) => {
                    track.extremes |= extremes;
                    track.samples = track.samples.take().or(samples);
                }
                None => tracks.push(ChannelTrack {
                    id,
                    evaluator: id.evaluator(model),
                    accumulator: MomentAccumulator::new(id.is_acceleration()),
                    extremes,
                    samples,
                    orders: None,
                }),
            }
        };
        for &(id, extremes) in statistics {
            add(id, extremes, false);
        }
        for &id in series {
            add(id, true, samples_per_mesh_period > 0);
        }
        Self {
            tracks,
            samples_per_mesh_period,
            period: 0,
            next_sample: 0,
            sampling: samples_per_mesh_period > 0 && !series.is_empty(),
            contact: [[0.0; 3]; 2],
            order_table: None,
        }
    }

    /// Records the mesh orders of channels that have statistics.
    pub(crate) fn with_orders(mut self, ids: &[ChannelId]) -> Self {
        for track in &mut self.tracks {
            if ids.contains(&track.id) {
                track.orders = Some(OrderAccumulator::default());
                self.order_table.get_or_insert_with(OrderTable::new);
            }
        }
        self
    }

    /// Mesh orders of a channel, if they were recorded.
    pub(crate) fn orders(&self, id: ChannelId) -> Option<Vec<MeshOrder>> {
        self.tracks.iter().find(|t| t.id == id)?.orders.as_ref().map(OrderAccumulator::finish)
    }

    pub(crate) fn accumulator(&self, id: ChannelId) -> Option<&MomentAccumulator> {
        self.tracks.iter().find(|t| t.id == id).map(|t| &t.accumulator)
    }

    pub(crate) fn all(&self) -> impl Iterator<Item = (ChannelId, &MomentAccumulator, bool)> {
        self.tracks.iter().map(|t| (t.id, &t.accumulator, t.extremes))
    }

    pub(crate) fn take_samples(&mut self) -> Vec<(ChannelId, Vec<f64>)> {
        self.tracks.iter_mut().filter_map(|t| t.samples.take().map(|s| (t.id, s))).collect()
    }

    /// Fractions of time on driving flank, apart and on back flank, left and right.
    pub(crate) fn contact_shares(&self) -> [[f64; 3]; 2] {
        let share = |j: usize| {
            let total: f64 = self.contact[j].iter().sum();
            self.contact[j].map(|c| c / total)
        };
        [share(0), share(if D > PER_HALF { 1 } else { 0 })]
    }
}

impl<const D: usize> Observer<D> for ChannelRecorder<D> {
    fn segment(&mut self, segment: &Segment<'_, D>) {
        for j in 0..DynamicModel::<D>::HALVES {
            self.contact[j][(1 - segment.contact[j].signum()) as usize] += segment.h;
        }
        let mut polynomial = [0.0; MAX_ORDER + 1];
        let period_tau = segment.model.period_tau;
        let end = segment.phase + segment.h / period_tau;
        let per_period = self.samples_per_mesh_period;
        if segment.period != self.period {
            self.period = segment.period;
            self.next_sample = 0;
        }
        let first = self.next_sample;
        let mut last = first;
        if self.sampling {
            // A sample at the end of the segment belongs to the next one.
            while last < per_period && (last as f64 / per_period as f64) < end {
                last += 1;
            }
        }
        let length = segment.h / period_tau;
        if let Some(table) = &mut self.order_table {
            table.set(segment.phase, length);
        }
        for track in &mut self.tracks {
            let degree = vectorised(
                #[inline(always)]
                || {
                    let degree = track.evaluator.polynomial(segment, &mut polynomial);
                    let c = &polynomial[..=degree];
                    match (&mut track.orders, &self.order_table) {
                        (Some(orders), Some(table)) => {
                            let values = track.accumulator.add_with_values(c, segment.h, track.extremes);
                            orders.add(&values, table, length);
                        }
                        _ => track.accumulator.add(c, segment.h, track.extremes),
                    }
                    degree
                },
            );
            let c = &polynomial[..=degree];
            if let Some(samples) = &mut track.samples {
                for i in first..last {
                    samples.push(horner(c, (i as f64 / per_period as f64 - segment.phase) * period_tau));
                }
            }
        }
        self.next_sample = last;
    }
}
