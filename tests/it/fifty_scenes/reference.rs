//! A solver of its own for chains of Hertz contacts: nothing here is taken from the library.
//!
//! Forces follow from the numbers of a [`Setup`]. Motion is integrated by the extrapolated modified
//! midpoint rule (W. B. Gragg, SIAM J. Numer. Anal. 2, 384, 1965; R. Bulirsch, J. Stoer, Numer.
//! Math. 8, 1, 1966) with the step numbers 2, 4, 6, ...; steps are shortened until columns of the
//! table agree. Where a contact with a jumping force opens or closes, a step ends there. Readings
//! are found by integrating again from the start of a step to any point within it, so that they are
//! as exact as the steps.

use super::setup::{Bead, End, Law, Setup};

/// Rows of the extrapolation table.
const ROWS: usize = 8;
/// Fewest rows before a step may be accepted.
const FEWEST_ROWS: usize = 3;
/// Factor by which a step shrinks that has not converged (1).
const SHRINK: f64 = 0.35;
/// Factor by which steps grow after one that converged early (1).
const GROWTH: f64 = 2.0;
/// Share of the way to an event that is tried where the whole way does not converge (1).
const APPROACH: f64 = 0.6;
/// Relative width of a bracket that is enough to see whether a step to an event converges (1).
const ROUGH_WIDTH: f64 = 1e-3;
/// A body is followed as exactly as the fastest if it has this share of its speed, or more (1).
const SMALLEST_SHARE: f64 = 1e-3;
/// Changes of sign below this share of the scale are rounding (1).
const GRAIN: f64 = 1e-13;
/// Iterations of a bracketing root search: each at least halves the bracket every third time.
const ROOT_ITERATIONS: usize = 120;
/// Relative width of a bracket that counts as a root (1).
const ROOT_WIDTH: f64 = 1e-15;
/// Share of the largest force that a local maximum must exceed to be the first peak (1).
const PEAK_SHARE: f64 = 0.25;
/// A jump below this share of the largest force is the error of two steps where they meet (1).
const SMALLEST_JUMP: f64 = 1e-6;
/// Parts of a step in which turns are looked for where there may be two (1).
const LOOKS: usize = 8;
/// Share of the smaller rate at the ends below which a force may turn twice within a step (1).
const CLOSE_TO_TURNING: f64 = 0.7;
/// Steps after which a run is given up.
const STEP_LIMIT: usize = 4_000_000;

/// Control of a reference run.
#[derive(Debug, Clone, Copy)]
pub struct Control {
    /// Local error tolerated in a step, relative to the body's largest speed so far, and to a like
    /// share of the largest overlap (1).
    pub tolerance: f64,
    /// Longest step, as a phase of the fastest contact (rad).
    pub phase: f64,
}

/// What a place feels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Dynamic force of the first peak (N).
    pub force: f64,
    /// Time of the first peak (s).
    pub time: f64,
    /// Time when the force first reaches half of it (s).
    pub half_rise: f64,
}

/// A contact; contact `j` lies between bodies `j - 1` and `j`.
#[derive(Debug, Clone, Copy, Default)]
struct Contact {
    /// `A` in `F = A d^1.5`; 0 where nothing touches (N/m^1.5).
    stiffness: f64,
    /// Static force (N) and overlap (m).
    force: f64,
    overlap: f64,
    /// Dashpot (N s/m), Kuwabara-Kono time (s), power law: force at 1 m/s (N) and exponent (1).
    dashpot: f64,
    eta: f64,
    power: (f64, f64),
}

impl Contact {
    fn jumps(&self) -> bool {
        self.dashpot > 0.0 || self.power.0 > 0.0
    }

    fn is_lossy(&self) -> bool {
        self.jumps() || self.eta > 0.0
    }
}

/// Where a force loses smoothness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Event {
    /// The overlap passes zero.
    Touches,
    /// The closing speed passes zero: a power law has no second derivative there.
    Turns,
    /// The force passes zero where a contact never pulls.
    Pulls,
}

