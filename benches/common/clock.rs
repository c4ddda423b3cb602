//! CPU time of this process, and medians.

use rustix::time::{ClockId, clock_gettime};

/// CPU time so far (s).
pub fn cpu_time() -> f64 {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    #[allow(clippy::cast_precision_loss, reason = "seconds of a bench, to the nanosecond")]
    let (whole, rest) = (now.tv_sec as f64, now.tv_nsec as f64);
    whole + 1e-9 * rest
}

/// CPU time of one call of `work`, repeated for about `budget` (s) (s).
pub fn time(budget: f64, mut work: impl FnMut()) -> f64 {
    let start = cpu_time();
    let mut calls = 0.0;
    loop {
        work();
        calls += 1.0;
        let spent = cpu_time() - start;
        if spent >= budget {
            return spent / calls;
        }
    }
}

/// The middle value.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
