//! Which of the contacts that change sides in a step are worth a correction.
//!
//! With a speed `w` across zero overlap, a step of `h` misses at most `0.0062 A h (h w)^1.5` of the impulse, wherever in the step
//! that is, and half as much of its moment over `h`.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::Lanes;
use super::layout::Layout;
use super::tried::Tried;

/// What either pair's nodes miss of `max(t - root, 0)^1.5` at most (1).
const MISSED: f64 = 0.0062;
/// A kink whose missed impulse is below so many negligible ones, 0.3 of what a step may be off, is left alone (1).
const LEFT_ALONE: f64 = 30.0;

/// What can be seen of a step's kinks.
pub struct Visible<L: Lanes> {
    step: L::V,
    /// Square of the impulse that may be missed (N² s²).
    limit: L::V,
}

impl<L: Lanes> Visible<L> {
    /// Of steps of `step` (s), given what is negligible (N s, N s²).
    #[inline(always)]
    #[must_use]
    pub fn new(step: L::V, slack: [L::V; 2]) -> Self {
        let moment = L::div(slack[1], L::max(step, L::splat(f64::MIN_POSITIVE)));
        let limit = L::mul(L::splat(LEFT_ALONE / MISSED), L::min(slack[0], moment));
        Self { step, limit: L::mul(limit, limit) }
    }

    /// Bits of the contacts in row `row` whose kink may be seen: those that change sides fast enough.
    #[inline(always)]
    #[must_use]
    pub fn among<Y: Layout>(&self, tried: &Tried<L>, row: usize) -> u8 {
        let travel = L::mul(self.step, tried.speed::<Y>(row));
        let whole = L::mul(self.step, L::load(&tried.plan.stiffness[row]));
        let cube = L::mul(travel, L::mul(travel, travel));
        L::positive(L::sub(L::mul(cube, L::mul(whole, whole)), self.limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::dormand_el_mikkawy_prince_64::DORMAND_EL_MIKKAWY_PRINCE_64;
    use crate::integrate::dormand_el_mikkawy_prince_86::DORMAND_EL_MIKKAWY_PRINCE_86;
    use crate::integrate::nystrom::NystromPair;
    use crate::integrate::stages::Row as Terms;

    /// Largest difference between the integral of `max(t - root, 0)^1.5`, or its mirror image, and what the weights `terms` make of it.
    fn missed(pair: &NystromPair, terms: Terms, exact: impl Fn(f64, bool) -> f64) -> f64 {
        let of = |root: f64, closes: bool| {
            let closed = |t: f64| if closes { t - root } else { root - t }.max(0.0);
            let sum: f64 = terms.iter().map(|(i, w)| w * closed(pair.nodes[*i]).powf(1.5)).sum();
            (exact(root, closes) - sum).abs()
        };
        let roots = (0..=1000).map(|i| f64::from(i) / 1000.0);
        roots.flat_map(|root| [of(root, false), of(root, true)]).fold(0.0, f64::max)
    }

    #[test]
    fn no_kink_is_missed_by_more_than_stated() {
        let impulse = |root: f64, closes: bool| {
            let length = if closes { 1.0 - root } else { root };
            length.powf(2.5) / 2.5
        };
        // `int (1 - t) max(t - root, 0)^1.5`, by parts.
        let moment = |root: f64, closes: bool| {
            let length = if closes { 1.0 - root } else { root };
            let last = length.powf(3.5) / 3.5;
            if closes {
                length.powf(3.5) / 2.5 - last
            } else {
                (1.0 - root) * length.powf(2.5) / 2.5 + last
            }
        };
        let mut worst: f64 = 0.0;
        for pair in [&DORMAND_EL_MIKKAWY_PRINCE_64, &DORMAND_EL_MIKKAWY_PRINCE_86] {
            let velocity = missed(pair, pair.velocity, impulse);
            let position = missed(pair, pair.position, moment);
            println!("{}: {velocity:.5}, {position:.5}", pair.name);
            assert!(position <= 0.51 * MISSED.max(velocity));
            worst = worst.max(velocity);
        }
        assert!(worst <= MISSED && worst > 0.98 * MISSED, "{worst}");
    }
}
