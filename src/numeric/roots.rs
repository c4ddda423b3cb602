//! Roots and minima of functions of one number.

/// Root of `f` between `low` and `high`, to the last bits, where it has the signs of `at_low` and
/// `at_high`, which differ, and is about as large: false position, the end that stays counting less
/// each time, and bisection where that does not close in. No shape of `f` can defeat it. N.
/// Anderson, Å. Björck, BIT 13, 253, 1973 (unit).
pub fn root(
    f: &dyn Fn(f64) -> f64,
    [mut low, mut high]: [f64; 2],
    [mut at_low, mut at_high]: [f64; 2],
) -> f64 {
    if at_high == 0.0 {
        return high;
    }
    let mut side = 0_i8;
    for count in 0..120_u8 {
        // Of the step's length, too: if `at_low` comes from the previous step's polynomial, the
        // root may lie at `low`.
        let smallest = f64::EPSILON * high.max(f64::EPSILON);
        if at_low == 0.0 || high - low <= smallest {
            return low;
        }
        let falsi = (low * at_high - high * at_low) / (at_high - at_low);
        // Never nearer to an end than rounding distinguishes, so that the other end follows once
        // one has arrived.
        let falsi = falsi.max(low + smallest).min(high - smallest);
        let inside = falsi > low && falsi < high && count < 60;
        let middle = if inside { falsi } else { 0.5 * (low + high) };
        let value = f(middle);
        // The interval holds no number between its ends any more.
        if value == 0.0 || middle <= low || middle >= high {
            return middle;
        }
        if (value > 0.0) == (at_low > 0.0) {
            at_high *= if side == -1 { shrink_factor(value / at_low) } else { 1.0 };
            (low, at_low, side) = (middle, value, -1);
        } else {
            at_low *= if side == 1 { shrink_factor(value / at_high) } else { 1.0 };
            (high, at_high, side) = (middle, value, 1);
        }
    }
    0.5 * (low + high)
}

/// Factor on an end's value when the other end has moved again, to this share of its value: as if a
/// parabola went through all three, but not so small that the next place would be this very end
/// (1).
fn shrink_factor(share: f64) -> f64 {
    (1.0 - share).max(0.25)
}

/// The top of the parabola through three values at -1, 0 and 1, the middle one no lower than the
/// others: its place (1) and height (unit). None where the three lie on a line or open upward.
pub fn vertex([before, here, after]: [f64; 3]) -> Option<(f64, f64)> {
    let curvature = before - 2.0 * here + after;
    let place = 0.5 * (before - after) / curvature;
    let is_top = curvature < 0.0 && place.is_finite();
    is_top.then_some((place, here - 0.25 * (before - after) * place))
}

/// The minimum of `cost` between two places, to a width of `step`, by golden sections: J. Kiefer,
/// Proc. Amer. Math. Soc. 4, 502 (1953) (unit).
///
/// # Errors
/// Those of `cost`.
pub fn golden_section<E>(
    [mut low, mut high]: [f64; 2],
    step: f64,
    cost: &mut dyn FnMut(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    let mut inner = [high - share * (high - low), low + share * (high - low)];
    let mut costs = [cost(inner[0])?, cost(inner[1])?];
    while high - low > step {
        if costs[0] < costs[1] {
            high = inner[1];
            inner = [high - share * (high - low), inner[0]];
            costs = [cost(inner[0])?, costs[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + share * (high - low)];
            costs = [costs[1], cost(inner[1])?];
        }
    }
    Ok(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::{golden_section, root};
    use std::cell::Cell;

    /// Roots that are known, of shapes from straight to a jump; and what smooth ones cost.
    #[test]
    fn roots_are_found_to_the_last_bits() {
        type Shape = (&'static str, fn(f64) -> f64, f64, u32);
        let shapes: [Shape; 7] = [
            ("line", |t| 0.3 - t, 0.3, 3),
            ("cosine", |t| (4.0 * t).cos(), 0.125 * std::f64::consts::PI, 8),
            ("falling exponential", |t| (-40.0 * t).exp() - (-12.0_f64).exp(), 0.3, 30),
            ("triple", |t| (0.4 - t).powi(3), 0.4, 108),
            ("jump", |t| if t < 0.7 { 1e-3 } else { -1e9 }, 0.7, 112),
            ("at the start", |t| -t, 0.0, 0),
            ("at the end", |t| 1.0 - t, 1.0, 0),
        ];
        for (name, shape, expected, most) in shapes {
            let count = Cell::new(0);
            let counted = |t: f64| {
                count.set(count.get() + 1);
                shape(t)
            };
            let found = root(&counted, [0.0, 1.0], [shape(0.0), shape(1.0)]);
            assert!((found - expected).abs() <= 4e-16, "{name}: {found:e} for {expected:e}");
            println!("{name}: {} evaluations", count.get());
            assert!(count.get() <= most, "{name}: {} evaluations", count.get());
        }
    }

    /// The rate at the start of a step is that of the end of the one before, whose polynomial may
    /// disagree.
    #[test]
    fn a_start_that_was_told_wrong_is_the_root() {
        let count = Cell::new(0);
        let rate = |t: f64| {
            count.set(count.get() + 1);
            -1e-3 - t
        };
        let found = root(&rate, [0.0, 1.0], [1e-6, rate(1.0)]);
        println!("{} evaluations", count.get());
        assert!(found < 1e-15 && count.get() < 40, "{found:e} after {}", count.get());
    }

    #[test]
    fn a_minimum_is_found_to_the_step() {
        let cost = |x: f64| Ok::<f64, ()>((x - 0.3).powi(2));
        let found = golden_section([0.0, 1.0], 1e-5, &mut { cost }).expect("a minimum");
        assert!((found - 0.3).abs() < 1e-5, "{found}");
    }
}
