//! Which of the instruction sets that loops are compiled for this processor has, and the system lets programs use, and whose it is: asked once.
//!
//! `is_x86_feature_detected!` asks for all there is to know, in ten instructions `CPUID`, which a virtual machine answers by leaving the
//! machine: 3.7 to 8.5 us each where that was measured, 4 % and more of what a whole process takes. Two tell what is asked here.
//!
//! Bits: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2A, `CPUID`, and volume 1, sections 14.3 and 15.2 to 15.4.
#![allow(unsafe_code, reason = "an instruction that is there if the one before it says so")]
#![allow(unused_unsafe, reason = "newer compilers take CPUID to be safe, older ones do not")]

use std::arch::x86_64::{__cpuid, __cpuid_count, _xgetbv};
use std::sync::OnceLock;

/// Instruction sets beyond what every x86-64 processor has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Found {
    /// AVX2 and FMA.
    pub avx2: bool,
    /// AVX-512 F, DQ and VL, and the former.
    pub avx512: bool,
}

/// What is known of a processor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Processor {
    pub found: Found,
    /// Whether its square-root unit is slow beside its multipliers, as Intel's are taken to be and others are not: one of a stream of roots takes a Xeon
    /// four times as long as a Zen 5 (docs/performance.md).
    pub slow_roots: bool,
}

/// Bits of leaf 1, register A, that hold the family, and the family of Intel's processors since 1995.
const FAMILY: u32 = 0xF << 8;
const INTEL: u32 = 6 << 8;
/// Bits of leaf 1, register C.
const FMA: u32 = 1 << 12;
const OSXSAVE: u32 = 1 << 27;
const AVX: u32 = 1 << 28;
/// Bits of leaf 7, register B.
const AVX2: u32 = 1 << 5;
const AVX512_F_DQ_VL: u32 = 1 << 16 | 1 << 17 | 1 << 31;
/// Parts of the state that the system keeps for each thread: lower and upper halves of 32 bytes; masks and the rest of 64.
const KEEPS_32: u64 = 0b110;
const KEEPS_64: u64 = KEEPS_32 | 0b1110_0000;

/// What there is.
pub fn this() -> Processor {
    static THIS: OnceLock<Processor> = OnceLock::new();
    *THIS.get_or_init(ask)
}

fn ask() -> Processor {
    // SAFETY: every x86-64 processor has CPUID and its leaf 1.
    let first = unsafe { __cpuid(1) };
    Processor { found: find(first.ecx), slow_roots: first.eax & FAMILY == INTEL }
}

/// The instruction sets, given register C of leaf 1.
fn find(first: u32) -> Found {
    if !has(first, OSXSAVE | AVX | FMA) {
        return Found::default();
    }
    // SAFETY: a system that sets OSXSAVE has asked leaf 13 what to save, so that leaf 7 is there, too; and XGETBV.
    let (seventh, kept) = unsafe { (__cpuid_count(7, 0).ebx, _xgetbv(0)) };
    let avx2 = has(seventh, AVX2) && kept & KEEPS_32 == KEEPS_32;
    let avx512 = avx2 && has(seventh, AVX512_F_DQ_VL) && kept & KEEPS_64 == KEEPS_64;
    Found { avx2, avx512 }
}

fn has(register: u32, bits: u32) -> bool {
    register & bits == bits
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The standard library asks for more, and must say the same.
    #[test]
    fn what_is_found_is_what_the_standard_library_finds() {
        let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        let avx512 = avx2
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        assert_eq!(this().found, Found { avx2, avx512 });
    }
}
