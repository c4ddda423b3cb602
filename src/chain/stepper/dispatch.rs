//! The choice of an instruction set at run time.

#[cfg(not(target_arch = "x86_64"))]
use super::lanes::Baseline;
use super::lanes::{Lanes, Task};
#[cfg(target_arch = "x86_64")]
use super::lanes_avx2::Avx2;
#[cfg(target_arch = "x86_64")]
use super::lanes_avx512::Avx512;
#[cfg(target_arch = "x86_64")]
use super::lanes_sse2::Sse2 as Baseline;
#[cfg(target_arch = "x86_64")]
use crate::chain::processor;

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
        Self::found().collect()
    }

    /// The widest that this machine has.
    #[must_use]
    pub fn best() -> Self {
        Self::found().next().unwrap_or(Self(Set::Baseline))
    }

    fn found() -> impl Iterator<Item = Self> {
        #[cfg(target_arch = "x86_64")]
        let wider = {
            let found = processor::found();
            [found.avx512.then_some(Self(Set::Avx512)), found.avx2.then_some(Self(Set::Avx2))]
        };
        #[cfg(not(target_arch = "x86_64"))]
        let wider = [None; 0];
        wider.into_iter().flatten().chain([Self(Set::Baseline)])
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

/// Runs `task` with the instructions of `set`: [`InstructionSet::available`] is the only way to one, and it has asked the machine.
pub fn dispatch<T: Task>(set: InstructionSet, task: T) -> T::Output {
    match set.0 {
        #[cfg(target_arch = "x86_64")]
        Set::Avx512 => Avx512::apart(task),
        #[cfg(target_arch = "x86_64")]
        Set::Avx2 => Avx2::apart(task),
        Set::Baseline => Baseline::apart(task),
    }
}
