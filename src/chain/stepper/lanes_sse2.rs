//! The same arithmetic with what every x86-64 machine has: SSE2, four registers. Each operation rounds as the plain loops of `Baseline` do, so
//! results are the same to the last bit; the compiler need not find out by itself that eight doubles are four pairs.
#![allow(unsafe_code, reason = "intrinsics are unsafe, but every x86-64 machine has these")]
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
#![allow(clippy::undocumented_unsafe_blocks, reason = "one reason for all of them, above")]

use std::arch::x86_64::{
    __m128d, _mm_add_pd, _mm_and_pd, _mm_and_si128, _mm_andnot_pd, _mm_castsi128_pd,
    _mm_cmpeq_epi32, _mm_cmpgt_pd, _mm_cvtsd_f64, _mm_div_pd, _mm_load_pd, _mm_max_pd, _mm_min_pd,
    _mm_movemask_pd, _mm_mul_pd, _mm_or_pd, _mm_set1_epi32, _mm_set1_pd, _mm_setr_epi32,
    _mm_setzero_pd, _mm_shuffle_pd, _mm_sqrt_pd, _mm_store_pd, _mm_sub_pd,
};

use super::lanes::{Lanes, Row};

/// SSE2: four registers.
#[derive(Debug, Clone, Copy)]
pub struct Sse2;

/// The same of all quarters.
macro_rules! quarters {
    ($call:ident($($argument:ident),+)) => {
        unsafe {
            [
                $call($($argument[0]),+),
                $call($($argument[1]),+),
                $call($($argument[2]),+),
                $call($($argument[3]),+),
            ]
        }
    };
}

/// `[a[1], b[0]]`
#[inline(always)]
fn across(a: __m128d, b: __m128d) -> __m128d {
    unsafe { _mm_shuffle_pd::<0b01>(a, b) }
}

impl Lanes for Sse2 {
    type V = [__m128d; 4];

    #[inline(always)]
    fn load(row: &Row) -> Self::V {
        let at = row.0.as_ptr();
        unsafe {
            [
                _mm_load_pd(at),
                _mm_load_pd(at.add(2)),
                _mm_load_pd(at.add(4)),
                _mm_load_pd(at.add(6)),
            ]
        }
    }

    #[inline(always)]
    fn store(value: Self::V, row: &mut Row) {
        let at = row.0.as_mut_ptr();
        unsafe {
            _mm_store_pd(at, value[0]);
            _mm_store_pd(at.add(2), value[1]);
            _mm_store_pd(at.add(4), value[2]);
            _mm_store_pd(at.add(6), value[3]);
        }
    }

    #[inline(always)]
    fn splat(value: f64) -> Self::V {
        unsafe { [_mm_set1_pd(value); 4] }
    }

    #[inline(always)]
    fn add(a: Self::V, b: Self::V) -> Self::V {
        quarters!(_mm_add_pd(a, b))
    }

    #[inline(always)]
    fn sub(a: Self::V, b: Self::V) -> Self::V {
        quarters!(_mm_sub_pd(a, b))
    }

    #[inline(always)]
    fn mul(a: Self::V, b: Self::V) -> Self::V {
        quarters!(_mm_mul_pd(a, b))
    }

    #[inline(always)]
    fn div(a: Self::V, b: Self::V) -> Self::V {
        quarters!(_mm_div_pd(a, b))
    }

    #[inline(always)]
    fn mul_add(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        Self::add(Self::mul(a, b), c)
    }

    #[inline(always)]
    fn max(a: Self::V, b: Self::V) -> Self::V {
        quarters!(_mm_max_pd(a, b))
    }

    #[inline(always)]
    fn min(a: Self::V, b: Self::V) -> Self::V {
        quarters!(_mm_min_pd(a, b))
    }

    #[inline(always)]
    fn abs(a: Self::V) -> Self::V {
        let sign = Self::splat(-0.0);
        quarters!(_mm_andnot_pd(sign, a))
    }

    #[inline(always)]
    fn sqrt(a: Self::V) -> Self::V {
        quarters!(_mm_sqrt_pd(a))
    }

    #[inline(always)]
    fn first(a: Self::V) -> f64 {
        unsafe { _mm_cvtsd_f64(a[0]) }
    }

