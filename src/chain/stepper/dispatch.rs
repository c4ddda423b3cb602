//! The loops compiled for each instruction set, and the choice at run time.
#![allow(
    unsafe_code,
    reason = "calling a function compiled for an instruction set is unsafe until the set is known to be there"
)]

#[cfg(not(target_arch = "x86_64"))]
use super::lanes::Baseline;
use super::lanes::Lanes;
#[cfg(target_arch = "x86_64")]
use super::lanes_sse2::Sse2 as Baseline;
#[cfg(target_arch = "x86_64")]
use super::lanes_x86::{Avx2, Avx512};

/// Instructions that the loops may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InstructionSet(Set);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Set {
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl InstructionSet {
    /// What this machine has, the widest first.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let mut sets = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            let wide = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq");
            let fma = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            if wide && fma {
                sets.push(Self(Set::Avx512));
            }
            if fma {
                sets.push(Self(Set::Avx2));
            }
        }
        sets.push(Self(Set::Baseline));
        sets
    }

    /// The widest that this machine has.
    #[must_use]
    pub fn best() -> Self {
        Self::available().first().copied().unwrap_or(Self(Set::Baseline))
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Set::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "AVX2",
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => "AVX-512",
        }
    }
}

/// Something to be compiled for every instruction set.
pub trait Task {
    /// What comes of it.
    type Output;

    /// Does it; inlined into a function compiled for the instructions of `L`.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Runs `task` with the instructions of `set`.
pub fn dispatch<T: Task>(set: InstructionSet, task: T) -> T::Output {
    match set.0 {
        // SAFETY: `InstructionSet::available` is the only way to these values, and it has asked the machine.
        #[cfg(target_arch = "x86_64")]
        Set::Avx512 => unsafe { avx512(task) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Set::Avx2 => unsafe { avx2(task) },
        Set::Baseline => task.run::<Baseline>(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
fn avx512<T: Task>(task: T) -> T::Output {
    task.run::<Avx512>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<T: Task>(task: T) -> T::Output {
    task.run::<Avx2>()
}
