//! What a watched place in each lane has felt at the ends of steps.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::trail::GroupTrail;
use crate::chain::ForceProbe;
use crate::chain::stepper::around::{Around, BODIES, Bodies};
use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
use crate::chain::stepper::lanes::{Lanes, Row, Task, WIDTH};
use crate::chain::stepper::plan::Form;
use crate::chain::stepper::seen::Seen;
use crate::chain::stepper::wanted::Asked;

/// Which of the bodies around a place is its own.
const MIDDLE: usize = BODIES / 2;

/// A watched place in each lane, or none.
#[derive(Debug, Clone, Default)]
pub struct Watched {
    /// Lanes that have one, a bit each.
    lanes: u8,
    /// Lanes that have not taken a step yet: their first is looked into whatever is asked, for a place may start with a rate of change that is
    /// nothing but rounding.
    first: u8,
    pub around: Around,
    /// Whether it is around the same body in all lanes.
    alike: bool,
    /// How the bodies around it stood and moved before the first step and at the end of each.
    pub noted: Box<[Bodies; GroupTrail::STEPS + 1]>,
    /// Dynamic forces (N) and their rates of change (N/s) at the end of each step.
    ends: [[Row; 2]; GroupTrail::STEPS],
    /// The same at the end of the last step that was glanced at, as somebody felt it who has looked closer.
    felt: [Row; 2],
    /// What is asked of each lane.
    pub asked: Asked,
    pub seen: Box<Seen>,
}

impl Watched {
    /// Has it be the places of each lane's probe in chains that compute forces in `form`, at rest; nothing is asked yet.
    pub fn begin<'a>(&mut self, form: Form, probes: impl Iterator<Item = Option<&'a ForceProbe>>) {
        (self.lanes, self.first) = (0, u8::MAX);
        (self.around.form, self.asked, self.felt) = (form, Asked::default(), Default::default());
        for (lane, probe) in probes.enumerate().take(WIDTH) {
            let Some(probe) = probe else { continue };
            if self.lanes == 0 {
                // Lanes that have none are taken along.
                (0..WIDTH).for_each(|lane| self.around.put(lane, probe));
            }
            self.lanes |= 1 << lane;
            self.around.put(lane, probe);
        }
        let above = |lane| self.around.body(lane, MIDDLE);
        self.alike = (1..WIDTH).all(|lane| above(lane) == above(0));
    }

    /// The bodies around the places.
    pub fn bodies(&self) -> impl Iterator<Item = usize> {
        let lanes = if self.alike { 1 } else { WIDTH };
        let around = (0..lanes).flat_map(|lane| (0..BODIES).map(move |index| (lane, index)));
        around.filter_map(|(lane, index)| self.around.body(lane, index))
    }

    /// Notes how the bodies around the places stand and move, `of` each body, nothing where there is none.
    pub fn note<'a>(
        &mut self,
        set: InstructionSet,
        step: usize,
        of: impl Fn(usize) -> Option<[&'a Row; 3]>,
    ) {
        let Self { around, alike, noted, .. } = self;
        let of = |lane, index| around.body(lane, index).and_then(&of);
        let noted = &mut noted[step];
        if *alike {
            dispatch(set, Keep { rows: std::array::from_fn(|index| of(0, index)), noted });
            return;
        }
        for (index, lane) in (0..BODIES).flat_map(|index| (0..WIDTH).map(move |lane| (index, lane)))
        {
            let rows = of(lane, index);
            for (part, noted) in noted.iter_mut().enumerate() {
                noted[index].0[lane] = rows.map_or(0.0, |rows| rows[part].0[lane]);
            }
        }
    }

    /// Takes force (N) and rate of change (N/s) at the end of lane `lane`'s last step from somebody who has looked closer.
    pub fn correct(&mut self, lane: usize, felt: [f64; 2]) {
        for (row, value) in self.felt.iter_mut().zip(felt) {
            row.0[lane] = value;
        }
    }
}

/// Keeps rows, of nothing where there are none.
struct Keep<'a> {
    rows: [Option<[&'a Row; 3]>; BODIES],
    noted: &'a mut Bodies,
}

impl Task for Keep<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        for (index, rows) in self.rows.into_iter().enumerate() {
            for (part, noted) in self.noted.iter_mut().enumerate() {
                let row = match rows {
                    Some(rows) => L::load(rows[part]),
                    None => L::splat(0.0),
                };
                L::store(row, &mut noted[index]);
            }
        }
    }
}

/// Feels the ends of all steps that are noted.
pub struct Feel<'a> {
    pub watched: &'a mut Watched,
    pub count: usize,
}

impl Task for Feel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Watched { around, noted, ends, .. } = self.watched;
        for (end, [position, velocity, _]) in ends.iter_mut().zip(&noted[1..=self.count]) {
            let above = [across::<L>(position, 0), across::<L>(velocity, 0)];
            let below = [across::<L>(position, 1), across::<L>(velocity, 1)];
            let [force, rate] = around.feel::<L>([above, below]);
            L::store(force, &mut end[0]);
            L::store(rate, &mut end[1]);
        }
    }
}

/// How much more the body above contact `which` of the places has than the one below.
#[inline(always)]
fn across<L: Lanes>(rows: &[Row; BODIES], which: usize) -> L::V {
    let above = MIDDLE - 1 + which;
    L::sub(L::load(&rows[above]), L::load(&rows[above + 1]))
}

/// Takes glances at the ends of steps, up to one that holds what is asked for.
pub struct Glance<'a> {
    pub watched: &'a mut Watched,
    /// The first step, and the one behind the last.
    pub steps: [usize; 2],
    /// Starts and lengths of all that are noted (s).
    pub times: &'a [(Row, Row); GroupTrail::STEPS],
    /// Lanes that have taken each, a bit each.
    pub taken: &'a [u8; GroupTrail::STEPS],
}

/// What a glance tells.
pub struct Wanted {
    /// A step that holds what is asked for, or may.
    pub step: usize,
    /// Lanes in which it does, a bit each.
    pub lanes: u8,
    /// Force and its rate of change where it starts (N, N/s).
    pub before: [Row; 2],
}

impl Task for Glance<'_> {
    type Output = Option<Wanted>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<Wanted> {
        let Self { watched, steps: [from, to], times, taken } = self;
        let Watched { lanes, first, ends, felt, asked, .. } = watched;
        let mut before = [L::load(&felt[0]), L::load(&felt[1])];
        let mut found = None;
        for step in from..to {
            let taken = taken[step] & *lanes;
            let end = [L::load(&ends[step][0]), L::load(&ends[step][1])];
            let wanted = taken & (asked.wanted::<L>(before, end, L::load(&times[step].1)) | *first);
            *first &= !taken;
            let started = before;
            before = [L::select(taken, end[0], before[0]), L::select(taken, end[1], before[1])];
            if wanted != 0 {
                found = Some((step, wanted, started));
                break;
            }
        }
        L::store(before[0], &mut felt[0]);
        L::store(before[1], &mut felt[1]);
        let (step, lanes, started) = found?;
        let mut before = [Row::default(); 2];
        L::store(started[0], &mut before[0]);
        L::store(started[1], &mut before[1]);
        Some(Wanted { step, lanes, before })
    }
}
