//! Fixed steps, and what may be done about kinks besides error control.

use hertzscope::chain::{Chain, ChainSystem};
use hertzscope::integrate::System;

/// Contacts whose sides change more slowly than this share of the striker's speed are no events: without a threshold a chain without preload
/// chatters (1).
const SLOWEST: f64 = 1e-4;
/// An event is found to this share of a step (1), or after so many tries.
const FOUND: f64 = 1e-10;
const MOST_TRIES: u32 = 30;
/// About as long as a collision of the bench's beads (s).
const COLLISION: f64 = 30e-6;
/// What is left to the end is rounding, as a share of the end's time (1).
const LEFT: f64 = 1e-12;
/// The striker's contact, and into how many steps of its own a drift of all is cut while it is closed.
const STRIKERS: usize = 1;
const SUBSTEPS: u32 = 4;
/// Fractions of PEFRL (I. P. Omelyan, I. M. Mryglod, R. Folk, Comput. Phys. Commun. 146, 188 (2002)).
const XI: f64 = 0.178_617_895_844_809_1;
const LAMBDA: f64 = -0.212_341_831_062_605_4;
const CHI: f64 = -0.066_264_582_669_818_5;

/// Which contacts push.
#[derive(Clone, Copy, PartialEq)]
enum Which {
    All,
    Strikers,
    Others,
}

/// A chain in motion.
#[derive(Clone)]
pub struct Motion<'a> {
    chain: &'a Chain,
    /// What the loads accelerate bodies by that nothing holds (m/s²).
    loads: Vec<f64>,
    x: Vec<f64>,
    pub v: Vec<f64>,
    /// Evaluations of all forces; of one contact alone its share of one.
    pub evaluations: f64,
}

impl<'a> Motion<'a> {
    pub fn new(chain: &'a Chain, velocities: &[f64]) -> Self {
        let x = vec![0.0; velocities.len()];
        let mut loads = x.clone();
        ChainSystem::new(chain, velocities).accelerations(&x, &x, &mut loads);
        Self { chain, loads, x, v: velocities.to_vec(), evaluations: 0.0 }
    }

    /// Overlap of contact `j` at positions `x` (m).
    fn overlap(&self, x: &[f64], j: usize) -> f64 {
        self.chain.contacts()[j].static_overlap + self.chain.overlap_change(x, j)
    }

    #[allow(clippy::cast_precision_loss, reason = "a few dozen contacts")]
    fn accelerations(&mut self, x: &[f64], which: Which) -> Vec<f64> {
        let contacts = self.chain.contacts();
        let counts = |j: &usize| match which {
            Which::All => true,
            Which::Strikers => *j == STRIKERS,
            Which::Others => *j != STRIKERS,
        };
        let mut a = vec![0.0; x.len()];
        for j in (0..contacts.len()).filter(counts).filter(|j| contacts[*j].stiffness > 0.0) {
            let force = contacts[j].force_change(self.chain.overlap_change(x, j));
            if let Some(above) = j.checked_sub(1) {
                a[above] -= force;
            }
            if let Some(below) = a.get_mut(j) {
                *below += force;
            }
        }
        for ((a, body), load) in a.iter_mut().zip(self.chain.bodies()).zip(&self.loads) {
            *a = *a / body.mass + if which == Which::Strikers { 0.0 } else { *load };
        }
        let one = 1.0 / contacts.len() as f64;
        self.evaluations += if which == Which::Strikers { one } else { 1.0 };
        a
    }

    fn drift(&mut self, time: f64) {
        self.x.iter_mut().zip(&self.v).for_each(|(x, v)| *x += time * v);
    }

    fn kick(&mut self, time: f64, which: Which) {
        let a = self.accelerations(&self.x.clone(), which);
        self.v.iter_mut().zip(a).for_each(|(v, a)| *v += time * a);
    }

    /// A step of PEFRL whose drifts and kicks are these.
    fn pefrl(&mut self, h: f64, drift: &dyn Fn(&mut Self, f64), which: Which) {
        let middle = 1.0 - 2.0 * (CHI + XI);
        let (outer, inner) = (0.5 * (1.0 - 2.0 * LAMBDA) * h, LAMBDA * h);
        let parts = [XI, CHI, middle, CHI, XI];
        for (part, kick) in parts.into_iter().zip([outer, inner, inner, outer, 0.0]) {
            drift(self, part * h);
            if kick != 0.0 {
                self.kick(kick, which);
            }
        }
    }

    /// A classical Runge-Kutta step of `length`: in the time itself, or from `root` on in its square root.
    fn runge_kutta(&mut self, length: f64, root: Option<f64>) {
        let (x, v) = (self.x.clone(), self.v.clone());
        let mut slope = (vec![0.0; x.len()], vec![0.0; x.len()]);
        for (part, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let reach = part * length;
            let at = |start: &[f64], slope: &[f64]| -> Vec<f64> {
                start.iter().zip(slope).map(|(start, slope)| start + reach * slope).collect()
            };
            let here = (at(&x, &slope.0), at(&v, &slope.1));
            let rate = root.map_or(1.0, |root| 2.0 * (root + reach));
            slope.1 = self.accelerations(&here.0, Which::All);
            slope.0 = here.1;
            slope.0.iter_mut().chain(&mut slope.1).for_each(|slope| *slope *= rate);
            let share = weight * length / 6.0;
            self.x.iter_mut().zip(&slope.0).for_each(|(x, slope)| *x += share * slope);
            self.v.iter_mut().zip(&slope.1).for_each(|(v, slope)| *v += share * slope);
        }
    }

