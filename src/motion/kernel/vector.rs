//! Eight doubles side by side: one register with AVX-512, two with AVX2, an array that the compiler
//! vectorises elsewhere.
//!
//! A [`Simd`] value is the proof that the processor has its instructions: [`InstructionSet`] makes
//! one after asking the processor, and vectors come from nothing else. So the methods are safe,
//! though the intrinsics beneath are not.
#![allow(
    unsafe_code,
    reason = "intrinsics; a `Simd` value exists only where the processor has them"
)]
#![allow(clippy::undocumented_unsafe_blocks, reason = "one reason for all of them, above")]
#![allow(
    clippy::inline_always,
    reason = "the code has to be inlined into functions compiled for the instruction set"
)]

use std::ops::{Add, Div, Mul, Sub};
use std::sync::OnceLock;

/// Doubles in a row.
pub const WIDTH: usize = 8;
/// Environment variable that names the instruction set to use.
pub const VARIABLE: &str = "HERTZSCOPE_INSTRUCTIONS";

/// Eight values in memory, aligned to a cache line (unit).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C, align(64))]
pub struct Row(pub [f64; WIDTH]);

/// A loop that is compiled for every instruction set.
pub trait Kernel {
    /// What it returns.
    type Output;

    /// Runs it; to be marked `#[inline(always)]`, so that it is compiled with the instructions of
    /// `S`.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// Proof that an instruction set is there.
pub trait Simd: Copy {
    /// Eight doubles in its registers.
    type V: Vector;

    /// Eight times the same value.
    fn splat(self, value: f64) -> Self::V;

    /// From memory.
    fn load(self, row: &Row) -> Self::V;

