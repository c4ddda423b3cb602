//! Independent jobs on several threads, by rayon.

use std::num::NonZero;
use std::sync::Once;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

/// Threads that this machine runs at once.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}

/// Once a block of this size has been freed, glibc keeps up to twice as much of what each thread
/// frees (bytes).
const HEAP_BLOCK_SIZE: usize = 16 << 20;

/// Lets glibc keep freed memory for the next jobs: returning it to the system and mapping it again
/// took a twelfth of an ensemble's time. Source: mallopt(3), `M_MMAP_THRESHOLD`,
/// `M_TRIM_THRESHOLD`.
fn set_heap_thresholds() {
    static FREED: Once = Once::new();
    FREED.call_once(|| drop(std::hint::black_box(Vec::<u8>::with_capacity(HEAP_BLOCK_SIZE))));
}

/// Results of `work` for each of `jobs`, in their order, on up to `threads` threads. `done` is
/// called with the number of finished jobs, from any of them.
pub fn in_parallel<J: Sync, R: Send>(
    threads: usize,
    jobs: &[J],
    work: &(dyn Fn(&J) -> R + Sync),
    done: &(dyn Fn(usize) + Sync),
) -> Vec<R> {
    let finished = AtomicUsize::new(0);
    let run = |job: &J| {
        let result = work(job);
        done(finished.fetch_add(1, Ordering::Relaxed) + 1);
        result
    };
    set_heap_thresholds();
    if threads <= 1 || jobs.len() <= 1 {
        return jobs.iter().map(run).collect();
    }
    let in_order = || jobs.par_iter().map(run).collect();
    if threads == rayon::current_num_threads() {
        return in_order();
    }
    // Without another pool, the program's own does: results do not depend on the threads.
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(in_order),
        Err(_) => in_order(),
    }
}