    #[inline(always)]
    fn select(bits: u8, a: Self::V, b: Self::V) -> Self::V {
        let quarter = |number: usize| unsafe {
            let (first, second) = (1 << (2 * number), 2 << (2 * number));
            let own = _mm_setr_epi32(first, first, second, second);
            let set = _mm_and_si128(_mm_set1_epi32(i32::from(bits)), own);
            let all = _mm_castsi128_pd(_mm_cmpeq_epi32(set, own));
            _mm_or_pd(_mm_and_pd(all, a[number]), _mm_andnot_pd(all, b[number]))
        };
        [quarter(0), quarter(1), quarter(2), quarter(3)]
    }

    #[inline(always)]
    fn shift_up(before: Self::V, here: Self::V) -> Self::V {
        [
            across(before[3], here[0]),
            across(here[0], here[1]),
            across(here[1], here[2]),
            across(here[2], here[3]),
        ]
    }

    #[inline(always)]
    fn shift_down(here: Self::V, after: Self::V) -> Self::V {
        [
            across(here[0], here[1]),
            across(here[1], here[2]),
            across(here[2], here[3]),
            across(here[3], after[0]),
        ]
    }

    #[inline(always)]
    #[allow(
        clippy::cast_sign_loss,
        clippy::cast_possible_truncation,
        reason = "masks have two bits"
    )]
    fn positive(a: Self::V) -> u8 {
        let mask = |a: __m128d| unsafe { _mm_movemask_pd(_mm_cmpgt_pd(a, _mm_setzero_pd())) as u8 };
        mask(a[0]) | mask(a[1]) << 2 | mask(a[2]) << 4 | mask(a[3]) << 6
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::stepper::lanes::Baseline;

    /// Numbers of all kinds, and none.
    const VALUES: [f64; 8] =
        [1.5, -0.0, 1e-200, f64::NAN, -3.25e7, f64::INFINITY, 2.0 / 3.0, f64::MIN_POSITIVE];

    fn bits(values: [f64; 8]) -> [u64; 8] {
        values.map(f64::to_bits)
    }

    fn out(value: <Sse2 as Lanes>::V) -> [u64; 8] {
        let mut row = Row::default();
        Sse2::store(value, &mut row);
        bits(row.0)
    }

    #[test]
    fn rounds_as_plain_loops_do() {
        for turn in 0..8 {
            let (x, mut y) = (Row(VALUES), Row(VALUES));
            y.0.rotate_left(turn);
            let (a, b) = (Sse2::load(&x), Sse2::load(&y));
            let (x, y) = (x.0, y.0);
            assert_eq!(out(Sse2::max(a, b)), bits(Baseline::max(x, y)));
            assert_eq!(out(Sse2::min(a, b)), bits(Baseline::min(x, y)));
            assert_eq!(out(Sse2::abs(a)), bits(Baseline::abs(x)));
            assert_eq!(out(Sse2::shift_up(a, b)), bits(Baseline::shift_up(x, y)));
            assert_eq!(out(Sse2::shift_down(a, b)), bits(Baseline::shift_down(x, y)));
            assert_eq!(Sse2::positive(a), Baseline::positive(x));
            assert_eq!(Sse2::finite(b), Baseline::finite(y));
            assert_eq!(Sse2::largest(b).to_bits(), Baseline::largest(y).to_bits());
            // Which of its bits a result that is no number has is nobody's business.
            let same = |found: <Sse2 as Lanes>::V, expected: [f64; 8]| {
                let found = out(found).map(f64::from_bits);
                let equal =
                    |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
                assert!(found.iter().zip(&expected).all(equal), "{found:?} {expected:?}");
            };
            same(Sse2::add(a, b), Baseline::add(x, y));
            same(Sse2::sub(a, b), Baseline::sub(x, y));
            same(Sse2::mul(a, b), Baseline::mul(x, y));
            same(Sse2::div(a, b), Baseline::div(x, y));
            same(Sse2::mul_add(a, b, Sse2::splat(0.1)), Baseline::mul_add(x, y, [0.1; 8]));
            same(Sse2::sqrt(a), Baseline::sqrt(x));
            same(
                Sse2::weigh_root(a, Sse2::start_root(a), a),
                Baseline::weigh_root(x, Baseline::start_root(x), x),
            );
        }
    }
}
