//! CPU time of this process, and medians.

use rustix::time::{ClockId, clock_gettime};

/// CPU time so far (s).
pub fn cpu_time() -> f64 {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    let (whole, rest) = (now.tv_sec as f64, now.tv_nsec as f64);
    whole + 1e-9 * rest
}

/// CPU time of one call of `work`, repeated for about `budget` (s) (s). The clock is read after 1,
/// 2, 4, ... further calls: reading it takes longer than a thousand square roots.
pub fn time(budget: f64, mut work: impl FnMut()) -> f64 {
    let mut calls = 1_u32;
    loop {
        let start = cpu_time();
        for _ in 0..calls {
            work();
        }
        let spent = cpu_time() - start;
        if spent >= 0.5 * budget || calls > u32::MAX / 2 {
            return spent / f64::from(calls);
        }
        calls *= 2;
    }
}

/// The middle value.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
