//! Order of elimination: nested dissection (George 1973) on the logical grid of the section and along the face.

use super::operator::Operator;
use super::section::{Border, SectionMesh};

/// A tree of sets of points: children are eliminated before their parent, and are not coupled to each other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dissection {
    /// Points that are eliminated here: the separator of the children, or a leaf.
    pub own: Vec<usize>,
    /// Sets on either side of the separator.
    pub children: Vec<Dissection>,
}

/// Sets of this many points are not divided further.
const SMALLEST: usize = 48;

#[derive(Clone, Copy)]
struct PointPosition {
    point: usize,
    column: i32,
    row: i32,
    support: (f64, f64),
}

impl Dissection {
    /// Orders all points inside the sector: those on the cut faces stay out.
    pub(super) fn new(section: &SectionMesh, operator: &Operator, cells: &[f64]) -> Dissection {
        let places = (0..operator.points())
            .filter_map(|point| {
                let (node, function) = operator.place(point);
                (section.borders[node] == Border::Inside).then(|| PointPosition {
                    point,
                    column: section.nodes[node].column,
                    row: section.nodes[node].row,
                    support: operator.space(node).support(function),
                })
            })
            .collect();
        divide(places, cells)
    }
}

#[derive(Clone, Copy)]
enum Separator {
    Row(i32),
    Column(i32),
    Plane(f64),
}

impl Separator {
    /// Before, on, or behind the cut.
    fn side(self, place: &PointPosition) -> std::cmp::Ordering {
        use std::cmp::Ordering::{Equal, Greater, Less};
        match self {
            Separator::Row(row) => place.row.cmp(&row),
            Separator::Column(column) => place.column.cmp(&column),
            Separator::Plane(z) if place.support.1 <= z => Less,
            Separator::Plane(z) if place.support.0 >= z => Greater,
            Separator::Plane(_) => Equal,
        }
    }
}

fn divide(places: Vec<PointPosition>, cells: &[f64]) -> Dissection {
    let own = |places: Vec<PointPosition>| Dissection {
        own: places.into_iter().map(|place| place.point).collect(),
        children: Vec::new(),
    };
    if places.len() <= SMALLEST {
        return own(places);
    }
    let Some(cut) = best_cut(&places, cells) else { return own(places) };
    let (mut low, mut on, mut high) = (Vec::new(), Vec::new(), Vec::new());
    for place in places {
        match cut.side(&place) {
            std::cmp::Ordering::Less => low.push(place),
            std::cmp::Ordering::Equal => on.push(place.point),
            std::cmp::Ordering::Greater => high.push(place),
        }
    }
    Dissection { own: on, children: vec![divide(low, cells), divide(high, cells)] }
}

/// The cut with the smallest separator for the smaller part it leaves.
fn best_cut(places: &[PointPosition], cells: &[f64]) -> Option<Separator> {
    let mut best: Option<(f64, Separator)> = None;
    let mut consider = |cut: Separator, low: usize, on: usize, high: usize| {
        let smaller = low.min(high);
        if smaller * 8 < places.len() {
            return;
        }
        let cost = on as f64 / smaller as f64;
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, cut));
        }
    };
    let logical = |key: fn(&PointPosition) -> i32,
                   cut: fn(i32) -> Separator,
                   consider: &mut dyn FnMut(Separator, usize, usize, usize)| {
        let top = places.iter().map(key).max().unwrap_or(0);
        let mut counts = vec![0; top as usize + 1];
        for place in places {
            counts[key(place) as usize] += 1;
        }
        let mut low = 0;
        for (value, &on) in counts.iter().enumerate() {
            // Elements end at even numbers.
            if value % 2 == 0 && on > 0 {
                consider(cut(value as i32), low, on, places.len() - low - on);
            }
            low += on;
        }
    };
    logical(|place| place.row, Separator::Row, &mut consider);
    logical(|place| place.column, Separator::Column, &mut consider);
    for &z in cells {
        let low = places.iter().filter(|place| place.support.1 <= z).count();
        let high = places.iter().filter(|place| place.support.0 >= z).count();
        consider(Separator::Plane(z), low, places.len() - low - high, high);
    }
    best.map(|(_, cut)| cut)
}
