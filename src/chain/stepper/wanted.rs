//! Which of eight steps may hold a maximum or a level that somebody asks for, by force and rate of change at their ends.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::{Lanes, Row, WIDTH};

/// A force that rises from zero has no maximum within a step that exceeds the larger of its ends by more than this factor: half a step from it,
/// it is still `cos(4 pi/15)^1.5 = 0.55` of it, or the step would not have been accepted (1).
const WITHIN_STEP: f64 = 2.0;
/// Where a force rises or falls at both ends of a step and the least rate of their cubic is below this share of both, it may turn in between (1).
const DOUBTFUL: f64 = 0.6;

/// What is asked of the steps of eight lanes.
#[derive(Debug, Clone)]
pub struct Asked {
    /// A maximum counts above this (N).
    maximum: Row,
    /// Any force does above this (N).
    level: Row,
}

impl Default for Asked {
    /// Nothing, of any lane.
    fn default() -> Self {
        Self { maximum: Row([f64::INFINITY; WIDTH]), level: Row([f64::INFINITY; WIDTH]) }
    }
}

impl Asked {
    /// Asks lane `lane` for maxima above the first and any forces above the second (N).
    pub fn ask(&mut self, lane: usize, [maximum, level]: [f64; 2]) {
        (self.maximum.0[lane], self.level.0[lane]) = (maximum, level);
    }

    /// Steps of `length` (s) that may hold it, where force (N) and rate of change (N/s) are `before` and at the `end`, a bit each.
    ///
    /// A force that bends the other way at most once in a step is below its tangents at both ends: below the one where it is concave there, and
    /// where it is convex below the larger of that part's ends. A maximum of one that falls at the start and rises at the end is not looked for:
    /// it would have turned three times.
    #[inline(always)]
    pub fn wanted<L: Lanes>(&self, before: [L::V; 2], end: [L::V; 2], length: L::V) -> u8 {
        let none = L::splat(0.0);
        let [first, last] = [before[0], end[0]];
        let [climb, slope] = [L::mul(before[1], length), L::mul(end[1], length)];
        let (rose, rises) = (L::positive(climb), L::positive(slope));
        let change = L::sub(last, first);

        let top = L::add(first, L::max(climb, none));
        let highest = L::max(top, L::sub(last, L::min(slope, none)));
        let likely = L::mul(L::splat(WITHIN_STEP), L::max(first, last));
        let counts = L::positive(L::sub(L::max(highest, likely), L::load(&self.maximum)));
        // Once the highest have been seen, mostly.
        if counts == 0 {
            return 0;
        }
        let exceeds = L::positive(L::sub(last, L::load(&self.level)));

        // As `experiment::turn::may_fall` has it; falling twice is rising twice, upside down.
        let mean = L::select(rises, change, L::sub(none, change));
        let (start, end) = (L::abs(climb), L::abs(slope));
        let three = L::splat(3.0);
        let both = L::add(start, end);
        let bend = L::mul(three, L::sub(both, L::add(mean, mean)));
        let turn = L::sub(L::add(start, both), L::mul(three, mean));
        let spare = L::sub(start, L::mul(L::splat(DOUBTFUL), L::min(start, end)));
        let turns = L::positive(bend)
            & L::positive(turn)
            & L::positive(L::sub(bend, turn))
            & L::positive(L::sub(L::mul(turn, turn), L::mul(spare, bend)));
        counts & (exceeds | rose & !rises | !(rose ^ rises) & turns)
    }
}

#[cfg(test)]
mod tests {
    use super::Asked;
    use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
    use crate::chain::stepper::lanes::{Lanes, Row, Task, WIDTH};

    /// Forces that are cubics in each lane's step, by force and rise at the start and at the end.
    #[derive(Clone)]
    struct Cubics {
        asked: Asked,
        before: [Row; 2],
        end: [Row; 2],
    }

    impl Task for &Cubics {
        type Output = u8;

        fn run<L: Lanes>(self) -> u8 {
            let load = |rows: &[Row; 2]| rows.each_ref().map(|row| L::load(row));
            self.asked.wanted::<L>(load(&self.before), load(&self.end), L::splat(1.0))
        }
    }

    impl Cubics {
        fn nothing() -> Self {
            Self { asked: Asked::default(), before: Default::default(), end: Default::default() }
        }

