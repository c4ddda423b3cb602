//! Eight chains side by side, one in each lane: under a pair each with a step of its own, under a splitting in step with each other.
//!
//! Lanes never see each other: a chain's results are the same to the last bit whatever its neighbours are.

mod lane;
mod paced;
mod paired;
mod progress;
mod split;
mod trail;
mod watched;

use std::marker::PhantomData;

use super::dispatch::{InstructionSet, dispatch};
use super::lanes::{Row, WIDTH};
use super::layout::Across;
use super::notes::Notes;
use super::plan::{Form, Plan, shared_stiffness};
use super::steps::{AT_ONCE, find_gradients, finest_asked};
use super::tasks::{Evaluate, Settle};
use super::workspace::Workspace;
use crate::chain::Chain;
use crate::integrate::{IntegrateError, Scheme, Work};
use lane::Lane;
use paced::InSteps;
use paired::Paired;
use progress::Progress;
use split::Split;
pub use trail::{GroupTrail, Look};

/// How steps are taken.
enum Drive {
    Paired(Box<Paired>, Vec<Lane>),
    Split(Split),
    Paced(Box<InSteps>),
}

impl Drive {
    /// Starts and lengths of the steps that lanes took `before` the last, and at once with those (s).
    fn last_steps(&self, before: usize) -> (Row, Row) {
        match self {
            Self::Paired(_, lanes) => {
                let (mut starts, mut lengths) = (Row::default(), Row::default());
                for (index, lane) in lanes.iter().enumerate() {
                    (starts.0[index], lengths.0[index]) = lane.progress.last_step;
                }
                (starts, lengths)
            }
            Self::Split(split) => {
                let (start, length) = split.last_step(before);
                (Row([start; WIDTH]), Row([length; WIDTH]))
            }
            Self::Paced(paced) => paced.last_steps(before),
        }
    }

    /// Rows that it goes by.
    fn asks(&self) -> impl Iterator<Item = usize> {
        let paced = if let Self::Paced(paced) = self { Some(paced) } else { None };
        paced.into_iter().flat_map(|paced| paced.asks())
    }

    /// How far lane `index` is, where each has steps of its own.
    fn progress(&self, index: usize) -> Option<&Progress> {
        match self {
            Self::Paired(_, lanes) => lanes.get(index).map(|lane| &lane.progress),
            Self::Paced(paced) => paced.progress(index),
            Self::Split(_) => None,
        }
    }
}

/// Up to eight lossless chains with the same number of bodies under a method for forces that depend on positions alone.
pub struct ChainGroup {
    set: InstructionSet,
    drive: Drive,
    work: Workspace,
    plan: Plan,
}

/// One chain to be put into a group.
#[derive(Debug, Clone, Copy)]
pub struct Member<'a> {
    /// The chain.
    pub chain: &'a Chain,
    /// Initial velocities of its bodies (m/s).
    pub velocities: &'a [f64],
    /// How long it is followed (s).
    pub duration: f64,
}

/// A bit for each lane.
fn bits(lanes: [bool; WIDTH]) -> u8 {
    lanes.iter().enumerate().fold(0, |bits, (lane, is)| bits | u8::from(*is) << lane)
}

/// What the chains of a group have in common, apart from their scheme.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    contacts: usize,
    form: Form,
    /// Bits of the duration in fixed steps, in which all are at the same time (s).
    duration: Option<u64>,
    /// Whether the chain's contacts share a stiffness that its steps make use of.
    alike: bool,
}

impl Kind {
    /// That of `member` under `scheme`.
    #[must_use]
    pub fn of(member: &Member<'_>, scheme: Scheme) -> Self {
        let Member { chain, velocities, duration } = member;
        let form = Form::needed(chain, velocities, finest_asked(scheme));
        let fixed = matches!(scheme, Scheme::Splitting(..));
        let duration = fixed.then_some(duration.to_bits());
        let alike = shared_stiffness(chain, scheme, form).is_some();
        Self { contacts: chain.contacts().len(), form, duration, alike }
    }
}

impl ChainGroup {
    /// Lanes of a group.
    pub const LANES: usize = WIDTH;

