//! The same arithmetic in the registers of x86-64 machines that have AVX-512.
#![allow(
    unsafe_code,
    reason = "intrinsics are unsafe outside functions compiled for their instruction set; `dispatch` asks the machine first"
)]
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
#![allow(clippy::undocumented_unsafe_blocks, reason = "one reason for all of them, above")]
#![allow(clippy::wildcard_imports, reason = "forty intrinsics, used nowhere else")]

use std::arch::asm;
use std::arch::x86_64::*;

use super::lanes::{Lanes, Row, Task, from};

/// AVX-512 F, VL and DQ: one register.
#[derive(Debug, Clone, Copy)]
pub struct Avx512;

impl Lanes for Avx512 {
    type V = __m512d;
    const AHEAD: usize = 4;
    const WAITS: bool = true;
    const IS_BESIDE: bool = true;

    fn apart<T: Task>(task: T) -> T::Output {
        #[inline(never)]
        #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
        fn wide<T: Task>(task: T) -> T::Output {
            task.run::<Avx512>()
        }
        unsafe { wide(task) }
    }

    #[inline(always)]
    fn load(row: &Row) -> Self::V {
        unsafe { _mm512_load_pd(row.0.as_ptr()) }
    }

    #[inline(always)]
    fn store(value: Self::V, row: &mut Row) {
        unsafe { _mm512_store_pd(row.0.as_mut_ptr(), value) }
    }

    #[inline(always)]
    fn splat(value: f64) -> Self::V {
        unsafe { _mm512_set1_pd(value) }
    }

    #[inline(always)]
    fn add(a: Self::V, b: Self::V) -> Self::V {
        unsafe { _mm512_add_pd(a, b) }
    }

    #[inline(always)]
    fn sub(a: Self::V, b: Self::V) -> Self::V {
        unsafe { _mm512_sub_pd(a, b) }
    }

    #[inline(always)]
    fn mul(a: Self::V, b: Self::V) -> Self::V {
        unsafe { _mm512_mul_pd(a, b) }
    }

    #[inline(always)]
    fn div(a: Self::V, b: Self::V) -> Self::V {
        unsafe { _mm512_div_pd(a, b) }
    }

    #[inline(always)]
    fn mul_add(a: Self::V, b: Self::V, c: Self::V) -> Self::V {
        unsafe { _mm512_fmadd_pd(a, b, c) }
    }

    #[inline(always)]
    fn max(a: Self::V, b: Self::V) -> Self::V {
        unsafe { _mm512_max_pd(a, b) }
    }

    #[inline(always)]
    fn min(a: Self::V, b: Self::V) -> Self::V {
        unsafe { _mm512_min_pd(a, b) }
    }

    #[inline(always)]
    fn abs(a: Self::V) -> Self::V {
        unsafe { _mm512_abs_pd(a) }
    }

    #[inline(always)]
    fn sqrt(a: Self::V) -> Self::V {
        unsafe { _mm512_sqrt_pd(a) }
    }

    #[inline(always)]
    fn start_root(a: Self::V) -> Self::V {
        unsafe { _mm512_rsqrt14_pd(a) }
    }

    #[inline(always)]
    fn weigh_root(a: Self::V, inverse: Self::V, weight: Self::V) -> Self::V {
        unsafe {
            let root = _mm512_mul_pd(a, inverse);
            // e = 1 - a inverse^2; sqrt(a) = root (1 - e)^(-1/2) = root (1 + e/2 + 3 e^2/8 + 5 e^3/16 + ...), e < 2^-13.
            let e = _mm512_fnmadd_pd(root, inverse, _mm512_set1_pd(1.0));
            let series = _mm512_fmadd_pd(e, _mm512_set1_pd(0.3125), _mm512_set1_pd(0.375));
            let series = _mm512_fmadd_pd(e, series, _mm512_set1_pd(0.5));
            let rough = _mm512_mul_pd(weight, root);
            _mm512_fmadd_pd(_mm512_mul_pd(rough, e), series, rough)
        }
    }

    #[inline(always)]
    fn shift_up(before: Self::V, here: Self::V) -> Self::V {
        unsafe { align::<7>(before, here) }
    }

    #[inline(always)]
    fn shift_down(here: Self::V, after: Self::V) -> Self::V {
        unsafe { align::<1>(here, after) }
    }

    #[inline(always)]
    fn largest(a: Self::V) -> f64 {
        unsafe { _mm512_reduce_max_pd(a) }
    }

    #[inline(always)]
    fn first(a: Self::V) -> f64 {
        unsafe { _mm512_cvtsd_f64(a) }
    }

    #[inline(always)]
    fn sum(a: Self::V) -> f64 {
        unsafe { _mm512_reduce_add_pd(a) }
    }

    #[inline(always)]
    fn fused(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }

    #[inline(always)]
    fn positive(a: Self::V) -> u8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(a, _mm512_setzero_pd()) }
    }

    #[inline(always)]
    fn select(bits: u8, a: Self::V, b: Self::V) -> Self::V {
        unsafe { _mm512_mask_blend_pd(bits, b, a) }
    }

    #[inline(always)]
    fn gather(bits: u8, a: Self::V, (b, at): (Self::V, usize)) -> Self::V {
        unsafe { _mm512_mask_expand_pd(b, from(at), _mm512_maskz_compress_pd(bits, a)) }
    }

    #[inline(always)]
    fn scatter(bits: u8, (a, at): (Self::V, usize), b: Self::V) -> Self::V {
        unsafe { _mm512_mask_expand_pd(b, bits, _mm512_maskz_compress_pd(from(at), a)) }
    }
}

/// Eight values from number `FROM` of `low` and then `high` on. The compiler would take a permutation instead, which costs a copy of a
/// register more and half as much time again.
#[inline]
#[target_feature(enable = "avx512f")]
fn align<const FROM: u8>(low: __m512d, high: __m512d) -> __m512d {
    let out;
    // SAFETY: registers only, and the instruction is one of those asked for above.
    unsafe {
        asm!(
            "valignq {out}, {high}, {low}, {from}",
            out = lateout(zmm_reg) out,
            high = in(zmm_reg) high,
            low = in(zmm_reg) low,
            from = const FROM,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    out
}
