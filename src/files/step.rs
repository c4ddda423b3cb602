//! Ends the program at one of its writes, for tests: `HERTZSCOPE_TEST_ABORT_AT=N` aborts before the
//! N-th one, without any cleaning up.

/// Marks a place where a write, a creation or a renaming is about to happen.
#[cfg(debug_assertions)]
pub(super) fn step() {
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicU64, Ordering};

    static LAST: OnceLock<Option<u64>> = OnceLock::new();
    static STEPS: AtomicU64 = AtomicU64::new(0);
    let last = LAST.get_or_init(|| std::env::var("HERTZSCOPE_TEST_ABORT_AT").ok()?.parse().ok());
    if let Some(last) = last
        && STEPS.fetch_add(1, Ordering::Relaxed) + 1 == *last
    {
        std::process::abort();
    }
}

/// Marks a place where a write, a creation or a renaming is about to happen.
#[cfg(not(debug_assertions))]
pub(super) fn step() {}
