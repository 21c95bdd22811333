//! The vector instructions of the processor at hand.

/// Runs `work` compiled for the vector instructions this processor has. Everything hot in it has to be inlined into it.
/// Results do not depend on the instructions: nothing is fused or reordered.
#[inline(always)]
pub(crate) fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}
