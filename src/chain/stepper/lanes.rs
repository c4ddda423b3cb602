//! Eight doubles at a time, whatever the machine: one register with AVX-512, two with AVX2, four with the x86-64 baseline.
//!
//! Everything here is inlined into functions compiled for an instruction set; [`mod@super::dispatch`] asks the machine before it
//! calls them.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

/// Doubles in a row.
pub const WIDTH: usize = 8;

/// Eight values side by side, aligned to a cache line (unit).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C, align(64))]
pub struct Row(pub [f64; WIDTH]);

/// Something to be compiled for every instruction set.
pub trait Task {
    /// What comes of it.
    type Output;

    /// Does it; inlined into a function compiled for the instructions of `L`.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Arithmetic on eight doubles.
pub trait Lanes: Copy {
    /// Eight doubles.
    type V: Copy;
    /// Rows of a sweep that are begun ahead: as many as there are registers for.
    const AHEAD: usize = 2;
    /// Whether the eight are so quick that short chains wait for results and not for arithmetic.
    const WAITS: bool = false;
    /// Whether [`Lanes::weigh_root`] leaves the square-root unit alone.
    const IS_BESIDE: bool = false;
    /// Runs `task` in a function of its own, compiled for these instructions.
    #[inline(never)]
    fn apart<T: Task>(task: T) -> T::Output {
        task.run::<Self>()
    }
    /// From memory.
    fn load(row: &Row) -> Self::V;
    /// To memory.
    fn store(value: Self::V, row: &mut Row);
    /// Eight times the same.
    fn splat(value: f64) -> Self::V;
    /// `a + b`
    fn add(a: Self::V, b: Self::V) -> Self::V;
    /// `a - b`
    fn sub(a: Self::V, b: Self::V) -> Self::V;
    /// `a b`
    fn mul(a: Self::V, b: Self::V) -> Self::V;
    /// `a / b`
    fn div(a: Self::V, b: Self::V) -> Self::V;
    /// `a b + c`, rounded once where the machine can.
    fn mul_add(a: Self::V, b: Self::V, c: Self::V) -> Self::V;
    /// The larger; `b` where one is not a number.
    fn max(a: Self::V, b: Self::V) -> Self::V;
    /// The smaller; `b` where one is not a number.
    fn min(a: Self::V, b: Self::V) -> Self::V;
    /// `|a|`
    fn abs(a: Self::V) -> Self::V;
    /// Square root.
    fn sqrt(a: Self::V) -> Self::V;
    /// What [`Lanes::weigh_root`] starts from: 14 bits of `1/sqrt(a)` where the machine has them, for `a >= 1e-200`.
    #[inline(always)]
    fn start_root(a: Self::V) -> Self::V {
        Self::sqrt(a)
    }
    /// `weight` times the square root of `a` without the square-root unit where the machine can, so that with `a` for a weight it is `a^1.5`
    /// within 2 ulp: Householder's correction of fourth order.
    #[inline(always)]
    fn weigh_root(a: Self::V, start: Self::V, weight: Self::V) -> Self::V {
        let _ = a;
        Self::mul(weight, start)
    }
    /// `[before[7], here[0], ..., here[6]]`
    fn shift_up(before: Self::V, here: Self::V) -> Self::V;
    /// `[here[1], ..., here[7], after[0]]`
    fn shift_down(here: Self::V, after: Self::V) -> Self::V;
    /// Largest of the eight (unit).
    #[inline(always)]
    fn largest(a: Self::V) -> f64 {
        let mut row = Row::default();
        Self::store(a, &mut row);
        row.0.iter().fold(f64::MIN, |most, value| if *value > most { *value } else { most })
    }
    /// The first of the eight (unit).
    fn first(a: Self::V) -> f64;
    /// Sum of the eight, in pairs (unit).
    #[inline(always)]
    fn sum(a: Self::V) -> f64 {
        let mut row = Row::default();
        Self::store(a, &mut row);
        let half = |first: usize| {
            (row.0[first] + row.0[first + 4]) + (row.0[first + 2] + row.0[first + 6])
        };
        half(0) + half(1)
    }
    /// `a b + c` of single numbers, rounded once where the machine can (unit).
    #[inline(always)]
    fn fused(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
    /// Bit `i` tells whether value `i` is a finite number.
    #[inline(always)]
    fn finite(a: Self::V) -> u8 {
        Self::positive(Self::sub(Self::splat(f64::INFINITY), Self::abs(a)))
    }
    /// Bit `i` tells whether value `i` is above zero.
    fn positive(a: Self::V) -> u8;
    /// `a` where the bit is set, `b` elsewhere.
    fn select(bits: u8, a: Self::V, b: Self::V) -> Self::V;
    /// `b` up to place `at`, and from there on those of `a` whose bit is set, as far as there is room; what comes after them differs from
    /// machine to machine.
    #[inline(always)]
    fn gather(bits: u8, a: Self::V, (b, at): (Self::V, usize)) -> Self::V {
        let (mut from, mut to) = (Row::default(), Row::default());
        Self::store(a, &mut from);
        Self::store(b, &mut to);
        for (to, lane) in to.0[at..].iter_mut().zip(set(bits)) {
            *to = from.0[lane];
        }
        Self::load(&to)
    }
    /// `b`, overwritten where the bit is set by the values of `a` from place `at` on, one after the other; what is left where there are none
    /// any more differs from machine to machine.
    #[inline(always)]
    fn scatter(bits: u8, (a, at): (Self::V, usize), b: Self::V) -> Self::V {
        let (mut from, mut to) = (Row::default(), Row::default());
        Self::store(a, &mut from);
        Self::store(b, &mut to);
        for (from, lane) in from.0[at..].iter().zip(set(bits)) {
            to.0[lane] = *from;
        }
        Self::load(&to)
    }
}

/// The places of the bits that are set.
#[inline(always)]
fn set(mut bits: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < WIDTH).then_some(lane)
    })
}