/// A place whose force is read: weights of two contacts.
#[derive(Debug, Clone, Copy)]
struct Place {
    contacts: [usize; 2],
    weights: [f64; 2],
}

/// The equations of motion. A state holds displacements from rest (m), then velocities (m/s).
pub struct System {
    mass: Vec<f64>,
    /// Acceleration of a body that static contacts do not balance: the striker's (m/s²).
    free_fall: Vec<f64>,
    contacts: Vec<Contact>,
    zero_force: bool,
    places: Vec<Place>,
    start: Vec<f64>,
    duration: f64,
}

/// `A` of the contact of two faces by their moduli, ratios and curvatures (N/m^1.5).
fn stiffness(upper: (f64, f64, f64), lower: (f64, f64, f64)) -> f64 {
    let compliance = |(modulus, ratio, _): (f64, f64, f64)| (1.0 - ratio * ratio) / modulus;
    let modulus = 1.0 / (compliance(upper) + compliance(lower));
    let radius = 1.0 / (upper.2 + lower.2);
    assert!(radius.is_finite(), "two flat faces");
    4.0 / 3.0 * modulus * radius.sqrt()
}

impl System {
    pub fn new(setup: &Setup) -> Self {
        let (bodies, first) = (setup.bodies(), setup.first());
        let n = bodies.len();
        // Loads on the bodies, and what each contact bears: the sum of the loads above it.
        let mut loads: Vec<f64> = bodies.iter().map(|bead| bead.mass * setup.gravity).collect();
        if let Some((particle, force)) = setup.magnet {
            loads[particle - 1 + first] += force;
        }
        let top = match setup.top {
            End::Free => 0.0,
            End::Force(force) | End::Wall(_, force) => force,
        };
        let mut free_fall = vec![0.0; n];
        if first == 1 {
            free_fall[0] = setup.gravity;
            loads[0] = 0.0;
            loads[1] += top;
        }
        let face = |bead: &Bead| (bead.material.modulus, bead.material.ratio, bead.curvature());
        let wall = |end: End| match end {
            End::Wall(material, _) => Some((material.modulus, material.ratio, 0.0)),
            _ => None,
        };
        let mut contacts = vec![Contact::default(); n + 1];
        let mut bears = if first == 1 { 0.0 } else { top };
        for j in 0..=n {
            if j > 0 {
                bears += loads[j - 1];
            }
            let upper = if j == 0 { wall(setup.top) } else { Some(face(&bodies[j - 1])) };
            let lower = if j == n { wall(setup.bottom) } else { Some(face(&bodies[j])) };
            contacts[j].force = bears;
            if let (Some(upper), Some(lower)) = (upper, lower) {
                let a = stiffness(upper, lower);
                contacts[j].stiffness = a;
                contacts[j].overlap = (bears / a).powf(2.0 / 3.0);
                for loss in &setup.losses {
                    let own = loss.single.iter().find(|(contact, _)| *contact == j);
                    let coefficient = own.map_or(loss.coefficient, |(_, coefficient)| *coefficient);
                    match loss.law {
                        Law::Dashpot => contacts[j].dashpot = coefficient,
                        Law::KuwabaraKono => contacts[j].eta = coefficient,
                        Law::Power(exponent) => contacts[j].power = (coefficient, exponent),
                    }
                }
            }
        }
        let mut places: Vec<Place> = setup
            .sensors
            .iter()
            .map(|(particle, offset)| {
                let body = particle - 1 + first;
                Place { contacts: [body, body + 1], weights: [0.5 - offset, 0.5 + offset] }
            })
            .collect();
        if matches!(setup.bottom, End::Wall(..)) {
            places.push(Place { contacts: [n, n], weights: [0.0, 1.0] });
        }
        let mut start = vec![0.0; 2 * n];
        if let Some((_, speed)) = setup.striker {
            start[n] = speed;
        }
        for (particle, velocity) in &setup.velocities {
            start[n + particle - 1 + first] = *velocity;
        }
        let mass = bodies.iter().map(|bead| bead.mass).collect();
        let (zero_force, duration) = (setup.zero_force, setup.duration);
        Self { mass, free_fall, contacts, zero_force, places, start, duration }
    }

