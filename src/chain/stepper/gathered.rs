//! Contacts of several rows that change sides, side by side: what is asked of eight costs no more than of one.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
#![allow(
    clippy::needless_range_loop,
    reason = "closures would be compiled without the instruction set"
)]

use super::known::Known;
use super::lanes::{Lanes, WIDTH};
use super::quintics::{Ends, Missing, missing};
use super::workspace::Between;

/// Contacts not yet asked about, fewer than eight, and how many eights have been.
pub struct Gathered<L: Lanes> {
    ends: Ends<L>,
    /// Where they stand, a bit each: in the first places, unless they are those of a row.
    wanted: u8,
    eights: usize,
}

/// The first `count` places.
#[inline(always)]
#[allow(clippy::cast_possible_truncation, reason = "eight lanes")]
fn up_to(count: usize) -> u8 {
    ((1_u32 << count) - 1) as u8
}

/// `bits` without the first `count` that are set.
#[inline(always)]
fn behind(mut bits: u8, count: usize) -> u8 {
    for _ in 0..count {
        bits &= bits.wrapping_sub(1);
    }
    bits
}

impl<L: Lanes> Gathered<L> {
    /// None so far.
    #[inline(always)]
    pub fn new() -> Self {
        Self { ends: [[L::splat(0.0); 3]; 2], wanted: 0, eights: 0 }
    }

    /// Contacts of `bits` of a row, where they stand there: there are no others.
    #[inline(always)]
    pub fn set(&mut self, (bits, ends): (u8, Ends<L>)) {
        (self.ends, self.wanted) = (ends, bits);
    }

    /// Adds a row's contacts of `bits`; what is missing of the eights that are full goes into `found`.
    #[inline(always)]
    pub fn add<P: Known<N>, const N: usize>(
        &mut self,
        (bits, ends): (u8, Ends<L>),
        found: &mut [Between],
    ) {
        let before = self.wanted.count_ones() as usize;
        let after = before + bits.count_ones() as usize;
        for end in 0..2 {
            for value in 0..3 {
                let all = &mut self.ends[end][value];
                *all = L::gather(bits, ends[end][value], (*all, before));
            }
        }
        self.wanted = up_to(after.min(WIDTH));
        if after < WIDTH {
            return;
        }
        self.finish::<P, N>(found);
        let rest = behind(bits, WIDTH - before);
        for end in 0..2 {
            for value in 0..3 {
                self.ends[end][value] = L::gather(rest, ends[end][value], (L::splat(0.0), 0));
            }
        }
        self.wanted = up_to(after - WIDTH);
    }

    /// Finds what is missing of the contacts that are left.
    #[inline(always)]
    pub fn finish<P: Known<N>, const N: usize>(&mut self, found: &mut [Between]) {
        if self.wanted == 0 {
            return;
        }
        let Missing { impulse, moment, errors, uncertainty } =
            missing::<L, P, N>(self.ends, self.wanted);
        let found = &mut found[self.eights];
        L::store(impulse, &mut found[0]);
        L::store(moment, &mut found[1]);
        L::store(errors[0], &mut found[2]);
        L::store(errors[1], &mut found[3]);
        L::store(uncertainty, &mut found[4]);
        self.eights += 1;
        self.wanted = 0;
    }
}

/// What `found` says of the contacts of a row that were there alone.
#[inline(always)]
pub fn alone<L: Lanes>(found: &Between) -> Missing<L> {
    let mut values = [L::splat(0.0); 5];
    for which in 0..5 {
        values[which] = L::load(&found[which]);
    }
    missing_in::<L>(values)
}

#[inline(always)]
fn missing_in<L: Lanes>(values: [L::V; 5]) -> Missing<L> {
    let [impulse, moment, velocity, position, uncertainty] = values;
    Missing { impulse, moment, errors: [velocity, position], uncertainty }
}

/// What `found` says of a row's contacts of `bits`, before which `count` were added; nothing is missing at the row's others.
#[inline(always)]
pub fn spread<L: Lanes>(found: &[Between], count: usize, bits: u8) -> Missing<L> {
    let (eight, at) = (count / WIDTH, count % WIDTH);
    let mut values = [L::splat(0.0); 5];
    for which in 0..5 {
        let found = L::load(&found[eight][which]);
        values[which] = L::scatter(bits, (found, at), values[which]);
    }
    if at + bits.count_ones() as usize > WIDTH {
        let rest = behind(bits, WIDTH - at);
        for which in 0..5 {
            let found = L::load(&found[eight + 1][which]);
            values[which] = L::scatter(rest, (found, 0), values[which]);
        }
    }
    missing_in::<L>(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::stepper::known::Pair64;
    use crate::chain::stepper::lanes::Baseline;

    /// Three rows with 3, 6 and 8 of their contacts: what is found of each must be what is found of it alone.
    #[test]
    fn contacts_side_by_side_are_as_alone() {
        let row = |shift: f64| -> Ends<Baseline> {
            let of = |scale: f64, slope: f64| {
                [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0].map(|lane| scale + slope * (lane + shift))
            };
            [
                [of(-0.2, -0.01), of(0.9, 0.03), of(0.1, 0.05)],
                [of(0.8, 0.02), of(1.0, 0.07), of(0.2, -0.03)],
            ]
        };
        let rows = [(0b0101_1000, row(0.0)), (0b1110_0111, row(0.3)), (u8::MAX, row(0.6))];
        let mut found = [Between::default(); 3];
        let mut gathered = Gathered::<Baseline>::new();
        for (bits, ends) in rows {
            gathered.add::<Pair64, 6>((bits, ends), &mut found);
        }
        gathered.finish::<Pair64, 6>(&mut found);
        let mut count = 0;
        for (bits, ends) in rows {
            let together = spread::<Baseline>(&found, count, bits);
            let mut one = Gathered::<Baseline>::new();
            one.set((bits, ends));
            let mut found = [Between::default()];
            one.finish::<Pair64, 6>(&mut found);
            let alone = alone::<Baseline>(&found[0]);
            assert!(alone.impulse.iter().any(|missing| missing.abs() > 1e-6));
            let values = |m: Missing<Baseline>| {
                [m.impulse, m.moment, m.errors[0], m.errors[1], m.uncertainty]
            };
            assert_eq!(values(together), values(alone));
            count += bits.count_ones() as usize;
        }
    }
}
