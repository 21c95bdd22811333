//! Plan of the inside of one sector by fronts (multifrontal Cholesky; Duff & Reid 1983): what remains is the
//! stiffness of the cut faces, the forces the loads put on them, and the compliance of the loads with the faces held.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltParams, LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::traits::{ComplexField, Conjugate};
use faer::{Accum, Mat, MatMut, MatRef, Par, Spec};

use super::dissection::Dissection;
use super::input::FeError;
use super::loads::Loads;
use super::operator::Operator;
use crate::watch::Watch;

/// A sector without its inside.
pub(super) struct Condensed {
    /// Stiffness of the points that stayed, in the order given, three unknowns each; both triangles.
    pub stiffness: Mat<f64>,
    /// Forces on them by every load (unknowns x loads).
    pub forces: Mat<f64>,
    /// Displacement under every load by every load with those points held; both triangles.
    pub compliance: Mat<f64>,
}

/// A matrix by columns, zero at first; pages that are never written cost nothing.
struct DenseMatrix {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl DenseMatrix {
    fn zeros(rows: usize, columns: usize) -> DenseMatrix {
        DenseMatrix { rows, columns, values: vec![0.0; rows * columns] }
    }

    fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.rows..(j + 1) * self.rows]
    }

    fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.rows..(j + 1) * self.rows]
    }

    fn as_mut(&mut self) -> MatMut<'_, f64> {
        MatMut::from_column_major_slice_mut(&mut self.values, self.rows, self.columns)
    }

    fn as_ref(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.values, self.rows, self.columns)
    }
}

/// Update matrix of a front: Schur complement over points not yet eliminated.
struct UpdateMatrix {
    points: Vec<usize>,
    stiffness: DenseMatrix,
    /// Loads with forces on these points.
    loads: Vec<usize>,
    forces: Mat<f64>,
    /// Compliance by the eliminated points, none without loads.
    compliance: Option<Mat<f64>>,
}

struct Elimination<'a> {
    operator: &'a Operator,
    loads: &'a Loads,
    /// Place of every point in the order of elimination.
    rank: Vec<usize>,
    watch: Watch<'a>,
    /// Work of the whole, and of the fronts that are eliminated, in multiplications.
    work: f64,
    done: std::sync::atomic::AtomicU64,
    /// Progress of the elimination, from and to.
    progress: (f64, f64),
}

const UNASSIGNED: usize = usize::MAX;

/// Eliminates all of `tree`; `kept` are the points that stay.
pub(super) fn condense(
    operator: &Operator,
    loads: &Loads,
    load_count: usize,
    tree: &Dissection,
    kept: &[usize],
    watch: Watch,
    progress: (f64, f64),
) -> Result<Condensed, FeError> {
    let mut rank = vec![UNASSIGNED; operator.points()];
    let mut next = 0;
    enumerate(tree, &mut rank, &mut next);
    for &point in kept {
        rank[point] = next;
        next += 1;
    }
    let mut plan = Elimination { operator, loads, rank, watch, work: 0.0, done: Default::default(), progress };
    (plan.work, _) = plan.work_of(tree)?;
    let inside = plan.eliminate(tree)?;
    // Direct coupling of the kept points, and the Schur complement of the inside.
    let mut index = vec![UNASSIGNED; operator.points()];
    for (i, &point) in kept.iter().enumerate() {
        index[point] = i;
    }
    let size = 3 * kept.len();
    let mut front = DenseMatrix::zeros(size, size);
    plan.assemble(kept, &index, &mut front);
    extend((&mut front, &mut DenseMatrix::zeros(0, 0)), &inside, &index, watch)?;
    let mut stiffness = front.as_ref().to_owned();
    mirror(&mut stiffness);
    let mut forces = Mat::<f64>::zeros(size, load_count);
    for (column, &load) in inside.loads.iter().enumerate() {
        for (i, &point) in inside.points.iter().enumerate() {
            for c in 0..3 {
                forces[(3 * index[point] + c, load)] += inside.forces[(3 * i + c, column)];
            }
        }
    }
    let mut compliance = inside.compliance.unwrap_or_else(|| Mat::zeros(load_count, load_count));
    mirror(&mut compliance);
    Ok(Condensed { stiffness, forces, compliance })
}

fn enumerate(tree: &Dissection, rank: &mut [usize], next: &mut usize) {
    for child in &tree.children {
        enumerate(child, rank, next);
    }
    for &point in &tree.own {
        rank[point] = *next;
        *next += 1;
    }
}

