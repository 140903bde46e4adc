//! Distribution of work to threads. Threads take items one by one under a lock, so that the code that
//! manages threads is compiled once and not for each type of item. An item is a block of particles; the cost
//! of taking one is negligible compared with the work on it.

use std::{ops::Range, sync::Mutex};

/// Particles in a part of a cheap loop; fixed, so that nothing depends on the number of threads.
const PART: usize = 512;

/// Cheap loops over fewer particles stay on one thread: at 1 to 10 ns a particle they take no longer than
/// starting other threads, some microseconds.
const WORTHWHILE: usize = 4 * PART;

/// Does `work(item)` for all items, on several threads or in order.
pub fn for_each<T>(
    items: impl ExactSizeIterator<Item = T> + Send,
    parallel: bool,
    work: &(dyn Fn(T) + Sync),
) {
    let count = if parallel { rayon::current_num_threads().min(items.len()) } else { 1 };
    let items = Mutex::new(items);
    on_threads(count, &|| {
        let next = || items.lock().expect("taking an item does not panic").next();
        while let Some(item) = next() {
            work(item);
        }
    });
}

/// Does `work(k, part)` for all parts of a list, on several threads or in order; k is the number of the first
/// entry of the part. For loops that cost some nanoseconds an entry.
pub fn for_each_part<T: Send>(
    all: &mut [T],
    parallel: bool,
    work: &(dyn Fn(usize, &mut [T]) + Sync),
) {
    let is_worthwhile = parallel && all.len() >= WORTHWHILE;
    let parts = all.chunks_mut(PART).enumerate();
    for_each(parts, is_worthwhile, &|(k, part)| work(k * PART, part));
}

/// Does `work(a, b)` for the entries of two lists, as far as the shorter one goes. For loops that cost some
/// nanoseconds an entry.
pub fn for_each_pair<A: Send, B: Sync>(
    all: &mut [A],
    with: &[B],
    parallel: bool,
    work: &(impl Fn(&mut A, &B) + Sync),
) {
    let count = all.len().min(with.len());
    for_each_part(&mut all[..count], parallel, &|first, part| {
        part.iter_mut().zip(&with[first..]).for_each(|(a, b)| work(a, b));
    });
}

/// Does `work(a, b)` for the entries of two lists that both change, as [`for_each_pair`] does.
pub fn for_each_two<A: Send, B: Send>(
    all: &mut [A],
    with: &mut [B],
    parallel: bool,
    work: &(impl Fn(&mut A, &mut B) + Sync),
) {
    let is_worthwhile = parallel && all.len().min(with.len()) >= WORTHWHILE;
    let parts = all.chunks_mut(PART).zip(with.chunks_mut(PART));
    for_each(parts, is_worthwhile, &|(all, with)| {
        all.iter_mut().zip(with).for_each(|(a, b)| work(a, b));
    });
}

/// The results of `work` on all parts of a list of this length, in the order of the list; for sums that do
/// not depend on the number of threads.
pub fn map_parts<R: Send>(
    length: usize,
    parallel: bool,
    work: &(dyn Fn(Range<usize>) -> R + Sync),
) -> Vec<R> {
    let mut results: Vec<Option<R>> = Vec::new();
    results.resize_with(length.div_ceil(PART), || None);
    let is_worthwhile = parallel && length >= WORTHWHILE;
    for_each(results.iter_mut().enumerate(), is_worthwhile, &|(k, result)| {
        *result = Some(work(k * PART..((k + 1) * PART).min(length)));
    });
    results.into_iter().flatten().collect()
}

/// Makes a list equal to another one.
pub fn copy<T: Copy + Send + Sync>(from: &[T], to: &mut Vec<T>, parallel: bool) {
    let Some(first) = from.first() else { return to.clear() };
    to.resize(from.len(), *first);
    for_each_part(to, parallel, &|first, part| part.copy_from_slice(&from[first..][..part.len()]));
}

/// Calls `work` `count` times, on up to `count` threads.
fn on_threads(count: usize, work: &(dyn Fn() + Sync)) {
    if count > 1 {
        rayon::join(|| on_threads(count / 2, work), || on_threads(count - count / 2, work));
    } else {
        work();
    }
}
