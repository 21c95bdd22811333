//! Sets of points none of which is better than another in every objective.

/// Indices of the points that no other one dominates (not worse in any objective and better in one), at most `most`:
/// of more, those with the largest crowding distance (Deb et al. 2002, doi:10.1109/4235.996017) stay. In the order of
/// the first objective.
pub fn crowded_front(points: &[Vec<f64>], most: usize) -> Vec<usize> {
    let dominates = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a <= b) && a.iter().zip(b).any(|(a, b)| a < b);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| compare(&points[*a], &points[*b]).then(a.cmp(b)));
    order.dedup_by(|a, b| points[*a] == points[*b]);
    let mut front: Vec<usize> = Vec::new();
    for index in order {
        // In lexicographic order a point is dominated by earlier ones only.
        if !front.iter().any(|other| dominates(&points[*other], &points[index])) {
            front.push(index);
        }
    }
    while front.len() > most.max(2) {
        let crowding = crowding(points, &front);
        let least = (0..front.len()).min_by(|a, b| crowding[*a].total_cmp(&crowding[*b])).unwrap_or(0);
        front.remove(least);
    }
    front
}

fn compare(a: &[f64], b: &[f64]) -> std::cmp::Ordering {
    a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
}

/// Sum over the objectives of the distance between the neighbours of each point; infinite at the ends.
fn crowding(points: &[Vec<f64>], front: &[usize]) -> Vec<f64> {
    let objectives = front.first().map_or(0, |first| points[*first].len());
    let mut distances = vec![0.0; front.len()];
    let columns = (0..objectives).map(|objective| front.iter().map(|index| points[*index][objective]).collect());
    for column in columns.collect::<Vec<Vec<f64>>>() {
        let value = |place: usize| column[place];
        let mut order: Vec<usize> = (0..front.len()).collect();
        order.sort_by(|a, b| value(*a).total_cmp(&value(*b)));
        let (Some(&first), Some(&last)) = (order.first(), order.last()) else { continue };
        let range = value(last) - value(first);
        distances[first] = f64::INFINITY;
        distances[last] = f64::INFINITY;
        for three in order.windows(3) {
            if range > 0.0 {
                distances[three[1]] += (value(three[2]) - value(three[0])) / range;
            }
        }
    }
    distances
}

/// Place in a front of two objectives of the point farthest from the line through its ends, in units of the ranges;
/// of more objectives, the point nearest to the best of each. `None` of fewer than three points.
pub fn knee(front: &[Vec<f64>]) -> Option<usize> {
    if front.len() < 3 {
        return None;
    }
    let objectives = front[0].len();
    let bounds = |objective: usize| {
        let values = front.iter().map(move |point| point[objective]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
    };
    let distance = |point: &Vec<f64>| -> f64 {
        let parts = (0..objectives).map(|objective| {
            let (least, most) = bounds(objective);
            if most > least { (point[objective] - least) / (most - least) } else { 0.0 }
        });
        // The ends of two objectives are (0, 1) and (1, 0): the sum is the distance from their line, but for a factor.
        if objectives == 2 { parts.sum() } else { parts.map(|part| part * part).sum() }
    };
    (0..front.len()).min_by(|a, b| distance(&front[*a]).total_cmp(&distance(&front[*b])))
}

/// Volume of the points of the unit cube that are dominated by gains: the union of the boxes from no gain to each of
/// them, cut at 0 and 1. Of two or three objectives; of one the largest gain. By slices along the last objective.
pub fn hypervolume(gains: &[Vec<f64>]) -> f64 {
    let cut: Vec<Vec<f64>> = gains.iter().map(|gain| gain.iter().map(|part| part.clamp(0.0, 1.0)).collect()).collect();
    volume(cut)
}

fn volume(mut boxes: Vec<Vec<f64>>) -> f64 {
    let Some(last) = boxes.first().map(|first| first.len().saturating_sub(1)) else { return 0.0 };
    boxes.sort_by(|a, b| b[last].total_cmp(&a[last]));
    if last == 0 {
        return boxes[0][0];
    }
    let mut sum = 0.0;
    for (index, gain) in boxes.iter().enumerate() {
        let below = boxes.get(index + 1).map_or(0.0, |next| next[last]);
        if gain[last] > below {
            let slice = boxes[..=index].iter().map(|gain| gain[..last].to_vec()).collect();
            sum += (gain[last] - below) * volume(slice);
        }
    }
    sum
}
