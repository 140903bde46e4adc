//! Runs a loop, written once for lanes of any type, on the widest lanes that the processor supports.

use simba::simd::WideF64x4;

use crate::lane::OnLanes;

/// Runs the loop on the widest lanes that the processor has. The forms for wide registers are compiled in
/// release builds, whose speed matters, and in this crate's own tests, which compare their bits with those
/// of the portable form. All other builds compile the portable form alone: one instead of three.
/// Never inlined, so that a program has a symbol a loop, which tests count.
#[inline(never)]
pub(crate) fn on_widest(work: impl OnLanes) {
    #[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
    let Some(work) = crate::ymm::run(work) else { return };
    work.run::<WideF64x4>();
}
