//! What is noted of steps that are taken at once: how a few rows stand and move at the end of each, in long chains of each but the last
//! two: those ends stay where they are.

use super::lanes::{Row, WIDTH};
use super::strip::{At, FOUR};
use super::workspace::anew;

/// Positions (m), velocities (m/s) and accelerations (m/s²) of a row.
pub type Note = [Row; 3];

/// Starts, lengths and ends of the steps that were taken last (s).
#[derive(Debug, Clone, Copy, Default)]
pub struct Times {
    kept: [[f64; 3]; WIDTH],
    /// Where the next is kept.
    next: usize,
}

impl Times {
    /// Keeps those of the next step.
    #[inline]
    pub fn keep(&mut self, times: [f64; 3]) {
        self.kept[self.next] = times;
        self.next = (self.next + 1) % WIDTH;
    }

    /// Those of the step that was `before` the last; as many as there are lanes are kept (s).
    pub fn before(&self, before: usize) -> [f64; 3] {
        self.kept[(self.next + WIDTH - 1 - before) % WIDTH]
    }
}

/// Notes of steps, in their order, of some of the rows in theirs.
#[derive(Debug, Clone, Default)]
pub struct Notes {
    /// Which note each row is of a step's, counted from 1; 0 for one that nobody asks for. Rows behind the last are not asked for either.
    which: Vec<u32>,
    /// The rows, in their order: those that a step has notes of.
    asked: Vec<usize>,
    kept: Vec<Note>,
    /// How many are taken.
    count: usize,
}

impl Notes {
    /// Of `steps` steps, of rows that `asked` has a place for.
    pub fn new(steps: usize, asked: impl Iterator<Item = usize>) -> Self {
        // Bodies around a place, of which most lie in rows of their own.
        let (which, room) = (Vec::with_capacity(WIDTH), Vec::with_capacity(WIDTH));
        let mut notes = Self { which, asked: room, ..Self::default() };
        notes.ask(steps, asked);
        notes
    }

    /// As [`Self::new`] has them, in the memory that there is.
    pub fn ask(&mut self, steps: usize, rows: impl Iterator<Item = usize>) {
        let Self { which, asked, kept, count } = self;
        which.clear();
        for row in rows {
            which.resize(which.len().max(row + 1), 0);
            which[row] = 1;
        }
        asked.clear();
        let mut notes = 0;
        for (row, which) in which.iter_mut().enumerate().filter(|(_, which)| **which > 0) {
            notes += 1;
            *which = notes;
            asked.push(row);
        }
        anew(kept, asked.len() * steps);
        *count = 0;
    }

    /// Begins anew.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Where row `at` is noted next, if anybody asks for it.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
    pub fn room(&mut self, (four, row): At) -> Option<&mut Note> {
        let is_asked = self.which.get(FOUR * four + row).is_some_and(|which| *which > 0);
        if !is_asked {
            return None;
        }
        self.count += 1;
        self.kept.get_mut(self.count - 1)
    }

    /// Notes how `rows` stand and move at the end of the next step.
    pub fn keep(&mut self, rows: [&[Row]; 3]) {
        for row in &self.asked {
            let note = self.kept.get_mut(self.count).into_iter().flatten();
            // Row by row: all at once would go through memory twice.
            for (noted, rows) in note.zip(rows) {
                *noted = rows[*row];
            }
            self.count += 1;
        }
    }

    /// Which note of a step's row `row` is; none if nobody asks for it.
    pub fn place_of(&self, row: usize) -> Option<usize> {
        (*self.which.get(row)? as usize).checked_sub(1)
    }

    /// All notes of step `step`.
    pub fn of_step(&self, step: usize) -> &[Note] {
        let count = self.asked.len();
        self.kept.get(step * count..).and_then(|rest| rest.get(..count)).unwrap_or_default()
    }

    /// Row `row` at the end of step `step`.
    pub fn at(&self, step: usize, row: usize) -> Option<[&Row; 3]> {
        self.of_step(step).get(self.place_of(row)?).map(Note::each_ref)
    }
}
