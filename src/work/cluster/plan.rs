//! How a sweep is cut into chunks: a scout first, which measures; then chunks of about two seconds, shorter ones at the
//! end, so that all workers finish together.

use crate::store::{ChunkClass, ChunkPart, LineEndRow};
use herringbone_job::study::SweepOrder;
use std::collections::VecDeque;

/// Points of a scout.
const SCOUT_POINTS: usize = 8;
/// Computing time of a chunk that is aimed at, and the least one.
pub(super) const CHUNK_S: f64 = 2.0;
const LEAST_CHUNK_S: f64 = 0.2;
/// Most points of a chunk.
const MOST_POINTS: f64 = 5000.0;
/// The remaining points are divided by this and by the slots of all workers.
const REMAINING_SHARE: f64 = 4.0;
/// Weight of a new measurement in the running mean.
const NEW_WEIGHT: f64 = 0.2;

/// What is left to be cut of a sweep.
#[derive(Debug, Clone)]
pub(super) struct SweepPlan {
    order: SweepOrder,
    left: Left,
    /// Time of a point on a worker, once it was measured.
    point_s: Option<f64>,
    scout_is_out: bool,
}

#[derive(Debug, Clone)]
enum Left {
    /// Positions, as pairs of the first one and the one after the last.
    Points(VecDeque<[u64; 2]>),
    Lines(Vec<Line>),
}

/// A line that is followed by continuation.
#[derive(Debug, Clone)]
struct Line {
    /// Places that are cut, from the start of the line.
    cut: usize,
    /// State at the end of the last place that is stored.
    state: Option<Vec<f64>>,
    /// Whether a stretch is being computed.
    is_out: bool,
}

impl SweepPlan {
    /// The plan of a sweep whose rows at `stored` (ascending) and whose line ends are there.
    pub(super) fn new(order: SweepOrder, stored: &[u64], ends: Vec<LineEndRow>) -> Self {
        let left = if order.is_continued() {
            Left::Lines(lines(&order, stored, ends))
        } else {
            Left::Points(gaps(order.points() as u64, stored))
        };
        Self { order, left, point_s: None, scout_is_out: false }
    }

    pub(super) fn order(&self) -> &SweepOrder {
        &self.order
    }

    /// Points that are not cut.
    pub(super) fn remaining(&self) -> u64 {
        match &self.left {
            Left::Points(ranges) => ranges.iter().map(|[from, to]| to - from).sum(),
            Left::Lines(lines) => lines.iter().map(|line| (self.order.length - line.cut) as u64).sum(),
        }
    }

    /// Cuts the next chunk for workers with so many slots; `None` when there is nothing to be computed now.
    pub(super) fn cut(&mut self, slots: usize) -> Option<(ChunkClass, ChunkPart)> {
        let Some(point_s) = self.point_s else {
            if self.scout_is_out {
                return None;
            }
            let part = self.scout()?;
            self.scout_is_out = true;
            return Some((ChunkClass::Scout, part));
        };
        let remaining = self.remaining() as f64;
        let wanted = (CHUNK_S / point_s).clamp(1.0, MOST_POINTS);
        let share = remaining / (REMAINING_SHARE * slots.max(1) as f64);
        let least = (LEAST_CHUNK_S / point_s).clamp(1.0, MOST_POINTS);
        let length = wanted.min(share).max(least) as usize;
        self.take(length.max(1)).map(|part| (ChunkClass::Sweep, part))
    }

    /// Points spread over the axes; the first ones of a line that is followed, or of points that go in groups.
    fn scout(&mut self) -> Option<ChunkPart> {
        let goes_in_groups = (0..2).any(|position| self.order.group(position).is_some());
        if self.order.is_continued() || goes_in_groups {
            return self.take(SCOUT_POINTS);
        }
        let Left::Points(ranges) = &mut self.left else { return None };
        let positions: Vec<u64> = ranges.iter().flat_map(|[from, to]| *from..*to).collect();
        let count = SCOUT_POINTS.min(positions.len());
        // The first one, the last one, and others evenly between them.
        let chosen = (0..count).map(|i| positions[i * (positions.len() - 1) / (count - 1).max(1)]);
        let chosen: Vec<u64> = chosen.collect();
        let left: Vec<u64> = positions.into_iter().filter(|position| chosen.binary_search(position).is_err()).collect();
        *ranges = ranges_of(&left).into();
        (count > 0).then(|| ChunkPart::Points { ranges: ranges_of(&chosen) })
    }

