//! The same arithmetic in the registers of x86-64 machines that have AVX2, without AVX-512.
#![allow(
    unsafe_code,
    reason = "intrinsics are unsafe outside functions compiled for their instruction set; `dispatch` asks the machine first"
)]
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
#![allow(clippy::undocumented_unsafe_blocks, reason = "one reason for all of them, above")]
#![allow(clippy::wildcard_imports, reason = "thirty intrinsics, used nowhere else")]

use std::arch::x86_64::*;

use super::lanes::{Lanes, Row, Task};

/// AVX2 and FMA: two registers.
#[derive(Debug, Clone, Copy)]
pub struct Avx2;

/// The same of both halves.
macro_rules! halves {
    ($call:ident($($argument:ident),+)) => {
        unsafe { [$call($($argument[0]),+), $call($($argument[1]),+)] }
    };
}

impl Lanes for Avx2 {
    type V = [__m256d; 2];

    fn apart<T: Task>(task: T) -> T::Output {
        #[inline(never)]
        #[target_feature(enable = "avx2,fma")]
        fn wide<T: Task>(task: T) -> T::Output {
            task.run::<Avx2>()
        }
        unsafe { wide(task) }
    }

    #[inline(always)]
    fn load(row: &Row) -> Self::V {
        unsafe { [_mm256_load_pd(row.0.as_ptr()), _mm256_load_pd(row.0.as_ptr().add(4))] }
    }

    #[inline(always)]
    fn store(value: Self::V, row: &mut Row) {
        unsafe {
            _mm256_store_pd(row.0.as_mut_ptr(), value[0]);
            _mm256_store_pd(row.0.as_mut_ptr().add(4), value[1]);
        }
    }

    #[inline(always)]
    fn splat(value: f64) -> Self::V {
        unsafe { [_mm256_set1_pd(value); 2] }
    }

    #[inline(always)]
    fn add(a: Self::V, b: Self::V) -> Self::V {
        halves!(_mm256_add_pd(a, b))
    }

    #[inline(always)]
    fn sub(a: Self::V, b: Self::V) -> Self::V {
        halves!(_mm256_sub_pd(a, b))
    }

    #[inline(always)]
    fn mul(a: Self::V, b: Self::V) -> Self::V {
        halves!(_mm256_mul_pd(a, b))
    }

    #[inline(always)]
    fn div(a: Self::V, b: Self::V) -> Self::V {
        halves!(_mm256_div_pd(a, b))
    }

    #[inline(always)]
    fn mul_add(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        halves!(_mm256_fmadd_pd(a, b, c))
    }

    #[inline(always)]
    fn max(a: Self::V, b: Self::V) -> Self::V {
        halves!(_mm256_max_pd(a, b))
    }

    #[inline(always)]
    fn min(a: Self::V, b: Self::V) -> Self::V {
        halves!(_mm256_min_pd(a, b))
    }

    #[inline(always)]
    fn abs(a: Self::V) -> Self::V {
        let sign = Self::splat(-0.0);
        halves!(_mm256_andnot_pd(sign, a))
    }

    #[inline(always)]
    fn sqrt(a: Self::V) -> Self::V {
        halves!(_mm256_sqrt_pd(a))
    }

    #[inline(always)]
    fn first(a: Self::V) -> f64 {
        unsafe { _mm256_cvtsd_f64(a[0]) }
    }

    #[inline(always)]
    fn fused(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }

    #[inline(always)]
    fn select(bits: u8, a: Self::V, b: Self::V) -> Self::V {
        let half = |a: __m256d, b: __m256d, own: __m256i| unsafe {
            let set = _mm256_and_si256(_mm256_set1_epi64x(i64::from(bits)), own);
            _mm256_blendv_pd(b, a, _mm256_castsi256_pd(_mm256_cmpeq_epi64(set, own)))
        };
        let own = unsafe { [_mm256_setr_epi64x(1, 2, 4, 8), _mm256_setr_epi64x(16, 32, 64, 128)] };
        [half(a[0], b[0], own[0]), half(a[1], b[1], own[1])]
    }

    #[inline(always)]
    fn shift_up(before: Self::V, here: Self::V) -> Self::V {
        let up = |before: __m256d, here: __m256d| unsafe {
            let middle = _mm256_permute2f128_pd::<0x21>(before, here);
            _mm256_shuffle_pd::<0b0101>(middle, here)
        };
        [up(before[1], here[0]), up(here[0], here[1])]
    }

    #[inline(always)]
    fn shift_down(here: Self::V, after: Self::V) -> Self::V {
        let down = |here: __m256d, after: __m256d| unsafe {
            let middle = _mm256_permute2f128_pd::<0x21>(here, after);
            _mm256_shuffle_pd::<0b0101>(here, middle)
        };
        [down(here[0], here[1]), down(here[1], after[0])]
    }

    #[inline(always)]
    #[allow(
        clippy::cast_sign_loss,
        clippy::cast_possible_truncation,
        reason = "masks have four bits"
    )]
    fn positive(a: Self::V) -> u8 {
        let mask = |a: __m256d| unsafe {
            _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(a, _mm256_setzero_pd())) as u8
        };
        mask(a[0]) | (mask(a[1]) << 4)
    }
}