/// Adds the lower triangle of `part` into the front: columns below `inner` go to `left`, the others to `right`.
///
/// # Errors
/// [`FeError::Canceled`].
fn extend(
    (left, right): (&mut DenseMatrix, &mut DenseMatrix),
    part: &UpdateMatrix,
    index: &[usize],
    watch: Watch,
) -> Result<(), FeError> {
    let inner = left.columns;
    // Ranks rise in both, so the triangle stays the lower one.
    for (j, &pj) in part.points.iter().enumerate() {
        watch.checkpoint_quietly()?;
        for b in 0..3 {
            let column = 3 * index[pj] + b;
            let source = &part.stiffness.column(3 * j + b)[3 * j..];
            let (target, shift) =
                if column < inner { (left.column_mut(column), 0) } else { (right.column_mut(column - inner), inner) };
            for (values, &point) in source.chunks_exact(3).zip(&part.points[j..]) {
                let row = 3 * index[point] - shift;
                for (t, v) in target[row..row + 3].iter_mut().zip(values) {
                    *t += v;
                }
            }
        }
    }
    Ok(())
}

fn mirror(matrix: &mut Mat<f64>) {
    for j in 0..matrix.ncols() {
        for i in j + 1..matrix.nrows() {
            matrix[(j, i)] = matrix[(i, j)];
        }
    }
}