    /// Growth of contact `j`'s overlap over the static one (m).
    fn growth(&self, state: &[f64], j: usize) -> f64 {
        let n = self.mass.len();
        let upper = if j == 0 { 0.0 } else { state[j - 1] };
        let lower = if j == n { 0.0 } else { state[j] };
        upper - lower
    }

    /// Rate of contact `j`'s overlap (m/s).
    fn closing(&self, state: &[f64], j: usize) -> f64 {
        let n = self.mass.len();
        let upper = if j == 0 { 0.0 } else { state[n + j - 1] };
        let lower = if j == n { 0.0 } else { state[n + j] };
        upper - lower
    }

    fn overlap(&self, state: &[f64], j: usize) -> f64 {
        self.contacts[j].overlap + self.growth(state, j)
    }

    /// Change of contact `j`'s force over the static one if it may pull (N).
    fn unheld(&self, state: &[f64], closed: &[bool], j: usize) -> f64 {
        let contact = &self.contacts[j];
        if contact.stiffness == 0.0 {
            return 0.0;
        }
        let growth = self.growth(state, j);
        let overlap = contact.overlap + growth;
        let (now, rest) = (overlap.max(0.0).sqrt(), contact.overlap.sqrt());
        // s^3 - r^3 = (s - r)(s^2 + s r + r^2), s - r = (s^2 - r^2)/(s + r).
        let mut change = if overlap <= 0.0 {
            -contact.force
        } else {
            contact.stiffness * growth / (now + rest) * (now * now + now * rest + rest * rest)
        };
        if !contact.is_lossy() {
            return change;
        }
        let closing = self.closing(state, j);
        change += 1.5 * contact.stiffness * contact.eta * now * closing;
        if closed[j] {
            let (at_one, exponent) = contact.power;
            change += contact.dashpot * closing;
            if at_one > 0.0 {
                change += at_one * closing.abs().powf(exponent) * closing.signum();
            }
        }
        change
    }

    /// Change of contact `j`'s force over the static one (N), and whether it is held at zero.
    fn force(&self, state: &[f64], closed: &[bool], j: usize) -> (f64, bool) {
        let contact = &self.contacts[j];
        let change = self.unheld(state, closed, j);
        let held = contact.is_lossy() && self.zero_force && contact.force + change < 0.0;
        (if held { -contact.force } else { change }, held)
    }

    /// Derivative of the state.
    fn derivative(&self, state: &[f64], closed: &[bool], out: &mut [f64]) {
        let n = self.mass.len();
        out[..n].copy_from_slice(&state[n..]);
        let (mut above, _) = self.force(state, closed, 0);
        for i in 0..n {
            let (below, _) = self.force(state, closed, i + 1);
            out[n + i] = self.free_fall[i] + (above - below) / self.mass[i];
            above = below;
        }
    }

    /// Force of a place (N) and its rate of change (N/s).
    fn feel(&self, place: &Place, state: &[f64], closed: &[bool]) -> (f64, f64) {
        let n = self.mass.len();
        let mut derivative = vec![0.0; 2 * n];
        self.derivative(state, closed, &mut derivative);
        let (mut force, mut rate) = (0.0, 0.0);
        for (j, weight) in place.contacts.into_iter().zip(place.weights) {
            let contact = &self.contacts[j];
            let (change, held) = self.force(state, closed, j);
            force += weight * change;
            if held || contact.stiffness == 0.0 || weight == 0.0 {
                continue;
            }
            let root = self.overlap(state, j).max(0.0).sqrt();
            let (closing, growing) = (self.closing(state, j), self.closing(&derivative, j));
            let mut slope = 1.5 * contact.stiffness * root * closing;
            if contact.eta > 0.0 && root > 0.0 {
                let viscous = 1.5 * contact.stiffness * contact.eta;
                slope += viscous * (0.5 * closing * closing / root + root * growing);
            }
            if closed[j] {
                let (at_one, exponent) = contact.power;
                slope += contact.dashpot * growing;
                if at_one > 0.0 {
                    slope += at_one * exponent * closing.abs().powf(exponent - 1.0) * growing;
                }
            }
            rate += weight * slope;
        }
        (force, rate)
    }

