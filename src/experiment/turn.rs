//! Where a force turns, and where it reaches a level, within one step.

/// Whether a force that rises at two looks, on average at `mean`, may fall in between (N/s): its cubic's rate is
/// `first + 2 (3 mean - 2 first - second) t + 3 (first + second - 2 mean) t^2`, and where its least value is below the share `doubtful` (1)
/// of both rates, the force's own may be below zero.
pub fn may_fall((first, second): (f64, f64), mean: f64, doubtful: f64) -> bool {
    let bend = 3.0 * (first + second - 2.0 * mean);
    let turn = 2.0 * first + second - 3.0 * mean;
    let least = first - turn * turn / bend;
    bend > 0.0 && turn > 0.0 && turn < bend && least < doubtful * first.min(second)
}

/// A place between `low` and `high` where `rate` is below zero, if there is one: its least value, found by golden sections (J. Kiefer,
/// Proc. Am. Math. Soc. 4, 502, 1953) (1).
pub fn fall(rate: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> Option<f64> {
    let section = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..40 {
        let [left, right] = [high - section * (high - low), low + section * (high - low)];
        let [at_left, at_right] = [left, right].map(rate);
        if at_left.min(at_right) < 0.0 {
            return Some(if at_left < at_right { left } else { right });
        }
        if at_left < at_right {
            high = right;
        } else {
            low = left;
        }
    }
    None
}

/// Root of `f` between `low` and `high`, to the last bits: false position, the end that stays counting half each time, and bisection
/// where that does not close in. No shape of `f` can defeat it. M. Dowell, P. Jarratt, BIT 11, 168, 1971, "Illinois" (unit).
pub fn root(f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let (mut at_low, mut at_high) = (f(low), f(high));
    let mut side = 0_i8;
    for count in 0..120_u8 {
        if at_low == 0.0 || high - low <= f64::EPSILON * high {
            return low;
        }
        let falsi = (low * at_high - high * at_low) / (at_high - at_low);
        let inside = falsi > low && falsi < high && count < 60;
        let middle = if inside { falsi } else { 0.5 * (low + high) };
        let value = f(middle);
        // The interval holds no number between its ends any more.
        if value == 0.0 || middle <= low || middle >= high {
            return middle;
        }
        if (value > 0.0) == (at_low > 0.0) {
            (low, at_low) = (middle, value);
            at_high *= if side == -1 { 0.5 } else { 1.0 };
            side = -1;
        } else {
            (high, at_high) = (middle, value);
            at_low *= if side == 1 { 0.5 } else { 1.0 };
            side = 1;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::{fall, may_fall};

    /// A force that rises at both ends, `f = t - 4.5 t^2 + 5.8 t^3`: its rate is below zero from 0.162 to 0.356, and at neither end.
    #[test]
    fn a_fall_between_two_rising_ends_is_found() {
        let rate = |t: f64| 1.0 - 9.0 * t + 17.4 * t * t;
        let force = |t: f64| t * (1.0 + t * (-4.5 + t * 5.8));
        assert!(may_fall((rate(0.0), rate(1.0)), force(1.0) - force(0.0), 0.3));
        let place = fall(&rate, 0.0, 1.0).expect("a fall");
        assert!(rate(place) < 0.0, "{place}");
    }

    #[test]
    fn a_straight_rise_is_none() {
        assert!(!may_fall((1.0, 1.0), 1.0, 0.3));
        assert!(!may_fall((1.0, 1.0), 0.9, 0.3));
        assert_eq!(fall(&|t| 0.1 + (t - 0.5).powi(2), 0.0, 1.0), None);
    }
}