impl Elimination<'_> {
    fn eliminate(&self, tree: &Dissection) -> Result<UpdateMatrix, FeError> {
        // Before the parts of a tree that are left are assembled.
        self.watch.checkpoint_quietly()?;
        let parts: Vec<UpdateMatrix> = match tree.children.as_slice() {
            [] => Vec::new(),
            [a, b] => {
                let (a, b) = rayon::join(|| self.eliminate(a), || self.eliminate(b));
                vec![a?, b?]
            }
            more => more.iter().map(|child| self.eliminate(child)).collect::<Result<_, _>>()?,
        };
        self.watch.checkpoint_quietly()?;
        self.front(&tree.own, parts)
    }

    /// Reports the work of the fronts that are eliminated and `more` of the one in hand.
    fn checkpoint(&self, more: f64) -> Result<(), FeError> {
        let done = self.done.load(std::sync::atomic::Ordering::Relaxed) as f64 + more;
        let fraction = (done / self.work.max(1.0)).min(1.0);
        Ok(self.watch.checkpoint(self.progress.0 + (self.progress.1 - self.progress.0) * fraction)?)
    }

    /// Work of the elimination of `tree`, and the points of its last front that stay.
    fn work_of(&self, tree: &Dissection) -> Result<(f64, Vec<usize>), FeError> {
        self.watch.checkpoint_quietly()?;
        let children: Vec<_> = tree.children.iter().map(|child| self.work_of(child)).collect::<Result<_, _>>()?;
        let later = self.later(&tree.own, children.iter().map(|(_, points)| points.as_slice()));
        let own = front_work(3 * tree.own.len(), 3 * later.len());
        Ok((own + children.iter().map(|(work, _)| work).sum::<f64>(), later))
    }

    /// Points of the front of `own` that stay, ranks rising: all later ones that its own or the `parts` are coupled to.
    fn later<'p>(&self, own: &[usize], parts: impl Iterator<Item = &'p [usize]>) -> Vec<usize> {
        let mut is_known = vec![false; self.rank.len()];
        own.iter().for_each(|&point| is_known[point] = true);
        let mut later: Vec<usize> = Vec::new();
        let mut note = |point: usize| {
            if !std::mem::replace(&mut is_known[point], true) {
                later.push(point);
            }
        };
        for &point in own {
            self.operator.for_each_neighbour(point, |other, _| {
                if self.rank[other] > self.rank[point] {
                    note(other);
                }
            });
        }
        parts.flatten().for_each(|&point| note(point));
        later.sort_unstable_by_key(|&point| self.rank[point]);
        later
    }

    /// Lower triangle of the stiffness between `points` (ranks rising) and all that come later, where `index` has them.
    fn assemble(&self, points: &[usize], index: &[usize], front: &mut DenseMatrix) {
        for &point in points {
            let first = 3 * index[point];
            self.operator.for_each_neighbour(point, |other, block| {
                let rank = self.rank[other];
                if rank < self.rank[point] {
                    return;
                }
                let row = 3 * index[other];
                // Above the diagonal nothing is read.
                for (a, values) in block.values().chunks_exact(3).enumerate() {
                    for (t, v) in front.column_mut(first + a)[row..row + 3].iter_mut().zip(values) {
                        *t += v;
                    }
                }
            });
        }
    }

    fn front(&self, own: &[usize], parts: Vec<UpdateMatrix>) -> Result<UpdateMatrix, FeError> {
        // Points of the front: its own, then the later ones.
        let later = self.later(own, parts.iter().map(|part| part.points.as_slice()));
        let mut index = vec![UNASSIGNED; self.rank.len()];
        for (i, &point) in own.iter().chain(&later).enumerate() {
            index[point] = i;
        }
        let (inner, outer) = (3 * own.len(), 3 * later.len());
        let mut front = DenseMatrix::zeros(inner + outer, inner);
        let mut remainder = DenseMatrix::zeros(outer, outer);
        self.assemble(own, &index, &mut front);
        for part in &parts {
            extend((&mut front, &mut remainder), part, &index, self.watch)?;
        }

        // Loads.
        let mut loads: Vec<usize> = parts.iter().flat_map(|part| part.loads.iter().copied()).collect();
        for &point in own {
            let (node, function) = self.operator.place(point);
            if self.loads.touches(node) {
                self.loads.for_each(self.operator, node, function, |load, _| loads.push(load));
            }
        }
        loads.sort_unstable();
        loads.dedup();
        let column = |load: usize| loads.partition_point(|&l| l < load);
        let mut forces = Mat::<f64>::zeros(inner + outer, loads.len());
        for &point in own {
            let (node, function) = self.operator.place(point);
            if self.loads.touches(node) {
                let row = 3 * index[point];
                self.loads.for_each(self.operator, node, function, |load, force| {
                    let column = column(load);
                    for (c, f) in force.into_iter().enumerate() {
                        forces[(row + c, column)] += f;
                    }
                });
            }
        }
        let mut compliance = (!loads.is_empty()).then(|| Mat::<f64>::zeros(loads.len(), loads.len()));
        for part in &parts {
            let columns: Vec<usize> = part.loads.iter().map(|&load| column(load)).collect();
            for (source, &target) in columns.iter().enumerate() {
                self.watch.checkpoint_quietly()?;
                for (i, &point) in part.points.iter().enumerate() {
                    for c in 0..3 {
                        forces[(3 * index[point] + c, target)] += part.forces[(3 * i + c, source)];
                    }
                }
            }
            if let (Some(sum), Some(old)) = (&mut compliance, &part.compliance) {
                for (b, &column) in columns.iter().enumerate() {
                    self.watch.checkpoint_quietly()?;
                    for (a, &row) in columns.iter().enumerate().skip(b) {
                        sum[(row, column)] += old[(a, b)];
                    }
                }
            }
        }
        drop(parts);

        let work = front_work(inner, outer);
        let mut checkpoint = |part: f64| self.checkpoint(part * work);
        factor_partly(front.as_mut(), remainder.as_mut(), "inside of a sector", &mut checkpoint)?;
        let (diagonal, below) = front.as_ref().split_at_row(inner);
        if let Some(compliance) = &mut compliance {
            let (mut top, mut bottom) = forces.as_mut().split_at_row_mut(inner);
            // The work of the front is that of its factors.
            let mut factored = || self.checkpoint(work);
            solve_lower(diagonal, top.as_mut(), &mut factored)?;
            product(bottom.as_mut(), Accum::Add, below, top.as_ref(), -1.0, &mut factored)?;
            add_square(compliance.as_mut(), top.as_ref().transpose(), 1.0, &mut factored)?;
        }
        self.done.fetch_add(work as u64, std::sync::atomic::Ordering::Relaxed);
        Ok(UpdateMatrix {
            points: later,
            stiffness: remainder,
            forces: forces.submatrix(inner, 0, outer, loads.len()).to_owned(),
            loads,
            compliance,
        })
    }
}

/// Work of the elimination of `inner` unknowns of a front, with `outer` that stay, in multiplications.
fn front_work(inner: usize, outer: usize) -> f64 {
    let (inner, outer) = (inner as f64, outer as f64);
    inner * (inner * inner / 3.0 + inner * outer + outer * outer)
}

/// Work between two checkpoints, in multiplications: some 15 ms for complex numbers.
const PANEL_WORK: usize = 60_000_000;
/// Narrower panels would leave the matrix products inefficient.
const NARROWEST_PANEL: usize = 32;

