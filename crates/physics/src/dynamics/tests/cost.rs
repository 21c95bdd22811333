//! What a mesh period costs: allocations (none) and time (printed).

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::time::{Duration, Instant};

use super::reference::{parameters, reference};
use crate::dynamics::*;
use crate::watch::Watch;

/// Counts the allocations of each thread of the unit tests.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: hands everything to the system allocator; the counter is a plain thread-local without a destructor.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|n| n.set(n.get() + 1));
        // SAFETY: the caller's contract is the system allocator's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract is the system allocator's.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn motion<'m, const D: usize>(
    model: &'m DynamicModel<D>,
    name: &str,
    integrator: Integrator,
    tolerance: f64,
) -> Motion<'m, D> {
    let reference = reference();
    let start = reference.cases[name].initial_state.as_slice().try_into().unwrap();
    Motion::new(model, model.state_from(start), integrator, tolerance, u64::MAX)
}

#[test]
fn stepping_allocates_nothing() {
    for integrator in [Integrator::Taylor, Integrator::RungeKutta] {
        let model = DynamicModel::<12>::new(&parameters("C")).unwrap();
        let mut m = motion(&model, "C", integrator, 1e-7);
        let mut columns = Variation::new(&model, Variation::unit_perturbations(&model), 1e-7);
        let before = ALLOCATIONS.get();
        for _ in 0..20 {
            m.advance_period(&mut columns, &Watch::none(), 0.0).unwrap();
        }
        assert_eq!(ALLOCATIONS.get(), before, "{integrator:?}");
    }
}

#[test]
#[ignore = "prints the time per mesh period"]
fn time_per_mesh_period() {
    fn best<const D: usize>(name: &str, tolerance: f64, columns: bool) -> f64 {
        let model = DynamicModel::<D>::new(&parameters(name)).unwrap();
        let mut least = Duration::MAX;
        for _ in 0..200 {
            let mut m = motion(&model, name, Integrator::Taylor, tolerance);
            let mut v = Variation::new(&model, Variation::unit_perturbations(&model), tolerance);
            let at = Instant::now();
            for _ in 0..20 {
                if columns {
                    m.advance_period(&mut v, &Watch::none(), 0.0).unwrap();
                } else {
                    m.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
                }
            }
            least = least.min(at.elapsed());
        }
        least.as_secs_f64() * 1e6 / 20.0
    }
    for name in ["A", "B", "C"] {
        for tolerance in [5e-8, 1e-12] {
            println!(
                "{name} {tolerance:e}: {:.1} µs (6), {:.1} µs (12); with all perturbations {:.1} µs, {:.1} µs",
                best::<6>(name, tolerance, false),
                best::<12>(name, tolerance, false),
                best::<6>(name, tolerance, true),
                best::<12>(name, tolerance, true)
            );
        }
    }
}
