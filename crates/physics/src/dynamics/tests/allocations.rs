//! Allocations during an integration: none.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use super::reference::{parameters, reference};
use crate::dynamics::*;
use crate::watch::Watch;

/// Allocator that counts the allocations of each thread of the unit tests.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: forwards to the system allocator; the counter is a plain thread-local without a destructor.
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
