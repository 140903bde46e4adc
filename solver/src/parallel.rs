//! Distribution of work to threads. Threads take items one by one under a lock, so that the code that
//! manages threads is compiled once and not for each type of item. An item is a block of particles; the cost
//! of taking one is negligible compared with the work on it.

use std::sync::Mutex;

/// Does `work(item)` for all items, on several threads or in order.
pub fn for_each<T>(
    items: impl Iterator<Item = T> + Send,
    parallel: bool,
    work: &(dyn Fn(T) + Sync),
) {
    let items = Mutex::new(items);
    let count = if parallel { rayon::current_num_threads() } else { 1 };
    on_threads(count, &|| {
        let next = || items.lock().expect("taking an item does not panic").next();
        while let Some(item) = next() {
            work(item);
        }
    });
}

/// Calls `work` `count` times, on up to `count` threads.
fn on_threads(count: usize, work: &(dyn Fn() + Sync)) {
    if count > 1 {
        rayon::join(|| on_threads(count / 2, work), || on_threads(count - count / 2, work));
    } else {
        work();
    }
}