    /// Longest step that keeps the fastest contact's phase below `phase` (s).
    fn longest_step(&self, state: &[f64], phase: f64) -> f64 {
        let n = self.mass.len();
        let mut fastest = 0.0_f64;
        for (j, contact) in self.contacts.iter().enumerate() {
            let root = self.overlap(state, j).max(0.0).sqrt();
            let inverse = if j == 0 { 0.0 } else { 1.0 / self.mass[j - 1] }
                + if j == n { 0.0 } else { 1.0 / self.mass[j] };
            fastest = fastest.max(1.5 * contact.stiffness * root * inverse);
        }
        // Neighbouring contacts together are at most twice as stiff.
        if fastest > 0.0 { phase / (2.0 * fastest).sqrt() } else { f64::INFINITY }
    }
}

/// Result of a step.
struct Trial {
    state: Vec<f64>,
    /// Rows after which two columns agreed; none if they never did.
    rows: Option<usize>,
}

/// Scales of displacements (m) and velocities (m/s) in the error of a step.
#[derive(Debug, Clone, Copy)]
struct Scales {
    overlap: f64,
    speed: f64,
}

/// One accepted step.
struct Step {
    time: f64,
    length: f64,
    state: Vec<f64>,
    closed: Vec<bool>,
    /// Force and rate at its start and end, for each place.
    ends: Vec<[(f64, f64); 2]>,
}

/// A run.
pub struct Reference {
    system: System,
    steps: Vec<Step>,
    scales: Scales,
    /// Largest speed of each body so far (m/s).
    speeds: Vec<f64>,
    control: Control,
    /// State at the end.
    pub last: Vec<f64>,
}

impl Reference {
    /// Integrates `setup` to its end.
    pub fn run(setup: &Setup, control: Control) -> Self {
        let system = System::new(setup);
        let n = system.mass.len();
        let mut closed: Vec<bool> = vec![true; n + 1];
        let (mut state, mut time) = (system.start.clone(), 0.0);
        let speed = state[n..].iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let mut run = Self {
            steps: Vec::new(),
            scales: Scales { overlap: 0.0, speed },
            speeds: state[n..].iter().map(|v| v.abs()).collect(),
            control,
            last: Vec::new(),
            system,
        };
        let mut length = 1e-9 * run.system.duration;
        while time < run.system.duration {
            assert!(run.steps.len() < STEP_LIMIT, "{}: too many steps", setup.name);
            run.settle_flags(&state, &mut closed);
            let left = run.system.duration - time;
            length = length.min(run.system.longest_step(&state, control.phase)).min(left);
            assert!(length > 1e-24, "{}: no step at {time:e} s", setup.name);
            let mut trial = run.attempt(&state, &closed, length, false);
            let Some(rows) = trial.rows else {
                length *= SHRINK;
                continue;
            };
            // A step ends where a force loses smoothness: an error estimate across such a point may
            // vanish by chance.
            let mut taken = length;
            if let Some((event, near)) = run.first_event(&state, &closed, &trial.state, length) {
                if run.attempt(&state, &closed, near, true).rows.is_none() {
                    length = APPROACH * near;
                    continue;
                }
                taken = run.time_of(&state, &closed, event, (&trial.state, length), ROOT_WIDTH);
                trial = run.attempt(&state, &closed, taken, true);
                length = taken;
            } else if rows < ROWS - 2 {
                length *= GROWTH;
            }
            let next = if taken >= left { run.system.duration } else { time + taken };
            let ends = run.system.places.iter().map(|place| {
                [&state, &trial.state].map(|state| run.system.feel(place, state, &closed))
            });
            let ends = ends.collect();
            let step =
                Step { time, length: taken, state: state.clone(), closed: closed.clone(), ends };
            run.steps.push(step);
            state = trial.state;
            time = next;
            run.scales = run.grown(&state);
            for (most, velocity) in run.speeds.iter_mut().zip(&state[n..]) {
                *most = most.max(velocity.abs());
            }
        }
        run.last = state;
        run
    }