/// Cholesky elimination of the first unknowns of a Hermitian matrix (lower triangle): `left` has the columns that are
/// eliminated and becomes their factor, `right` what is below and right of it and becomes the Schur complement.
/// `checkpoint` is given the part that is done.
pub(super) fn factor_partly<T: ComplexField>(
    mut left: MatMut<'_, T>,
    mut right: MatMut<'_, T>,
    place: &'static str,
    checkpoint: &mut dyn FnMut(f64) -> Result<(), FeError>,
) -> Result<(), FeError> {
    let (size, inner) = (left.nrows(), left.ncols());
    let width = (PANEL_WORK / (size * size).max(1)).max(NARROWEST_PANEL);
    let params = Spec::<LltParams, T>::default();
    let mut memory = MemBuffer::new(cholesky_in_place_scratch::<T>(width.min(inner), Par::Seq, params));
    let mut start = 0;
    while start < inner {
        let mut checkpoint = || checkpoint(start as f64 / inner as f64);
        checkpoint()?;
        let end = (start + width).min(inner);
        let (panel, rest) =
            left.as_mut().submatrix_mut(start, start, size - start, inner - start).split_at_col_mut(end - start);
        let (mut diagonal, mut below) = panel.split_at_row_mut(end - start);
        cholesky_in_place(
            diagonal.as_mut(),
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            params,
        )
        .map_err(|_| FeError::Singular { place })?;
        solve_lower_triangular_in_place(diagonal.as_ref().conjugate(), below.as_mut().transpose_mut(), Par::Seq);
        let (near, far) = below.as_ref().split_at_row(inner - end);
        let (mut triangle, rectangle) =
            rest.submatrix_mut(end - start, 0, size - end, inner - end).split_at_row_mut(inner - end);
        let minus = -T::one_impl();
        add_square(triangle.as_mut(), near, minus.clone(), &mut checkpoint)?;
        product(rectangle, Accum::Add, far, near.adjoint(), minus.clone(), &mut checkpoint)?;
        add_square(right.as_mut(), far, minus, &mut checkpoint)?;
        start = end;
    }
    Ok(())
}

/// Solves with a lower triangle, some columns at a time.
pub(super) fn solve_lower<T: ComplexField>(
    lower: MatRef<'_, T>,
    mut columns: MatMut<'_, T>,
    checkpoint: &mut dyn FnMut() -> Result<(), FeError>,
) -> Result<(), FeError> {
    let (size, count) = (columns.nrows(), columns.ncols());
    let width = (PANEL_WORK / (size * size).max(1)).max(NARROWEST_PANEL);
    for start in (0..count).step_by(width) {
        checkpoint()?;
        let some = columns.as_mut().subcols_mut(start, width.min(count - start));
        solve_lower_triangular_in_place(lower, some, Par::Seq);
    }
    Ok(())
}

/// `target` with `scale · left · right` added to it or in its place, some columns at a time.
pub(super) fn product<T: ComplexField, R: Conjugate<Canonical = T>>(
    mut target: MatMut<'_, T>,
    accum: Accum,
    left: MatRef<'_, T>,
    right: MatRef<'_, R>,
    scale: T,
    checkpoint: &mut dyn FnMut() -> Result<(), FeError>,
) -> Result<(), FeError> {
    let count = target.ncols();
    let width = (PANEL_WORK / (left.nrows() * left.ncols()).max(1)).max(NARROWEST_PANEL);
    for start in (0..count).step_by(width) {
        checkpoint()?;
        let some = width.min(count - start);
        let columns = target.as_mut().subcols_mut(start, some);
        matmul(columns, accum, left, right.subcols(start, some), scale.clone(), Par::Seq);
    }
    Ok(())
}

/// Adds `scale · factor · factorᴴ` to the lower triangle of `matrix`, some columns at a time.
fn add_square<T: ComplexField>(
    mut matrix: MatMut<'_, T>,
    factor: MatRef<'_, T>,
    scale: T,
    checkpoint: &mut dyn FnMut() -> Result<(), FeError>,
) -> Result<(), FeError> {
    let size = matrix.nrows();
    let width = (PANEL_WORK / (size * factor.ncols()).max(1)).max(NARROWEST_PANEL);
    for start in (0..size).step_by(width) {
        checkpoint()?;
        let some = width.min(size - start);
        let columns = matrix.as_mut().submatrix_mut(start, start, size - start, some);
        let (diagonal, below) = columns.split_at_row_mut(some);
        let (near, far) = factor.subrows(start, size - start).split_at_row(some);
        triangular_matmul(
            diagonal,
            BlockStructure::TriangularLower,
            Accum::Add,
            near,
            BlockStructure::Rectangular,
            near.adjoint(),
            BlockStructure::Rectangular,
            scale.clone(),
            Par::Seq,
        );
        matmul(below, Accum::Add, far, near.adjoint(), scale.clone(), Par::Seq);
    }
    Ok(())
}