/// Bits of all lanes from number `first` on, of which there may be none.
#[inline(always)]
#[cfg(target_arch = "x86_64")]
pub fn from(first: usize) -> u8 {
    #[allow(clippy::cast_possible_truncation, reason = "what is cut off are lanes beyond the last")]
    let bits = (u32::from(u8::MAX) << first) as u8;
    bits
}

/// Any machine: plain arrays, which the compiler puts into whatever registers there are. x86-64 machines have better.
#[cfg(any(test, not(target_arch = "x86_64")))]
#[derive(Debug, Clone, Copy)]
pub struct Baseline;

#[cfg(any(test, not(target_arch = "x86_64")))]
impl Lanes for Baseline {
    type V = [f64; WIDTH];

    #[inline(always)]
    fn load(row: &Row) -> Self::V {
        row.0
    }

    #[inline(always)]
    fn store(value: Self::V, row: &mut Row) {
        row.0 = value;
    }

    #[inline(always)]
    fn splat(value: f64) -> Self::V {
        [value; WIDTH]
    }

    #[inline(always)]
    fn add(a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| a[i] + b[i])
    }

    #[inline(always)]
    fn sub(a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| a[i] - b[i])
    }

    #[inline(always)]
    fn mul(a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| a[i] * b[i])
    }

    #[inline(always)]
    fn div(a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| a[i] / b[i])
    }

    #[inline(always)]
    fn mul_add(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        std::array::from_fn(|i| a[i] * b[i] + c[i])
    }

    #[inline(always)]
    fn max(a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    fn min(a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    fn abs(a: Self::V) -> Self::V {
        a.map(f64::abs)
    }

    #[inline(always)]
    fn sqrt(a: Self::V) -> Self::V {
        a.map(f64::sqrt)
    }

    #[inline(always)]
    fn shift_up(b: Self::V, h: Self::V) -> Self::V {
        [b[7], h[0], h[1], h[2], h[3], h[4], h[5], h[6]]
    }

    #[inline(always)]
    fn shift_down(h: Self::V, a: Self::V) -> Self::V {
        [h[1], h[2], h[3], h[4], h[5], h[6], h[7], a[0]]
    }

    #[inline(always)]
    fn first(a: Self::V) -> f64 {
        a[0]
    }

    #[inline(always)]
    fn select(bits: u8, a: Self::V, b: Self::V) -> Self::V {
        std::array::from_fn(|i| if bits & (1 << i) == 0 { b[i] } else { a[i] })
    }

    #[inline(always)]
    fn positive(a: Self::V) -> u8 {
        (0..WIDTH).fold(0, |mask, i| mask | (u8::from(a[i] > 0.0) << i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
    use crate::chain::stepper::lanes::Baseline;

    /// Values moved about by bits, in as many places from `at` on as there is room for.
    struct Moved {
        bits: u8,
        at: usize,
        of: [Row; 2],
    }

    impl Task for Moved {
        type Output = [Row; 3];

        fn run<L: Lanes>(self) -> [Row; 3] {
            let Self { bits, at, of } = self;
            let (a, b) = (L::load(&of[0]), L::load(&of[1]));
            let mut out = [Row::default(); 3];
            L::store(L::select(bits, a, b), &mut out[0]);
            L::store(L::gather(bits, a, (b, at)), &mut out[1]);
            out[1].0[at + bits.count_ones() as usize..].fill(of[1].0[0]);
            L::store(L::scatter(bits, (a, at), b), &mut out[2]);
            out
        }
    }

    #[test]
    fn values_go_where_bits_say() {
        let of = [Row([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]), Row([-1.0; 8])];
        for bits in 0..=u8::MAX {
            let lanes = (0..WIDTH).filter(|lane| bits & (1 << lane) != 0);
            for at in 0..=WIDTH - bits.count_ones() as usize {
                let mut expected = [of[1]; 3];
                for (count, lane) in lanes.clone().enumerate() {
                    expected[0].0[lane] = of[0].0[lane];
                    expected[1].0[at + count] = of[0].0[lane];
                    expected[2].0[lane] = of[0].0[at + count];
                }
                assert_eq!(Moved { bits, at, of }.run::<Baseline>(), expected, "{bits:b}, {at}");
                for set in InstructionSet::available() {
                    assert_eq!(dispatch(set, Moved { bits, at, of }), expected, "{}", set.name());
                }
            }
        }
    }

    struct Powers(Row);

    impl Task for Powers {
        type Output = [Row; 3];

        fn run<L: Lanes>(self) -> [Row; 3] {
            let a = L::load(&self.0);
            let mut out = [Row::default(); 3];
            L::store(L::mul(a, L::sqrt(a)), &mut out[0]);
            L::store(L::weigh_root(a, L::start_root(a), a), &mut out[1]);
            let root = L::weigh_root(a, L::start_root(a), L::splat(1.0));
            L::store(L::mul(a, root), &mut out[2]);
            out
        }
    }

    /// All ways to `a^1.5`, by the square-root unit, beside it, and with a root from beside it, are within 2 ulp of a reference of twice as
    /// many digits, for overlaps far below and far above any bead's.
    #[test]
    fn powers_are_within_two_ulp() {
        let mut bits = 0x9E37_79B9_7F4A_7C15_u64;
        let mut random = || {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            f64::from((bits >> 32) as u32) / f64::from(u32::MAX)
        };
        let mut worst = [0.0_f64; 3];
        for _ in 0..20_000 {
            let a = Row(std::array::from_fn(|_| 10.0_f64.powf(-60.0 + 62.0 * random())));
            for set in InstructionSet::available() {
                let found = dispatch(set, Powers(a));
                for (lane, a) in a.0.into_iter().enumerate() {
                    let root = a.sqrt();
                    // What rounding took from the root, and from the product.
                    let lost = root.mul_add(-root, a) / (2.0 * root);
                    let power = a * root;
                    let rest = a.mul_add(root, -power) + a * lost;
                    let ulp = power.next_up() - power;
                    for (worst, found) in worst.iter_mut().zip(found) {
                        *worst = worst.max(((found.0[lane] - power) - rest).abs() / ulp);
                    }
                }
            }
        }
        println!("{:.2}, {:.2} and {:.2} ulp", worst[0], worst[1], worst[2]);
        assert!(worst[0] > 0.0 && worst.into_iter().all(|worst| worst <= 2.0), "{worst:?}");
    }
}
