//! Where a force turns, and where it reaches a level, within one step.

/// A secant that moves a maximum by less than this share of the way between two looks leaves it so
/// much nearer that the force is the highest to the last bits, for that goes by the square (1).
const SECANT_TOLERANCE: f64 = 1e-4;
/// Secants that are tried: each has about as many more digits right as the one before, or none
/// will.
const MAX_SECANTS: usize = 4;

/// Whether a force that rises at two looks, on average at `mean`, may fall in between (N/s): its
/// cubic's rate is `first + 2 (3 mean - 2 first - second) t + 3 (first + second - 2 mean) t^2`, and
/// where its least value is below the share `doubtful` (1) of both rates, the force's own may be
/// below zero.
pub fn may_decrease((first, second): (f64, f64), mean: f64, doubtful: f64) -> bool {
    let bend = 3.0 * (first + second - 2.0 * mean);
    let turn = 2.0 * first + second - 3.0 * mean;
    let least = first - turn * turn / bend;
    bend > 0.0 && turn > 0.0 && turn < bend && least < doubtful * first.min(second)
}

/// Upper bound of a force between two samples where it bends the other way at most once in between,
/// from its values and what its rates of change would come to from one look to the other: where it
/// is concave it is below its tangent at the end that is concave, and where it is convex below the
/// larger of that part's ends (N).
pub fn highest([first, last]: [f64; 2], [rise, slope]: [f64; 2]) -> f64 {
    (first + rise.max(0.0)).max(last - slope.min(0.0))
}

/// A place between `low` and `high` where `rate`, which is `at_low` and `at_high` there, is below
/// zero, if there is one: its least value, found by golden sections (J. Kiefer, Proc. Am. Math.
/// Soc. 4, 502, 1953), until both ends are below twice the least so far: of parabolas and corners,
/// of which one side may be ten times as steep as the other, it is then not less than two fifths of
/// that (1).
pub fn find_negative(
    rate: &dyn Fn(f64) -> f64,
    [mut low, mut high]: [f64; 2],
    [mut at_low, mut at_high]: [f64; 2],
) -> Option<f64> {
    let section = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (high - section * (high - low), low + section * (high - low));
    let (mut at_left, mut at_right) = (rate(left), rate(right));
    for _ in 0..40 {
        let least = at_left.min(at_right);
        if least < 0.0 {
            return Some(if at_left < at_right { left } else { right });
        }
        if at_low.max(at_high) < 2.0 * least {
            return None;
        }
        if at_left < at_right {
            (high, at_high) = (right, at_right);
            (right, at_right) = (left, at_left);
            left = high - section * (high - low);
            at_left = rate(left);
        } else {
            (low, at_low) = (left, at_left);
            (left, at_left) = (right, at_right);
            right = low + section * (high - low);
            at_right = rate(right);
        }
    }
    None
}

