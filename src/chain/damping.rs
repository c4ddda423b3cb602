//! How fast losses make velocities die: what limits the steps of explicit methods.

use super::{Chain, StabilityLimit, hertz};

/// Halvings of the interval in which the fastest decay is looked for: to a part in a million.
const HALVINGS: usize = 40;

impl Chain {
    /// The fastest decay of any pattern of velocities, with all lossy contacts closed and at the overlaps and speeds that
    /// bodies with these velocities (m/s) will reach; 0 without losses (1/s).
    ///
    /// The largest eigenvalue of `M^-1/2 C M^-1/2`, tridiagonal with `(c[i] + c[i+1])/m[i]` and `-c[i]/sqrt(m[i-1] m[i])`, `c` the slopes of the
    /// losses against the closing speeds, by bisection on Sturm's count. Source: J. H. Wilkinson, The Algebraic
    /// Eigenvalue Problem (1965), chapter 5. For a diatomic chain of dashpots it is `2 gamma (1/m + 1/M)`.
    pub fn fastest_decay(&self, velocity: &[f64]) -> f64 {
        let speed = velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let slope = |j: usize| self.damping(j, speed);
        let slopes: Vec<f64> = (0..self.contacts.len()).map(slope).collect();
        let row = |i: usize| (slopes[i] + slopes[i + 1]) / self.bodies[i].mass;
        // Gershgorin: no eigenvalue lies beyond twice the largest diagonal entry.
        let bound = 2.0 * (0..self.bodies.len()).map(row).fold(0.0, f64::max);
        let above = |shift: f64| {
            let mut pivot = 1.0;
            (0..self.bodies.len()).any(|i| {
                let beside = if i == 0 {
                    0.0
                } else {
                    slopes[i] * slopes[i] / (self.bodies[i - 1].mass * self.bodies[i].mass)
                };
                pivot = row(i) - shift - beside / pivot;
                pivot > 0.0
            })
        };
        let (mut low, mut high) = (0.0, bound);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if above(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// The longest step that a method could survive whose longest stable step times decay is `reach` (1), by [`Self::fastest_decay`], and the contact
    /// that lets its two bodies alone decay fastest; none without losses.
    pub fn decay_limit(&self, velocity: &[f64], reach: f64) -> Option<StabilityLimit> {
        let speed = velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let alone = |j: usize| self.damping(j, speed) * self.reach(j, speed).1;
        let decays =
            (0..self.contacts.len()).map(|j| (j, alone(j))).filter(|(_, decay)| *decay > 0.0);
        let (j, _) = decays.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let (upper, lower) = self.beside(j);
        Some(StabilityLimit { step: reach / self.fastest_decay(velocity), upper, lower })
    }

    /// The largest decay of any contact, its two bodies taken alone, in units of its own angular frequency: twice its damping ratio;
    /// 0 without losses (1).
    pub fn largest_damping(&self, velocity: &[f64]) -> f64 {
        let speed = velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let ratio = |j: usize| {
            let (slope, (overlap, inverse)) = (self.damping(j, speed), self.reach(j, speed));
            let stiffness = hertz::tangent_stiffness(self.contacts[j].stiffness, overlap);
            if slope > 0.0 { slope * (inverse / stiffness).sqrt() } else { 0.0 }
        };
        (0..self.contacts.len()).map(ratio).fold(0.0, f64::max)
    }

    /// The larger of contact `j`'s static overlap and that of a collision at `speed` (m/s), and its inverse reduced mass.
    fn reach(&self, j: usize, speed: f64) -> (f64, f64) {
        let beside = [j.checked_sub(1), Some(j)].into_iter().flatten();
        let masses = beside.filter_map(|i| self.bodies.get(i)).map(|body| 1.0 / body.mass);
        let (contact, inverse): (_, f64) = (&self.contacts[j], masses.sum());
        let dynamic = hertz::collision_overlap(contact.stiffness, 1.0 / inverse, speed);
        (contact.static_overlap.max(dynamic), inverse)
    }

    /// Slope of the loss in contact `j` against the closing speed, at the larger of its static overlap and that of a
    /// collision at `speed` (m/s) (N s/m).
    pub(super) fn damping(&self, j: usize, speed: f64) -> f64 {
        let Some((contact, loss)) = self.contacts.get(j).and_then(|c| Some((c, c.loss?))) else {
            return 0.0;
        };
        loss.damping(contact.stiffness, self.reach(j, speed).0, speed)
    }
}