    /// Starts `scheme` on up to [`Self::LANES`] members of one kind.
    #[must_use]
    pub fn new(members: &[Member<'_>], scheme: Scheme, set: InstructionSet) -> Self {
        Self::begin(members, scheme, (set, Plan::default(), Workspace::default()))
    }

    /// The same with others, and in the same memory.
    #[must_use]
    pub fn again(self, members: &[Member<'_>], scheme: Scheme) -> Self {
        Self::begin(members, scheme, (self.set, self.plan, self.work))
    }

    fn begin(
        members: &[Member<'_>],
        scheme: Scheme,
        (set, mut plan, mut work): (InstructionSet, Plan, Workspace),
    ) -> Self {
        let members = &members[..members.len().min(WIDTH)];
        debug_assert!(
            members.windows(2).all(|two| Kind::of(&two[0], scheme) == Kind::of(&two[1], scheme)),
            "members are of one kind"
        );
        let chains: Vec<&Chain> = members.iter().map(|member| member.chain).collect();
        let form = members.first().map_or(Form::Plain, |first| Kind::of(first, scheme).form);
        plan.across(&chains, scheme, (set, form));
        dispatch(set, Settle::<Across>(&mut plan, PhantomData));
        work.rest(plan.rows(), scheme);
        for (lane, member) in members.iter().enumerate() {
            for (row, velocity) in work.now.parts().velocity.iter_mut().zip(member.velocities) {
                row.0[lane] = *velocity;
            }
        }
        dispatch(set, Evaluate::<Across>::at(&plan, &mut work.now));
        let drive = match scheme {
            Scheme::Pair(pair, tolerance) => {
                let lane = |(lane, member): (usize, &Member<'_>)| {
                    let watched = plan.watched.iter().any(|watched| watched.at.1 == lane);
                    Lane::new(member, pair, watched)
                };
                let lanes = members.iter().enumerate().map(lane).collect();
                Drive::Paired(Box::new(Paired::new(pair, tolerance, plan.rows())), lanes)
            }
            Scheme::Splitting(method, step) => {
                find_gradients::<Across>(set, method, (&plan, &mut work));
                let end = members.first().map_or(0.0, |first| first.duration);
                Drive::Split(Split::new(method, (step, end), members.len()))
            }
            Scheme::Paced(method, tolerance) => {
                find_gradients::<Across>(set, method, (&plan, &mut work));
                Drive::Paced(Box::new(InSteps::new(method, tolerance, members, &work.now)))
            }
        };
        Self { set, drive, work, plan }
    }

    /// Whether every lane has come to its end, or failed.
    #[must_use]
    pub fn is_done(&self) -> bool {
        if let Drive::Split(split) = &self.drive {
            return split.is_done();
        }
        let mut all = (0..WIDTH).filter_map(|lane| self.drive.progress(lane));
        all.all(|progress| !progress.is_moving())
    }

    /// Tries a step in every lane that is still moving, or up to `most` that are of one length, of which `notes` are kept; tells how many, and which
    /// lanes have taken theirs.
    fn step(&mut self, most: usize, notes: &mut Notes) -> (usize, [bool; WIDTH]) {
        let Self { set, plan, work, drive, .. } = self;
        match drive {
            Drive::Paired(paired, lanes) => {
                let mut step = Row::default();
                for (lane, h) in lanes.iter_mut().zip(&mut step.0) {
                    *h = lane.choose();
                }
                (1, paired.step(*set, plan, (work, lanes), step))
            }
            Drive::Split(split) => split.step((*set, plan, work), most, notes),
            Drive::Paced(paced) => paced.step((*set, plan, work), most, notes),
        }
    }

    /// Steps up to the ends of all lanes, unseen: for those who want nothing but where they lead.
    pub fn advance(&mut self) {
        let mut notes = Notes::default();
        let most = AT_ONCE as usize;
        notes.ask(most - 1, self.drive.asks());
        while !self.is_done() {
            notes.clear();
            self.step(most, &mut notes);
        }
    }

    /// What lane `index` has cost, or why it failed.
    ///
    /// # Errors
    /// [`IntegrateError`] where the error control could not go on.
    pub fn outcome(&self, index: usize) -> Result<Work, IntegrateError> {
        if let Drive::Split(split) = &self.drive {
            return split.outcome(index);
        }
        self.drive.progress(index).map_or(Ok(Work::default()), Progress::outcome)
    }
}