    /// The contact, of those that have changed sides since `before` fast enough, whose overlap says it was the first, other than `last`.
    fn event(&self, before: &Self, last: Option<usize>) -> Option<usize> {
        let fastest = before.v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let ends = |j: usize| [before, self].map(|motion| motion.overlap(&motion.x, j));
        let share = |j: &usize| {
            let [from, to] = ends(*j);
            from / (from - to)
        };
        let changed = |j: &usize| {
            let [from, to] = ends(*j);
            let closing = before.chain.overlap_change(&before.v, *j).abs();
            from * to < 0.0 && closing > SLOWEST * fastest && Some(*j) != last
        };
        let contacts = self.chain.contacts();
        let real = (0..contacts.len()).filter(|j| contacts[*j].stiffness > 0.0);
        real.filter(changed).min_by(|a, b| share(a).total_cmp(&share(b)))
    }

    /// Goes on by so much of `whole` (s), which it has gone since `before`, that contact `j` has no overlap: false position, a step from the start each
    /// time. How much that is (s).
    fn cut(&mut self, before: &Self, j: usize, whole: f64, step: &dyn Fn(&mut Self, f64)) -> f64 {
        let (mut low, mut high) = (0.0, whole);
        let [mut at_low, mut at_high] = [before, &*self].map(|motion| motion.overlap(&motion.x, j));
        let mut time = whole;
        for _ in 0..MOST_TRIES {
            time = (low * at_high - high * at_low) / (at_high - at_low);
            *self = Self { evaluations: self.evaluations, ..before.clone() };
            step(self, time);
            let found = self.overlap(&self.x, j);
            if found * at_high > 0.0 {
                (high, at_high, at_low) = (time, found, 0.5 * at_low);
            } else {
                (low, at_low, at_high) = (time, found, 0.5 * at_high);
            }
            if high - low < FOUND * whole || found == 0.0 {
                break;
            }
        }
        time
    }
}

/// A method of fixed steps and what is done about kinks.
#[derive(Clone, Copy)]
pub enum Fixed {
    Pefrl,
    PefrlSubsteps,
    RungeKutta,
    RungeKuttaEvents,
    RungeKuttaSquareRoot,
}

impl Fixed {
    pub const ALL: [(&'static str, Self); 5] = [
        ("PEFRL, fixed steps", Self::Pefrl),
        ("the same, the striker's contact in shorter steps of its own", Self::PefrlSubsteps),
        ("Runge-Kutta 4, fixed steps", Self::RungeKutta),
        ("the same, steps end where contacts open and close", Self::RungeKuttaEvents),
        ("the same, and in square-root time from there on", Self::RungeKuttaSquareRoot),
    ];

    /// So many steps up to `end` (s), and where events cut them more.
    pub fn run(self, motion: &mut Motion, steps: u32, end: f64) {
        let length = end / f64::from(steps);
        let shorter = |motion: &mut Motion, time: f64| {
            // Open, it has no force that would be worth a look.
            let count = if motion.overlap(&motion.x, STRIKERS) > 0.0 { SUBSTEPS } else { 1 };
            for _ in 0..count {
                motion.pefrl(time / f64::from(count), &Motion::drift, Which::Strikers);
            }
        };
        for _ in 0..steps {
            match self {
                Self::Pefrl => motion.pefrl(length, &Motion::drift, Which::All),
                Self::PefrlSubsteps => motion.pefrl(length, &shorter, Which::Others),
                Self::RungeKutta => motion.runge_kutta(length, None),
                Self::RungeKuttaEvents => return with_events(motion, (length, end), None),
                Self::RungeKuttaSquareRoot => {
                    return with_events(motion, (length, end), Some(COLLISION));
                }
            }
        }
    }
}

/// Steps of at most `longest` up to `end` (s), cut where contacts open and close; from there on in the root of the time, in steps that are as long once
/// as much time as `collision` has passed (s).
fn with_events(motion: &mut Motion, (longest, end): (f64, f64), collision: Option<f64>) {
    let (mut time, mut origin, mut last) = (0.0, 0.0, None);
    while end - time > LEFT * end {
        // The root of the time since the last event, and the time that an even step of it takes.
        let root = collision.map(|_| f64::sqrt((time - origin).max(0.0)));
        let even = root.zip(collision).map_or(longest, |(root, collision)| {
            let step = (longest / collision.sqrt()).min(longest / (2.0 * root));
            (2.0 * root + step) * step
        });
        let whole = even.min(end - time);
        let step = |motion: &mut Motion, time: f64| {
            let length = root.map_or(time, |root| (root * root + time).sqrt() - root);
            motion.runge_kutta(length, root);
        };
        let before = motion.clone();
        step(motion, whole);
        last = motion.event(&before, last);
        time += last.map_or(whole, |j| motion.cut(&before, j, whole, &step));
        origin = if last.is_some() { time } else { origin };
    }
}