    fn take(&mut self, length: usize) -> Option<ChunkPart> {
        match &mut self.left {
            Left::Points(left) => {
                let (mut positions, mut last) = (Vec::new(), None);
                while let Some(front) = left.front_mut() {
                    // To the end of a group, in which points may lie that are solved alone.
                    let next = [front[0], front[0] + 1].map(|position| self.order.group(position as usize));
                    let is_within = last.is_some() && (next[0] == last || (next[0].is_none() && next[1] == last));
                    if positions.len() >= length && !is_within {
                        break;
                    }
                    last = next[0].or(last);
                    positions.push(front[0]);
                    front[0] += 1;
                    if front[0] == front[1] {
                        left.pop_front();
                    }
                }
                (!positions.is_empty()).then(|| ChunkPart::Points { ranges: ranges_of(&positions) })
            }
            Left::Lines(lines) => {
                let length_of_line = self.order.length;
                // Lines of which most is left come first: they take longest.
                let (number, line) = lines
                    .iter_mut()
                    .enumerate()
                    .filter(|(_, line)| !line.is_out && line.cut < length_of_line)
                    .min_by_key(|(number, line)| (line.cut, *number))?;
                let (from, to) = (line.cut, (line.cut + length).min(length_of_line));
                (line.cut, line.is_out) = (to, true);
                Some(ChunkPart::Stretch { line: number as u64, from: from as u64, to: to as u64 })
            }
        }
    }

    /// Takes a chunk of an earlier process as cut.
    pub(super) fn resume(&mut self, class: ChunkClass, part: &ChunkPart) {
        self.scout_is_out |= class == ChunkClass::Scout;
        match (&mut self.left, part) {
            (Left::Points(left), ChunkPart::Points { ranges }) => {
                for [from, to] in ranges {
                    *left = without(left, *from, *to);
                }
            }
            (Left::Lines(lines), ChunkPart::Stretch { line, to, .. }) => {
                if let Some(line) = lines.get_mut(*line as usize) {
                    (line.cut, line.is_out) = (*to as usize, true);
                }
            }
            _ => {}
        }
    }

    /// State from which a stretch starts.
    pub(super) fn start(&self, part: &ChunkPart) -> Option<Vec<f64>> {
        match (&self.left, part) {
            (Left::Lines(lines), ChunkPart::Stretch { line, from, .. }) if *from > 0 => {
                lines.get(*line as usize)?.state.clone()
            }
            _ => None,
        }
    }

    /// Takes up that a chunk is stored: the time of its points, and the state at the end of a stretch.
    pub(super) fn store(&mut self, part: &ChunkPart, measured: Option<(u64, f64)>, end: Option<&LineEndRow>) {
        if let Some((points, work_s)) = measured
            && points > 0
            && work_s.is_finite()
        {
            let new = (work_s / points as f64).max(1e-7);
            self.point_s = Some(self.point_s.map_or(new, |mean| mean + NEW_WEIGHT * (new - mean)));
        }
        if let (Left::Lines(lines), ChunkPart::Stretch { line, .. }) = (&mut self.left, part)
            && let Some(line) = lines.get_mut(*line as usize)
        {
            line.is_out = false;
            line.state = end.and_then(|end| end.state.clone());
        }
    }

    /// Positions of the points of a part, as ranges.
    pub(super) fn positions(&self, part: &ChunkPart) -> Vec<[u64; 2]> {
        match part {
            ChunkPart::Whole | ChunkPart::Evaluations { .. } => Vec::new(),
            ChunkPart::Points { ranges } => ranges.clone(),
            ChunkPart::Stretch { line, from, to } => {
                let line = self.order.line(*line as usize);
                let mut positions: Vec<u64> =
                    line.get(*from as usize..*to as usize).unwrap_or_default().iter().map(|one| *one as u64).collect();
                positions.sort_unstable();
                ranges_of(&positions)
            }
        }
    }
}

/// Ascending positions as ranges.
pub(super) fn ranges_of(positions: &[u64]) -> Vec<[u64; 2]> {
    let mut ranges: Vec<[u64; 2]> = Vec::new();
    for &position in positions {
        match ranges.last_mut() {
            Some(last) if last[1] == position => last[1] += 1,
            _ => ranges.push([position, position + 1]),
        }
    }
    ranges
}