    /// Flags of contacts that are about to open or close at this very instant.
    fn settle_flags(&self, state: &[f64], closed: &mut [bool]) {
        for (j, contact) in self.system.contacts.iter().enumerate() {
            if !contact.jumps() {
                continue;
            }
            let (overlap, closing) = (self.system.overlap(state, j), self.system.closing(state, j));
            let grain = GRAIN * self.scales.overlap;
            if closed[j] && overlap <= grain && closing < 0.0 {
                closed[j] = false;
            } else if !closed[j] && overlap >= -grain && closing > 0.0 {
                closed[j] = true;
            }
        }
    }

    /// A quantity whose sign changes with the event, and the scale below which its sign is
    /// rounding.
    fn margin(&self, state: &[f64], closed: &[bool], (kind, j): (Event, usize)) -> (f64, f64) {
        let (system, Scales { overlap, speed }) = (&self.system, self.scales);
        let contact = &system.contacts[j];
        match kind {
            Event::Touches => (system.overlap(state, j), overlap),
            Event::Turns => (system.closing(state, j), speed),
            Event::Pulls => {
                let free = contact.force + system.unheld(state, closed, j);
                (free, contact.force + contact.stiffness * overlap.powf(1.5))
            }
        }
    }

    /// The first event within a step, and about when (s).
    fn first_event(
        &self,
        state: &[f64],
        closed: &[bool],
        end: &[f64],
        length: f64,
    ) -> Option<((Event, usize), f64)> {
        let system = &self.system;
        let events = system.contacts.iter().enumerate().flat_map(|(j, contact)| {
            let turns = contact.power.0 > 0.0;
            let pulls = contact.is_lossy() && system.zero_force;
            let kinds = [
                (Event::Touches, contact.stiffness > 0.0),
                (Event::Turns, turns),
                (Event::Pulls, pulls),
            ];
            kinds.into_iter().filter(|(_, has)| *has).map(move |(kind, _)| (kind, j))
        });
        let happens = |event: &(Event, usize)| {
            let [(before, scale), (after, _)] =
                [state, end].map(|state| self.margin(state, closed, *event));
            let open = event.0 == Event::Pulls
                && system.overlap(state, event.1).max(system.overlap(end, event.1)) <= 0.0;
            before * after < 0.0 && before.abs().min(after.abs()) > GRAIN * scale && !open
        };
        let found = events
            .filter(happens)
            .map(|event| (event, self.time_of(state, closed, event, (end, length), ROUGH_WIDTH)));
        found.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// When the event happens, to a relative `width` (s).
    fn time_of(
        &self,
        state: &[f64],
        closed: &[bool],
        event: (Event, usize),
        (end, length): (&[f64], f64),
        width: f64,
    ) -> f64 {
        let value = |theta: f64| {
            let state = self.attempt(state, closed, theta * length, false).state;
            self.margin(&state, closed, event).0
        };
        let ends = [state, end].map(|state| self.margin(state, closed, event).0);
        length * root(&value, [(0.0, ends[0]), (1.0, ends[1])], width)
    }

    fn grown(&self, state: &[f64]) -> Scales {
        let n = self.system.mass.len();
        let Scales { mut overlap, mut speed } = self.scales;
        for (j, contact) in self.system.contacts.iter().enumerate() {
            if contact.stiffness > 0.0 && self.system.overlap(state, j) > 0.0 {
                overlap = overlap.max(self.system.growth(state, j).abs());
            }
        }
        for velocity in &state[n..] {
            speed = speed.max(velocity.abs());
        }
        Scales { overlap, speed }
    }

    /// One step of `length` (s) by extrapolation; `sure` wants two rows in turn that agree.
    fn attempt(&self, state: &[f64], closed: &[bool], length: f64, sure: bool) -> Trial {
        let (size, n) = (state.len(), self.system.mass.len());
        let mut start = vec![0.0; size];
        self.system.derivative(state, closed, &mut start);
        // Differences from the start are extrapolated: they have less rounding to amplify.
        let mut table: Vec<Vec<f64>> = Vec::new();
        let [mut at, mut slope] = [vec![0.0; size], vec![0.0; size]];
        let mut agreed = 0;
        for row in 1..=ROWS {
            let count = 2 * row;
            let h = length / count as f64;
            let mut before = vec![0.0; size];
            let mut now: Vec<f64> = start.iter().map(|slope| h * slope).collect();
            for _ in 1..count {
                for i in 0..size {
                    at[i] = state[i] + now[i];
                }
                self.system.derivative(&at, closed, &mut slope);
                for i in 0..size {
                    let next = before[i] + 2.0 * h * slope[i];
                    before[i] = now[i];
                    now[i] = next;
                }
            }
            // Neville's scheme in h^2, the last row overwritten from its left.
            let mut previous = now;
            for column in 0..row - 1 {
                let ratio = (row as f64 / (row - 1 - column) as f64).powi(2);
                let above = std::mem::take(&mut table[column]);
                let next: Vec<f64> = previous
                    .iter()
                    .zip(&above)
                    .map(|(now, above)| now + (now - above) / (ratio - 1.0))
                    .collect();
                table[column] = previous;
                previous = next;
            }
            table.push(previous);
            if row < 2 {
                continue;
            }
            let (best, other) = (&table[row - 1], &table[row - 2]);
            let ended: Vec<f64> = state.iter().zip(best).map(|(y, change)| y + change).collect();
            let scales = self.grown(&ended);
            let mut error = 0.0_f64;
            for i in 0..size {
                let speed = self.speeds[i % n].max(ended[n + i % n].abs());
                let share = (speed / scales.speed).max(SMALLEST_SHARE);
                let scale = share * if i < n { scales.overlap } else { scales.speed };
                let off = (best[i] - other[i]).abs() / scale;
                error = if off.is_finite() { error.max(off) } else { f64::INFINITY };
            }
            agreed = if error <= self.control.tolerance { agreed + 1 } else { 0 };
            if row >= FEWEST_ROWS && agreed > usize::from(sure) {
                return Trial { state: ended, rows: Some(row) };
            }
            if row == ROWS {
                return Trial { state: ended, rows: None };
            }
        }
        unreachable!("the last row returns")
    }

    /// Force and rate at place `place`, a share `theta` into a step.
    fn within(&self, step: &Step, place: usize, theta: f64) -> (f64, f64) {
        let state = self.attempt(&step.state, &step.closed, theta * step.length, false).state;
        self.system.feel(&self.system.places[place], &state, &step.closed)
    }

    /// Number of accepted steps.
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    /// Static forces at all places (N).
    pub fn static_forces(&self) -> Vec<f64> {
        let System { places, contacts, .. } = &self.system;
        let force = |place: &Place| -> f64 {
            let terms = place.contacts.into_iter().zip(place.weights);
            terms.map(|(j, weight)| weight * contacts[j].force).sum()
        };
        places.iter().map(force).collect()
    }

    /// Readings of all places; none where no maximum was felt.
    pub fn readings(&self) -> Vec<Option<Reading>> {
        (0..self.system.places.len()).map(|place| self.reading(place)).collect()
    }

    fn reading(&self, place: usize) -> Option<Reading> {
        let felt = |step: &Step| step.ends[place].map(|(force, _)| force);
        let sampled = self.steps.iter().flat_map(felt).fold(0.0, f64::max);
        // Maxima in the order of time: index of the step, share of it, force.
        let mut maxima: Vec<(usize, f64, f64)> = Vec::new();
        for (index, step) in self.steps.iter().enumerate() {
            let [(before, rising), (after, falling)] = step.ends[place];
            let at_rest = (0.0, 0.0);
            let (last, last_rate) =
                index.checked_sub(1).map_or(at_rest, |last| self.steps[last].ends[place][1]);
            let jumps = before - last > SMALLEST_JUMP * sampled;
            if (jumps || last_rate > 0.0) && rising <= 0.0 {
                maxima.push((index, 0.0, before.max(last)));
            }
            if before.max(after) <= 0.5 * PEAK_SHARE * sampled {
                continue;
            }
            let rate = |theta: f64| self.within(step, place, theta).1;
            let mut looks = vec![(0.0, rising)];
            if may_turn_twice(step.ends[place], step.length) {
                let inner = (1..LOOKS).map(|i| i as f64 / LOOKS as f64);
                looks.extend(inner.map(|theta| (theta, rate(theta))));
            }
            looks.push((1.0, falling));
            for pair in looks.windows(2) {
                if pair[0].1 > 0.0 && pair[1].1 <= 0.0 {
                    let theta = root(&rate, [pair[0], pair[1]], ROOT_WIDTH);
                    maxima.push((index, theta, self.within(step, place, theta).0));
                }
            }
        }
        let largest = maxima.iter().map(|(_, _, force)| *force).fold(sampled, f64::max);
        let (index, theta, force) =
            *maxima.iter().find(|(_, _, force)| *force > PEAK_SHARE * largest)?;
        let time = self.steps[index].time + theta * self.steps[index].length;
        let half_rise = self.reach(place, 0.5 * force, &maxima)?;
        Some(Reading { force, time, half_rise })
    }

    /// When the force at `place` first reaches `level` (N) (s).
    fn reach(&self, place: usize, level: f64, maxima: &[(usize, f64, f64)]) -> Option<f64> {
        for (index, step) in self.steps.iter().enumerate() {
            let [(before, _), (after, _)] = step.ends[place];
            if before >= level {
                return Some(step.time);
            }
            let inside = maxima.iter().find(|(of, theta, _)| *of == index && *theta > 0.0);
            let top = inside.map_or((1.0, after), |(_, theta, force)| (*theta, *force));
            if top.1 >= level {
                let excess = |theta: f64| self.within(step, place, theta).0 - level;
                let theta =
                    root(&excess, [(0.0, before - level), (top.0, top.1 - level)], ROOT_WIDTH);
                return Some(step.time + theta * step.length);
            }
        }
        None
    }
}

/// Whether a force with these values and rates at the ends of a step of `length` (s) may have both
/// a maximum and a minimum within it: the rate of the cubic through them comes closer to zero than
/// at the ends.
fn may_turn_twice([(before, rising), (after, falling)]: [(f64, f64); 2], length: f64) -> bool {
    if (rising > 0.0) != (falling > 0.0) {
        return false;
    }
    let sign = if rising > 0.0 { 1.0 } else { -1.0 };
    // q(t) = q0 + (q1 - q0 - c) t + c t^2 with c = 3 (q0 + q1 - 2 m) has the rates q0 and q1 at the
    // ends and the mean m.
    let mean = (after - before) / length;
    let curve = 3.0 * (rising + falling - 2.0 * mean);
    let slope = falling - rising - curve;
    let theta = (-0.5 * slope / curve).clamp(0.0, 1.0);
    let least = if theta.is_finite() { rising + theta * (slope + theta * curve) } else { rising };
    sign * least < CLOSE_TO_TURNING * rising.abs().min(falling.abs())
}

/// A root of `value` between two points with values of different signs, by the Illinois method with
/// bisections in between.
fn root(value: &dyn Fn(f64) -> f64, [mut low, mut high]: [(f64, f64); 2], width: f64) -> f64 {
    let mut side = 0;
    for iteration in 0..ROOT_ITERATIONS {
        if (high.0 - low.0).abs() <= width * high.0.abs() || high.1 == 0.0 {
            break;
        }
        let secant = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
        let bisects = iteration % 3 == 2 || !secant.is_finite();
        let at = if bisects { 0.5 * (low.0 + high.0) } else { secant };
        let found = value(at);
        if (found > 0.0) == (high.1 > 0.0) {
            let weight = if side == 1 { 0.5 } else { 1.0 };
            (high, low.1, side) = ((at, found), weight * low.1, 1);
        } else {
            let weight = if side == -1 { 0.5 } else { 1.0 };
            (low, high.1, side) = ((at, found), weight * high.1, -1);
        }
    }
    high.0
}