/// Where a force is highest that rises at `low` and falls at `high`, by its rates of change there,
/// `first` and `second`, and its `mean` one (N/s): the turn of its cubic, and a few secants from
/// there. The force there is the highest to the last bits; none where that is not certain (1).
pub fn refine_maximum(
    rate: &dyn Fn(f64) -> f64,
    [low, high]: [f64; 2],
    [first, second]: [f64; 2],
    mean: f64,
) -> Option<f64> {
    let bend = 3.0 * (first + second - 2.0 * mean);
    let turn = 2.0 * (3.0 * mean - 2.0 * first - second);
    let steepness = (turn * turn - 4.0 * bend * first).sqrt();
    let place = |share: f64| low + share * (high - low);
    let mut before = 2.0 * first / (steepness - turn);
    let mut at_before = rate(place(before));
    let mut fall = -steepness;
    let mut next = before - at_before / fall;
    for _ in 0..MAX_SECANTS {
        if !(0.0..=1.0).contains(&next) {
            return None;
        }
        let at_next = rate(place(next));
        let step = next - before;
        // The first guess may have been the crest.
        if step.abs() > 0.0 {
            fall = (at_next - at_before) / step;
        }
        let crest = next - at_next / fall;
        if fall < 0.0 && (crest - next).abs() <= SECANT_TOLERANCE && (0.0..=1.0).contains(&crest) {
            return Some(place(crest));
        }
        (before, at_before, next) = (next, at_next, crest);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{find_negative, highest, may_decrease, refine_maximum};
    use std::cell::Cell;

    /// A force that rises at both ends, `f = t - 4.5 t^2 + 5.8 t^3`: its rate is below zero from
    /// 0.162 to 0.356, and at neither end.
    #[test]
    fn a_fall_between_two_rising_ends_is_found() {
        let rate = |t: f64| 1.0 - 9.0 * t + 17.4 * t * t;
        let force = |t: f64| t * (1.0 + t * (-4.5 + t * 5.8));
        assert!(may_decrease((rate(0.0), rate(1.0)), force(1.0) - force(0.0), 0.3));
        let place = find_negative(&rate, [0.0, 1.0], [rate(0.0), rate(1.0)]).expect("a fall");
        assert!(rate(place) < 0.0, "{place}");
    }

    /// A maximum wherever it is between two looks, to the last bits of the force: by two rates
    /// where looks are a fifteenth of an oscillation apart, by two or three more where they are a
    /// quarter.
    #[test]
    fn the_force_at_a_crest_is_the_highest() {
        let (mut worst, mut found) = (0.0_f64, 0);
        for width in [0.01, 0.1, 0.2, 0.4, 0.8, 1.5] {
            for share in [0.001, 0.1, 0.3, 0.5, 0.77, 0.99] {
                let angle = |t: f64| width * (t - share);
                let force = |t: f64| angle(t).cos() + 0.1 * (2.0 * angle(t)).cos();
                let rate = |t: f64| -width * (angle(t).sin() + 0.2 * (2.0 * angle(t)).sin());
                let count = Cell::new(0);
                let counted = |t: f64| {
                    count.set(count.get() + 1);
                    rate(t)
                };
                let mean = force(1.0) - force(0.0);
                let place = refine_maximum(&counted, [0.0, 1.0], [rate(0.0), rate(1.0)], mean);
                assert!(place.is_some(), "{width} {share}");
                let most = if width > 0.4 { 5 } else { 2 };
                assert!(count.get() <= most, "{width} {share}: {} rates", count.get());
                found += u32::from(count.get() == 2);
                worst = place.map_or(worst, |place| worst.max(1.1 - force(place)));
            }
        }
        println!("{found} of 36 by two rates, {worst:e} below the highest");
        assert!(worst <= 4.0 * f64::EPSILON);
    }

    /// Rates with a jump, and rates that the cubic knows nothing of.
    #[test]
    fn a_crest_that_is_not_certain_is_none() {
        let jump = |t: f64| if t < 0.7 { 1e-3 } else { -1.0 };
        assert_eq!(refine_maximum(&jump, [0.0, 1.0], [1e-3, -1.0], -0.2993), None);
        let told_wrong = |t: f64| -1e-3 - t;
        assert_eq!(refine_maximum(&told_wrong, [0.0, 1.0], [1e-6, -1.001], -0.5), None);
        assert_eq!(refine_maximum(&|_| f64::NAN, [0.0, 1.0], [1.0, -1.0], 0.0), None);
    }

    #[test]
    fn a_straight_rise_is_none() {
        assert!(!may_decrease((1.0, 1.0), 1.0, 0.3));
        assert!(!may_decrease((1.0, 1.0), 0.9, 0.3));
        assert_eq!(find_negative(&|t| 0.1 + (t - 0.5).powi(2), [0.0, 1.0], [0.35, 0.35]), None);
    }

    /// Parabolas and corners, some far steeper to one side, their least values above and below
    /// zero, anywhere in between: what is missed is not there. Fewer rates tell than the eighty of
    /// all sections, twice each.
    #[test]
    fn a_rate_falls_where_its_least_value_is_below_zero() {
        let (mut most, mut falls) = (0, 0);
        for place in (1..100).map(|i| 0.01 * f64::from(i)) {
            for least in [-0.2, -0.01, -1e-4, 1e-4, 0.01, 0.2] {
                let off = |t: f64| t - place;
                let shapes: [&dyn Fn(f64) -> f64; 4] = [
                    &|t| least + off(t).powi(2),
                    &|t| least + off(t).abs(),
                    &|t| least + off(t).max(-0.1 * off(t)),
                    &|t| least + (0.1 * off(t)).max(-off(t)),
                ];
                for shape in shapes {
                    let count = Cell::new(0);
                    let rate = |t: f64| {
                        count.set(count.get() + 1);
                        shape(t)
                    };
                    let ends = [shape(0.0), shape(1.0)];
                    let found = find_negative(&rate, [0.0, 1.0], ends);
                    assert_eq!(found.is_some(), least < 0.0, "{place} {least}");
                    assert!(found.is_none_or(|t| shape(t) < 0.0), "{place} {least}");
                    falls += u32::from(found.is_some());
                    most = most.max(count.get());
                }
            }
        }
        println!("{falls} falls, {most} rates at most");
        assert!(most <= 25, "{most}");
    }

    /// Cubics bend the other way at most once: by force and rise at both ends, of all signs.
    #[test]
    fn no_cubic_exceeds_what_it_is_said_to_stay_below() {
        let few = [-3.0, -1.0, -0.1, 0.0, 0.1, 0.95, 3.0];
        let mut closest = f64::INFINITY;
        for (first, last) in few.into_iter().flat_map(|a| few.map(|b| (a, b))) {
            for (rise, slope) in few.into_iter().flat_map(|a| few.map(|b| (a, b))) {
                let change = last - first;
                let (square, cube) =
                    (3.0 * change - 2.0 * rise - slope, rise + slope - 2.0 * change);
                let force = |t: f64| first + t * (rise + t * (square + t * cube));
                let top = (0..=100).map(|i| force(0.01 * f64::from(i))).fold(f64::MIN, f64::max);
                let bound = highest([first, last], [rise, slope]);
                assert!(top <= bound + 1e-12, "{first} {rise} {last} {slope}: {top} and {bound}");
                closest = closest.min(bound - top);
            }
        }
        assert!(closest < 1e-12, "{closest}");
    }
}