    /// Runs `kernel` in a function compiled for this instruction set.
    fn run<K: Kernel>(self, kernel: K) -> K::Output;
}

/// Arithmetic on eight doubles. Fused multiply-adds round once with AVX-512 and AVX2, twice
/// elsewhere.
pub trait Vector:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// `self * b + c`
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self` where it is larger than `other`, else `other`: a NaN in `other` stays, one in `self`
    /// does not.
    fn max(self, other: Self) -> Self;
    /// Magnitudes.
    fn abs(self) -> Self;
    /// Square roots of values of at least 1e-200; `a * root(a)` is `a^1.5` within 2 ulp.
    fn root(self) -> Self;
    /// `[before[7], self[0], ..., self[6]]`
    fn shift_up(self, before: Self) -> Self;
    /// `[self[1], ..., self[7], after[0]]`
    fn shift_down(self, after: Self) -> Self;
    /// Bit `i` is set where value `i` is above zero.
    fn positive(self) -> u8;
    /// To memory.
    fn store(self, row: &mut Row);
    /// The largest of the eight, which must be no NaN (unit).
    #[inline(always)]
    fn largest(self) -> f64 {
        let mut row = Row::default();
        self.store(&mut row);
        row.0.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }
}

/// An instruction set that this processor has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InstructionSet(Set);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Set {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    Portable,
}

impl InstructionSet {
    /// All that this processor has, the widest first.
    pub fn available() -> Vec<Self> {
        let mut sets = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            let wide = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq");
            sets.extend((avx2 && wide).then_some(Self(Set::Avx512)));
            sets.extend(avx2.then_some(Self(Set::Avx2)));
        }
        sets.push(Self(Set::Portable));
        sets
    }

    /// The one to use: that of [`VARIABLE`], or the widest.
    pub fn best() -> Self {
        static BEST: OnceLock<InstructionSet> = OnceLock::new();
        *BEST.get_or_init(|| Self::chosen().unwrap_or(Self(Set::Portable)))
    }

    /// The same, or the message of what is wrong with [`VARIABLE`].
    ///
    /// # Errors
    /// A name of no instruction set, or of one that this processor does not have.
    pub fn chosen() -> Result<Self, String> {
        match std::env::var(VARIABLE) {
            Ok(name) => Self::named(&name).map_err(|reason| format!("{VARIABLE}: {reason}")),
            Err(_) => Ok(Self::available()[0]),
        }
    }

    /// The one of this name.
    ///
    /// # Errors
    /// A name of no instruction set, or of one that this processor does not have.
    pub fn named(name: &str) -> Result<Self, String> {
        let available = Self::available();
        let found = available.iter().find(|set| set.name() == name).copied();
        let names = || available.iter().map(|set| set.name()).collect::<Vec<_>>().join(", ");
        found.ok_or_else(|| {
            format!("this processor has no instruction set `{name}`: choose {}", names())
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => "avx512",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "avx2",
            Set::Portable => "portable",
        }
    }

    /// Runs `kernel` with these instructions.
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => x86::Avx512(()).run(kernel),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => x86::Avx2(()).run(kernel),
            Set::Portable => Portable.run(kernel),
        }
    }
}

/// Any processor.
#[derive(Debug, Clone, Copy)]
pub struct Portable;

/// Eight doubles in an array.
#[derive(Debug, Clone, Copy)]
pub struct Array([f64; WIDTH]);

impl Simd for Portable {
    type V = Array;

    #[inline(always)]
    fn splat(self, value: f64) -> Array {
        Array([value; WIDTH])
    }

    #[inline(always)]
    fn load(self, row: &Row) -> Array {
        Array(row.0)
    }

    #[inline(never)]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}

/// Implements an operator of vectors by a function of their registers.
macro_rules! operator {
    ($vector:ty, $trait:ident, $method:ident, |$a:ident, $b:ident| $value:expr) => {
        impl $trait for $vector {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                Self($value)
            }
        }
    };
}

operator!(Array, Add, add, |a, b| std::array::from_fn(|i| a[i] + b[i]));
operator!(Array, Sub, sub, |a, b| std::array::from_fn(|i| a[i] - b[i]));
operator!(Array, Mul, mul, |a, b| std::array::from_fn(|i| a[i] * b[i]));
operator!(Array, Div, div, |a, b| std::array::from_fn(|i| a[i] / b[i]));

impl Vector for Array {
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        Self(std::array::from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] }))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    #[inline(always)]
    fn root(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }

    #[inline(always)]
    fn shift_up(self, before: Self) -> Self {
        let [a, b, c, d, e, f, g, _] = self.0;
        Self([before.0[7], a, b, c, d, e, f, g])
    }

    #[inline(always)]
    fn shift_down(self, after: Self) -> Self {
        let [_, b, c, d, e, f, g, h] = self.0;
        Self([b, c, d, e, f, g, h, after.0[0]])
    }

    #[inline(always)]
    fn positive(self) -> u8 {
        (0..WIDTH).fold(0, |bits, i| bits | (u8::from(self.0[i] > 0.0) << i))
    }

    #[inline(always)]
    fn store(self, row: &mut Row) {
        row.0 = self.0;
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    #![allow(clippy::wildcard_imports, reason = "forty intrinsics, used nowhere else")]

    use std::arch::x86_64::*;
    use std::ops::{Add, Div, Mul, Sub};

    use super::{Kernel, Row, Simd, Vector};

    /// Proof of AVX-512 F, VL and DQ, AVX2 and FMA.
    #[derive(Debug, Clone, Copy)]
    pub struct Avx512(pub(super) ());

    /// One register.
    #[derive(Debug, Clone, Copy)]
    pub struct One(__m512d);

    impl Simd for Avx512 {
        type V = One;

        #[inline(always)]
        fn splat(self, value: f64) -> One {
            eight(value)
        }

        #[inline(always)]
        fn load(self, row: &Row) -> One {
            One(unsafe { _mm512_load_pd(row.0.as_ptr()) })
        }

        fn run<K: Kernel>(self, kernel: K) -> K::Output {
            #[inline(never)]
            #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
            fn compiled<K: Kernel>(simd: Avx512, kernel: K) -> K::Output {
                kernel.run(simd)
            }
            unsafe { compiled(self, kernel) }
        }
    }

    operator!(One, Add, add, |a, b| unsafe { _mm512_add_pd(a, b) });
    operator!(One, Sub, sub, |a, b| unsafe { _mm512_sub_pd(a, b) });
    operator!(One, Mul, mul, |a, b| unsafe { _mm512_mul_pd(a, b) });
    operator!(One, Div, div, |a, b| unsafe { _mm512_div_pd(a, b) });

    /// Eight times the same value.
    #[inline(always)]
    fn eight(value: f64) -> One {
        One(unsafe { _mm512_set1_pd(value) })
    }

    impl Vector for One {
        #[inline(always)]
        fn mul_add(self, b: Self, c: Self) -> Self {
            Self(unsafe { _mm512_fmadd_pd(self.0, b.0, c.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm512_max_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm512_abs_pd(self.0) })
        }

        /// From the 14 bits of the reciprocal root by Householder's correction of fourth order:
        /// with `y` the estimate and `e = 1 - a y^2`, the root is
        /// `a y (1 + e/2 + 3/8 e^2 + 5/16 e^3)`. Faster than the square-root unit.
        #[inline(always)]
        fn root(self) -> Self {
            let estimate = Self(unsafe { _mm512_rsqrt14_pd(self.0) });
            let root = self * estimate;
            let error = Self(unsafe { _mm512_fnmadd_pd(root.0, estimate.0, eight(1.0).0) });
            let series =
                eight(5.0 / 16.0).mul_add(error, eight(3.0 / 8.0)).mul_add(error, eight(0.5));
            (root * error).mul_add(series, root)
        }

        #[inline(always)]
        fn shift_up(self, before: Self) -> Self {
            unsafe {
                let (here, before) = (_mm512_castpd_si512(self.0), _mm512_castpd_si512(before.0));
                Self(_mm512_castsi512_pd(_mm512_alignr_epi64::<7>(here, before)))
            }
        }

        #[inline(always)]
        fn shift_down(self, after: Self) -> Self {
            unsafe {
                let (here, after) = (_mm512_castpd_si512(self.0), _mm512_castpd_si512(after.0));
                Self(_mm512_castsi512_pd(_mm512_alignr_epi64::<1>(after, here)))
            }
        }

        #[inline(always)]
        fn positive(self) -> u8 {
            unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, _mm512_setzero_pd()) }
        }

        #[inline(always)]
        fn store(self, row: &mut Row) {
            unsafe { _mm512_store_pd(row.0.as_mut_ptr(), self.0) }
        }

        #[inline(always)]
        fn largest(self) -> f64 {
            unsafe { _mm512_reduce_max_pd(self.0) }
        }
    }

    /// Proof of AVX2 and FMA.
    #[derive(Debug, Clone, Copy)]
    pub struct Avx2(pub(super) ());

    /// Two registers, the first four values in the first.
    #[derive(Debug, Clone, Copy)]
    pub struct Two([__m256d; 2]);

    impl Simd for Avx2 {
        type V = Two;

        #[inline(always)]
        fn splat(self, value: f64) -> Two {
            Two([unsafe { _mm256_set1_pd(value) }; 2])
        }

        #[inline(always)]
        fn load(self, row: &Row) -> Two {
            let (halves, _) = row.0.as_chunks::<4>();
            Two(unsafe { [_mm256_load_pd(halves[0].as_ptr()), _mm256_load_pd(halves[1].as_ptr())] })
        }

        fn run<K: Kernel>(self, kernel: K) -> K::Output {
            #[inline(never)]
            #[target_feature(enable = "avx2,fma")]
            fn compiled<K: Kernel>(simd: Avx2, kernel: K) -> K::Output {
                kernel.run(simd)
            }
            unsafe { compiled(self, kernel) }
        }
    }

    operator!(Two, Add, add, |a, b| unsafe {
        [_mm256_add_pd(a[0], b[0]), _mm256_add_pd(a[1], b[1])]
    });
    operator!(Two, Sub, sub, |a, b| unsafe {
        [_mm256_sub_pd(a[0], b[0]), _mm256_sub_pd(a[1], b[1])]
    });
    operator!(Two, Mul, mul, |a, b| unsafe {
        [_mm256_mul_pd(a[0], b[0]), _mm256_mul_pd(a[1], b[1])]
    });
    operator!(Two, Div, div, |a, b| unsafe {
        [_mm256_div_pd(a[0], b[0]), _mm256_div_pd(a[1], b[1])]
    });

    impl Vector for Two {
        #[inline(always)]
        fn mul_add(self, b: Self, c: Self) -> Self {
            let ([a0, a1], [b0, b1], [c0, c1]) = (self.0, b.0, c.0);
            Self(unsafe { [_mm256_fmadd_pd(a0, b0, c0), _mm256_fmadd_pd(a1, b1, c1)] })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            let ([a0, a1], [b0, b1]) = (self.0, other.0);
            Self(unsafe { [_mm256_max_pd(a0, b0), _mm256_max_pd(a1, b1)] })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            let sign = unsafe { _mm256_set1_pd(-0.0) };
            let [a, b] = self.0;
            Self(unsafe { [_mm256_andnot_pd(sign, a), _mm256_andnot_pd(sign, b)] })
        }

        #[inline(always)]
        fn root(self) -> Self {
            let [a, b] = self.0;
            Self(unsafe { [_mm256_sqrt_pd(a), _mm256_sqrt_pd(b)] })
        }

        #[inline(always)]
        fn shift_up(self, before: Self) -> Self {
            // In each half the last value of the half before comes first.
            let ([first, last], [_, before]) = (self.0, before.0);
            Self(unsafe {
                let (early, late) = (
                    _mm256_permute2f128_pd::<0x21>(before, first),
                    _mm256_permute2f128_pd::<0x21>(first, last),
                );
                [_mm256_shuffle_pd::<0b0101>(early, first), _mm256_shuffle_pd::<0b0101>(late, last)]
            })
        }

        #[inline(always)]
        fn shift_down(self, after: Self) -> Self {
            let ([first, last], [after, _]) = (self.0, after.0);
            Self(unsafe {
                let (early, late) = (
                    _mm256_permute2f128_pd::<0x21>(first, last),
                    _mm256_permute2f128_pd::<0x21>(last, after),
                );
                [_mm256_shuffle_pd::<0b0101>(first, early), _mm256_shuffle_pd::<0b0101>(last, late)]
            })
        }

        #[inline(always)]
        fn positive(self) -> u8 {
            let [first, last] = self.0;
            let (first, last) = unsafe {
                let none = _mm256_setzero_pd();
                (
                    _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(first, none)),
                    _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(last, none)),
                )
            };
            (first | last << 4) as u8
        }

        #[inline(always)]
        fn store(self, row: &mut Row) {
            let (halves, _) = row.0.as_chunks_mut::<4>();
            unsafe {
                _mm256_store_pd(halves[0].as_mut_ptr(), self.0[0]);
                _mm256_store_pd(halves[1].as_mut_ptr(), self.0[1]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Everything([Row; 2]);

    impl Kernel for Everything {
        type Output = ([Row; 8], [u8; 2]);

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let [a, b] = self.0.each_ref().map(|row| simd.load(row));
            let values =
                [a + b, a - b, a * b, a / b, a.max(b), a.abs(), a.shift_up(b), a.shift_down(b)];
            let mut out = [Row::default(); 8];
            for (value, row) in values.into_iter().zip(&mut out) {
                value.store(row);
            }
            (out, [a.positive(), b.positive()])
        }
    }

    /// Every operation on every instruction set, against the same on single numbers; a NaN stays
    /// where it is said to.
    #[test]
    fn every_instruction_set_computes_the_same() {
        let a = [1.5, -2.0, 0.0, f64::NAN, 1e-9, -0.0, 7.0, 3.0];
        let b = [-1.0, 4.0, 2.0, 1.0, f64::NAN, 5.0, 0.25, 3.0];
        let each = |of: fn(f64, f64) -> f64| Row(std::array::from_fn(|i| of(a[i], b[i])));
        let expected = [
            each(|a, b| a + b),
            each(|a, b| a - b),
            each(|a, b| a * b),
            each(|a, b| a / b),
            each(|a, b| if a > b { a } else { b }),
            each(|a, _| a.abs()),
            Row([b[7], a[0], a[1], a[2], a[3], a[4], a[5], a[6]]),
            Row([a[1], a[2], a[3], a[4], a[5], a[6], a[7], b[0]]),
        ];
        for set in InstructionSet::available() {
            let (found, bits) = set.run(Everything([Row(a), Row(b)]));
            for (number, (found, expected)) in found.iter().zip(&expected).enumerate() {
                for (found, expected) in found.0.into_iter().zip(expected.0) {
                    let same = found.to_bits() == expected.to_bits()
                        || found.is_nan() && expected.is_nan();
                    assert!(same, "{}, operation {number}: {found} {expected}", set.name());
                }
            }
            assert_eq!(bits, [0b1101_0001, 0b1110_1110], "{}", set.name());
        }
    }

    struct Powers(Row);

    impl Kernel for Powers {
        type Output = (Row, f64);

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let a = simd.load(&self.0);
            let mut out = Row::default();
            (a * a.root()).store(&mut out);
            (out, a.largest())
        }
    }

    /// `a^1.5` against a reference of twice as many digits, for overlaps far below and far above
    /// any bead's.
    #[test]
    fn powers_are_within_two_ulp() {
        let mut bits = 0x9E37_79B9_7F4A_7C15_u64;
        let mut random = || {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            f64::from((bits >> 32) as u32) / f64::from(u32::MAX)
        };
        let mut worst = 0.0_f64;
        for _ in 0..20_000 {
            let a = Row(std::array::from_fn(|_| 10.0_f64.powf(-60.0 + 62.0 * random())));
            for set in InstructionSet::available() {
                let (found, largest) = set.run(Powers(a));
                assert!(a.0.contains(&largest) && a.0.iter().all(|a| *a <= largest));
                for (found, a) in found.0.into_iter().zip(a.0) {
                    let root = a.sqrt();
                    // What rounding took from the root, and from the product.
                    let lost = root.mul_add(-root, a) / (2.0 * root);
                    let power = a * root;
                    let rest = a.mul_add(root, -power) + a * lost;
                    let ulp = power.next_up() - power;
                    worst = worst.max(((found - power) - rest).abs() / ulp);
                }
            }
        }
        assert!(worst > 0.0 && worst <= 2.0, "{worst}");
    }

    #[test]
    fn names_are_those_of_the_environment_variable() {
        for set in InstructionSet::available() {
            assert_eq!(InstructionSet::named(set.name()), Ok(set));
        }
        let reason = InstructionSet::named("mmx").expect_err("no such set");
        assert!(reason.contains("`mmx`") && reason.contains("portable"), "{reason}");
    }
}
