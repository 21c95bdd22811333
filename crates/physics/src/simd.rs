//! Dispatch to the vector instructions of the processor.

/// Runs `work` compiled for the vector instructions of this processor. Functions called in it must be inlined to be
/// compiled so. Results do not depend on the instructions: no operation is fused or reordered.
#[inline(always)]
pub(crate) fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}
