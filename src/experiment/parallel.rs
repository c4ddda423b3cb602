//! Independent jobs on several threads.

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, Once};

/// Threads that this machine runs at once.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}

/// Once a block of this size has been freed, glibc keeps up to twice as much of what each thread
/// frees (bytes).
const HEAP_BLOCK_SIZE: usize = 16 << 20;

/// Has the allocator keep, from now on, what threads free for those that come after them. That of
/// glibc gives memory back to the system, and faults it in again page by page in the next thread,
/// which took a twelfth of an ensemble's time; how much it keeps follows the largest block that was
/// freed so far, of which no page need be touched. Source: mallopt(3), `M_MMAP_THRESHOLD`,
/// `M_TRIM_THRESHOLD`. To others it is a block like any.
fn set_heap_thresholds() {
    static FREED: Once = Once::new();
    FREED.call_once(|| drop(std::hint::black_box(Vec::<u8>::with_capacity(HEAP_BLOCK_SIZE))));
}

/// Results of `work` for each of `jobs`, in their order, on up to `threads` threads, this one among
/// them. Each thread has a workspace to work in, where it finds what it has left there. `done` is
/// called with how many are finished, from any of them.
pub fn in_parallel<S: Default, J: Sync, R: Send>(
    threads: usize,
    jobs: &[J],
    work: &(dyn Fn(&mut S, &J) -> R + Sync),
    done: &(dyn Fn(usize) + Sync),
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::with_capacity(jobs.len()));
    let hand = || {
        let mut room = S::default();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(index) else { break };
            let result = work(&mut room, job);
            if let Ok(mut results) = results.lock() {
                results.push((index, result));
                done(results.len());
            }
        }
    };
    set_heap_thresholds();
    std::thread::scope(|scope| {
        for _ in 1..threads.min(jobs.len()) {
            scope.spawn(hand);
        }
        hand();
    });
    // A thread that panics takes the scope with it.
    let mut results = results.into_inner().unwrap_or_default();
    results.sort_unstable_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}
