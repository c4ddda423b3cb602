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
use crate::chain::processor::{self, Processor};

/// Instructions that the loops may use, and how.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InstructionSet {
    set: Set,
    /// Whether the square-root unit is slow.
    slow_roots: bool,
}

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
        Self::found().next().unwrap_or(Self { set: Set::Baseline, slow_roots: false })
    }

    fn found() -> impl Iterator<Item = Self> {
        #[cfg(target_arch = "x86_64")]
        let (wider, slow_roots) = {
            let Processor { found, slow_roots } = processor::this();
            let wider = [found.avx512.then_some(Set::Avx512), found.avx2.then_some(Set::Avx2)];
            (wider, slow_roots)
        };
        #[cfg(not(target_arch = "x86_64"))]
        let (wider, slow_roots) = ([None; 0], false);
        let sets = wider.into_iter().flatten().chain([Set::Baseline]);
        sets.map(move |set| Self { set, slow_roots })
    }

    /// The same for a processor whose square-root unit is slow, or quick, beside its multipliers: how many roots it gets decides how long
    /// a step takes, and how its forces are rounded.
    #[must_use]
    pub fn with_roots(self, slow: bool) -> Self {
        Self { slow_roots: slow, ..self }
    }

    /// Whether the square-root unit is taken to be slow.
    #[must_use]
    pub fn has_slow_roots(self) -> bool {
        self.slow_roots
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.set {
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
    match set.set {
        #[cfg(target_arch = "x86_64")]
        Set::Avx512 => Avx512::apart(task),
        #[cfg(target_arch = "x86_64")]
        Set::Avx2 => Avx2::apart(task),
        Set::Baseline => Baseline::apart(task),
    }
}