/// The positions below `end` that are not in `stored`, which is ascending.
fn gaps(end: u64, stored: &[u64]) -> VecDeque<[u64; 2]> {
    let mut gaps = VecDeque::new();
    let mut from = 0;
    for &position in stored.iter().chain([&end]) {
        if position > from {
            gaps.push_back([from, position.min(end)]);
        }
        from = position + 1;
    }
    gaps
}

fn without(ranges: &VecDeque<[u64; 2]>, from: u64, to: u64) -> VecDeque<[u64; 2]> {
    let parts = ranges.iter().flat_map(|[a, b]| [[*a, (*b).min(from)], [(*a).max(to), *b]]);
    parts.filter(|[a, b]| a < b).collect()
}

/// How far each line was followed: up to its end if all its rows up to there are stored, else it is followed afresh.
fn lines(order: &SweepOrder, stored: &[u64], ends: Vec<LineEndRow>) -> Vec<Line> {
    let mut lines = vec![Line { cut: 0, state: None, is_out: false }; order.lines];
    for LineEndRow { line, position, state } in ends {
        let Some(one) = lines.get_mut(line as usize) else { continue };
        let positions = order.line(line as usize);
        let Some(last) = positions.iter().position(|other| *other as u64 == position) else { continue };
        if positions[..=last].iter().all(|position| stored.binary_search(&(*position as u64)).is_ok()) {
            *one = Line { cut: last + 1, state, is_out: false };
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::document::JobDocument;
    use serde_json::{Value, json};
    use std::collections::BTreeSet;

    fn order(first: usize, second: usize, continuation: &str) -> SweepOrder {
        order_by("auto", first, second, continuation)
    }

    fn order_by(method: &str, first: usize, second: usize, continuation: &str) -> SweepOrder {
        let mut document: Value = serde_json::from_str(include_str!("../../../examples/speed_sweep.json")).unwrap();
        document["axes"] = json!([
            {"pointer": "/operation/pinion_speed_rpm", "from": 1000.0, "to": 2000.0, "points": first},
            {"pointer": "/operation/pinion_torque_nm", "from": 100.0, "to": 200.0, "points": second},
        ]);
        document["continuation"] = continuation.into();
        document["analysis"]["method"] = method.into();
        let document: JobDocument = herringbone_job::parse(document.to_string().as_bytes()).unwrap();
        SweepOrder::of(&document)
    }

    fn positions(plan: &SweepPlan, part: &ChunkPart) -> Vec<u64> {
        plan.positions(part).into_iter().flat_map(|[from, to]| from..to).collect()
    }

    /// Cuts all of a plan, each chunk stored at once; the lengths of the chunks.
    fn cut_all(plan: &mut SweepPlan, point_s: f64, slots: usize) -> Vec<usize> {
        let (mut seen, mut lengths) = (BTreeSet::new(), Vec::new());
        while let Some((class, part)) = plan.cut(slots) {
            assert_eq!(class == ChunkClass::Scout, lengths.is_empty());
            let own = positions(plan, &part);
            assert!(own.iter().all(|position| seen.insert(*position)), "{own:?} twice");
            plan.store(&part, Some((own.len() as u64, own.len() as f64 * point_s)), None);
            lengths.push(own.len());
        }
        assert_eq!(plan.remaining(), 0);
        assert_eq!(seen.into_iter().collect::<Vec<_>>(), (0..plan.order().points() as u64).collect::<Vec<_>>());
        lengths
    }

    #[test]
    fn a_scout_goes_first_and_the_last_chunks_are_short() {
        let mut plan = SweepPlan::new(order(100, 50, "none"), &[], Vec::new());
        let lengths = cut_all(&mut plan, 0.015, 2);
        assert_eq!((lengths[0], lengths[1]), (8, 133));
        assert!(lengths[lengths.len() - 1] <= 14, "{lengths:?}");
        assert!(lengths[1..].windows(2).all(|two| two[0] >= two[1]), "{lengths:?}");
    }

    #[test]
    fn points_that_are_integrated_side_by_side_go_in_whole_groups() {
        let order = order_by("integrate", 100, 5, "none");
        let mut plan = SweepPlan::new(order.clone(), &[], Vec::new());
        let mut lengths = Vec::new();
        let mut groups = BTreeSet::new();
        while let Some((_, part)) = plan.cut(3) {
            let own = positions(&plan, &part);
            let of_part: BTreeSet<usize> = own.iter().filter_map(|one| order.group(*one as usize)).collect();
            assert!(of_part.iter().all(|group| groups.insert(*group)), "{own:?} has a part of a group");
            plan.store(&part, Some((own.len() as u64, own.len() as f64 * 0.05)), None);
            lengths.push(own.len());
        }
        assert_eq!((lengths[0], lengths.iter().sum::<usize>()), (33, 500));
        assert!(lengths.iter().all(|length| (1..=70).contains(length)), "{lengths:?}");
    }

    #[test]
    fn nothing_is_cut_until_the_scout_is_back() {
        let mut plan = SweepPlan::new(order(100, 50, "none"), &[], Vec::new());
        let (_, scout) = plan.cut(4).unwrap();
        assert_eq!(plan.cut(4), None);
        assert_eq!(positions(&plan, &scout).first(), Some(&0));
        assert_eq!(positions(&plan, &scout).last(), Some(&4999));
    }

    #[test]
    fn cheap_points_go_in_large_chunks_and_dear_ones_alone() {
        let mut plan = SweepPlan::new(order(1000, 100, "none"), &[], Vec::new());
        assert!(cut_all(&mut plan, 1e-4, 2)[1..].iter().all(|length| *length <= 5000));
        let mut plan = SweepPlan::new(order(5, 4, "none"), &[], Vec::new());
        assert!(cut_all(&mut plan, 30.0, 2)[1..].iter().all(|length| *length == 1));
    }

    #[test]
    fn what_is_stored_is_not_cut_again() {
        let stored: Vec<u64> = (0..100).filter(|position| position % 3 != 0).collect();
        let mut plan = SweepPlan::new(order(20, 5, "none"), &stored, Vec::new());
        assert_eq!(plan.remaining(), 34);
        let mut resumed = plan.clone();
        let (class, part) = plan.cut(1).unwrap();
        resumed.resume(class, &part);
        assert_eq!((resumed.remaining(), plan.remaining()), (26, 26));
        let all: Vec<u64> = (0..100).collect();
        assert_eq!(SweepPlan::new(order(20, 5, "none"), &all, Vec::new()).cut(1), None);
    }

    #[test]
    fn a_line_is_followed_stretch_by_stretch_from_the_state_at_its_end() {
        let mut plan = SweepPlan::new(order(20, 2, "both"), &[], Vec::new());
        let (class, scout) = plan.cut(8).unwrap();
        assert_eq!((class, &scout), (ChunkClass::Scout, &ChunkPart::Stretch { line: 0, from: 0, to: 8 }));
        let end = LineEndRow { line: 0, position: 7, state: Some(vec![1.0]) };
        plan.store(&scout, Some((8, 8.0)), Some(&end));
        // One stretch of each line at once.
        let cut: Vec<ChunkPart> = std::iter::from_fn(|| plan.cut(1)).map(|(_, part)| part).collect();
        assert_eq!(cut.len(), 4);
        let of_first = cut.iter().find(|part| matches!(part, ChunkPart::Stretch { line: 0, .. })).unwrap();
        assert_eq!(plan.start(of_first), Some(vec![1.0]));
        assert_eq!(positions(&plan, of_first), [8, 9]);
        // Downwards from the other end, in the second half of the rows.
        let down = cut.iter().find(|part| matches!(part, ChunkPart::Stretch { line: 2, .. })).unwrap();
        assert_eq!(positions(&plan, down), [58, 59]);
        assert_eq!(plan.start(down), None);
        let mut plan = SweepPlan::new(order(20, 2, "both"), &[], Vec::new());
        cut_all(&mut plan, 0.5, 2);
    }

    #[test]
    fn a_line_without_all_its_rows_is_followed_afresh() {
        let end = |line, position| LineEndRow { line, position, state: Some(vec![2.0]) };
        let stored: Vec<u64> = (0..5).chain(20..23).chain([24]).collect();
        let mut plan = SweepPlan::new(order(20, 2, "up"), &stored, vec![end(0, 4), end(1, 24)]);
        assert_eq!(plan.remaining(), 15 + 20);
        let (_, part) = plan.cut(1).unwrap();
        assert_eq!(part, ChunkPart::Stretch { line: 1, from: 0, to: 8 });
        plan.store(&part, Some((8, 8.0)), None);
        let (_, part) = plan.cut(1).unwrap();
        assert_eq!((&part, plan.start(&part)), (&ChunkPart::Stretch { line: 0, from: 5, to: 7 }, Some(vec![2.0])));
    }
}