        fn put(&mut self, lane: usize, [first, climb, last, slope]: [f64; 4]) {
            (self.before[0].0[lane], self.before[1].0[lane]) = (first, climb);
            (self.end[0].0[lane], self.end[1].0[lane]) = (last, slope);
        }

        /// The same bits by all instructions of this machine.
        fn wanted(&self) -> u8 {
            let sets = InstructionSet::available();
            let bits: Vec<u8> = sets.into_iter().map(|set| dispatch(set, self)).collect();
            assert!(bits.iter().all(|other| *other == bits[0]), "{bits:?}");
            bits[0]
        }
    }

    /// The highest inner maximum of the cubic, by its rate's roots.
    fn top([first, climb, last, slope]: [f64; 4]) -> Option<f64> {
        let change = last - first;
        let (square, cube) = (3.0 * change - 2.0 * climb - slope, climb + slope - 2.0 * change);
        let force = |t: f64| first + t * (climb + t * (square + t * cube));
        let spread = (square * square - 3.0 * cube * climb).sqrt();
        // Where the rate falls through zero, by whichever form does not cancel.
        let place = if square <= 0.0 {
            climb / (spread - square)
        } else {
            -(square + spread) / (3.0 * cube)
        };
        (spread > 0.0 && place > 0.0 && place < 1.0).then(|| force(place))
    }

    /// Whatever the signs of forces and rates, zero among them, a maximum or an end that is asked for is never overlooked.
    #[test]
    fn whatever_is_asked_for_is_wanted() {
        let mut bits = 0x9E37_79B9_7F4A_7C15_u64;
        let mut random = || {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            f64::from((bits >> 33) as u32) / f64::from(1_u32 << 30) - 1.0
        };
        let mut sized =
            || if random() > 0.8 { 0.0 } else { random() * 10.0_f64.powf(3.0 * random()) };
        let (mut maxima, mut ends, mut spared) = (0, 0, 0);
        for _ in 0..50_000 {
            let mut cubics = Cubics::nothing();
            let steps: [[f64; 6]; WIDTH] =
                std::array::from_fn(|_| std::array::from_fn(|_| sized()));
            for (lane, [a, b, c, d, maximum, level]) in steps.into_iter().enumerate() {
                cubics.put(lane, [a, b, c, d]);
                cubics.asked.ask(lane, [maximum, level]);
            }
            let wanted = cubics.wanted();
            for (lane, [a, b, c, d, maximum, level]) in steps.into_iter().enumerate() {
                let wants = wanted & (1 << lane) != 0;
                let rounding = 1e-12 * (a.abs() + b.abs() + c.abs() + d.abs());
                let counts = |top: f64| top > maximum + rounding;
                let maximum_counts = top([a, b, c, d]).is_some_and(counts);
                let end_counts = c > level.max(maximum);
                assert!(wants || !maximum_counts, "{a} {b} {c} {d} above {maximum}");
                assert!(wants || !end_counts, "{c} above {level} and {maximum}");
                maxima += u32::from(maximum_counts);
                ends += u32::from(end_counts);
                spared += u32::from(!wants);
            }
        }
        println!("{maxima} maxima, {ends} ends, {spared} steps wanted by nobody");
        assert!(maxima > 10_000 && ends > 10_000 && spared > 10_000);
    }

    /// A peak between forces of the other sign, where the step begins convex: the tangents at both ends cross below it.
    #[test]
    fn a_step_that_begins_convex_is_wanted() {
        let step = [-1.0, 0.95, -0.1, -3.0];
        assert!(top(step).is_some_and(|top| top > 0.2));
        let mut cubics = Cubics::nothing();
        cubics.put(3, step);
        cubics.asked.ask(3, [0.0, 1.0]);
        assert_eq!(cubics.wanted(), 1 << 3);
    }

    #[test]
    fn nothing_is_wanted_where_nothing_is_asked() {
        for odd in [0.0, 1.0, -1.0, f64::MAX, f64::INFINITY, f64::NAN] {
            for place in 0..4 {
                let mut cubics = Cubics::nothing();
                let mut step = [1.0, 2.0, 1.0, -2.0];
                step[place] = odd;
                (0..WIDTH).for_each(|lane| cubics.put(lane, step));
                assert_eq!(cubics.wanted(), 0, "{step:?}");
            }
        }
    }
}
