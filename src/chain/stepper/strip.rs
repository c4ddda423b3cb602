//! What belongs to the rows of a chain, four rows at a time, so that loops over fours need not check where they are.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

/// Rows that stand together.
pub const FOUR: usize = 4;

/// Which four, and which of them; those left over come last.
pub type At = (usize, usize);

/// Something of each row.
#[derive(Debug, Clone, Copy)]
pub struct Strip<'a, T> {
    fours: &'a [[T; FOUR]],
    rest: &'a [T],
}

/// The same, to be written.
#[derive(Debug)]
pub struct StripMut<'a, T> {
    fours: &'a mut [[T; FOUR]],
    rest: &'a mut [T],
}

impl<'a, T> Strip<'a, T> {
    /// Of the first `rows` rows.
    #[inline(always)]
    pub fn new(of: &'a [T], rows: usize) -> Self {
        let (fours, rest) = of[..rows].as_chunks();
        Self { fours, rest }
    }

    #[inline(always)]
    pub fn at(&self, (four, row): At) -> &'a T {
        match self.fours.get(four) {
            Some(of) => &of[row],
            None => &self.rest[row],
        }
    }
}

impl<'a, T> StripMut<'a, T> {
    /// Of the first `rows` rows.
    #[inline(always)]
    pub fn new(of: &'a mut [T], rows: usize) -> Self {
        let (fours, rest) = of[..rows].as_chunks_mut();
        Self { fours, rest }
    }

    #[inline(always)]
    pub fn at(&self, at: At) -> &T {
        Strip { fours: self.fours, rest: self.rest }.at(at)
    }

    #[inline(always)]
    pub fn at_mut(&mut self, (four, row): At) -> &mut T {
        match self.fours.get_mut(four) {
            Some(of) => &mut of[row],
            None => &mut self.rest[row],
        }
    }
}
