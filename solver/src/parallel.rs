//! Work shared out in blocks. What is done to a block is a `dyn` call, so that the machinery of
//! threads is compiled once for each type of item and not for each scheme; a call for [`BLOCK`]
//! rows costs nothing.

use rayon::prelude::*;

use crate::neighbours::BLOCK;

/// Does `work(b, items of block b)` for all blocks of [`BLOCK`] items, on several threads or in
/// order; each block has a result.
pub(crate) fn map_blocks<T: Send, R: Send>(
    items: &mut [T],
    results: &mut [R],
    parallel: bool,
    work: &(dyn Fn(usize, &mut [T]) -> R + Sync),
) {
    let work = |(b, (items, result)): (usize, (&mut [T], &mut R))| *result = work(b, items);
    if parallel {
        items.par_chunks_mut(BLOCK).zip(results).enumerate().for_each(work);
    } else {
        items.chunks_mut(BLOCK).zip(results).enumerate().for_each(work);
    }
}

/// The same where a block has none.
pub(crate) fn for_each_block<T: Send>(
    items: &mut [T],
    parallel: bool,
    work: &(dyn Fn(usize, &mut [T]) + Sync),
) {
    // Of no size: nothing is allocated.
    let mut nothing = vec![(); items.len().div_ceil(BLOCK)];
    map_blocks(items, &mut nothing, parallel, work);
}
