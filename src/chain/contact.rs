//! One contact: its static state, and how its force follows its overlap.

use super::hertz;
use super::loss::{ContactLoss, Touch};
use super::plasticity::YieldLaw;
use super::power;

/// Iterations for a contact in series with a spring, at most.
const SERIES_ITERATIONS: usize = 50;
/// Root of the static overlap that makes a Hertz contact a spring (m^0.5).
const SPRING_ROOT: f64 = 1e10;

/// How a contact's force follows its overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// Hertz: `F = A overlap^1.5`, nothing once open.
    Hertz,
    /// Hertz linearised about the static state, by [`super::LinearisedContacts`].
    Linearised,
    /// `F = A overlap^p`, nothing once open, with a measured exponent `p` (1).
    Power(f64),
}

/// What decides on a contact's force beside its motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Past {
    /// Whether it counts as closed.
    pub closed: bool,
    /// Largest overlap so far beyond first yield; 0 where it has not yielded (m).
    pub largest: f64,
}

impl Past {
    /// That of a contact that has not yielded.
    pub fn of(closed: bool) -> Self {
        Self { closed, largest: 0.0 }
    }
}

/// One contact and its static state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// `A` in `F = A overlap^1.5`, or in `A overlap^p` (N/m^p); 0 where there is nothing to touch
    /// (N/m^1.5).
    pub stiffness: f64,
    /// Static force (N).
    pub static_force: f64,
    /// Static overlap (m).
    pub static_overlap: f64,
    /// How the force follows the overlap.
    pub law: Law,
    /// What it takes out of the motion; none where it is elastic.
    pub loss: Option<ContactLoss>,
    /// Force at which its softer body begins to yield; none where that is not known (N).
    pub yield_force: Option<f64>,
    /// How it yields; none where it is elastic whatever the force.
    pub plastic: Option<YieldLaw>,
    /// Largest overlap beyond first yield in earlier shots; 0 if it is new (m).
    pub indented: f64,
    /// Of a spring in series with the contact, a piezo stack's; 0 without one (m/N).
    pub compliance: f64,
}

impl Contact {
    /// Nothing stands here.
    pub(super) const OPEN: Self = Self {
        stiffness: 0.0,
        static_force: 0.0,
        static_overlap: 0.0,
        law: Law::Hertz,
        loss: None,
        yield_force: None,
        plastic: None,
        indented: 0.0,
        compliance: 0.0,
    };

    /// Stiffness against small changes of the static state (N/m).
    pub fn static_stiffness(&self) -> f64 {
        self.stiffness_at(self.static_overlap)
    }

    /// Stiffness against small changes about an `overlap` (m) on the curve that it has unless it is
    /// linearised (N/m).
    pub fn stiffness_at(&self, overlap: f64) -> f64 {
        match self.law {
            Law::Power(exponent) => power::tangent_stiffness(self.stiffness, exponent, overlap),
            Law::Hertz | Law::Linearised => hertz::tangent_stiffness(self.stiffness, overlap),
        }
    }

    /// Exponent of that curve (1).
    pub fn exponent(&self) -> f64 {
        if let Law::Power(exponent) = self.law { exponent } else { 1.5 }
    }

    /// Overlap under which that curve bears `force` (N) (m).
    pub fn overlap_under(&self, force: f64) -> f64 {
        match self.law {
            Law::Power(exponent) => power::overlap(self.stiffness, exponent, force),
            Law::Hertz | Law::Linearised => hertz::overlap(self.stiffness, force),
        }
    }

    /// Largest overlap of two bodies of `reduced_mass` (kg), free of loads, that meet with
    /// `closing_speed` (m/s), on that curve (m).
    pub fn collision_overlap(&self, reduced_mass: f64, closing_speed: f64) -> f64 {
        match self.law {
            Law::Power(exponent) => {
                let energy = 0.5 * reduced_mass * closing_speed * closing_speed;
                power::overlap_of_energy(self.stiffness, exponent, energy)
            }
            Law::Hertz | Law::Linearised => {
                hertz::collision_overlap(self.stiffness, reduced_mass, closing_speed)
            }
        }
    }

    /// The contact as one that follows Hertz's law, which those of another exponent cannot be:
    /// stiffness `A` (N/m^1.5), static overlap (m) and the root of that (m^0.5). A spring of
    /// stiffness `k` is one under an immense preload: with `d0 = 1e20 m` and `A = 2/3 k/sqrt(d0)`,
    /// `A ((d0 + u)^1.5 - d0^1.5)` is `k u` to rounding.
    pub fn as_hertz(&self) -> (f64, f64, f64) {
        match self.law {
            Law::Hertz | Law::Power(_) => {
                (self.stiffness, self.static_overlap, self.static_overlap.sqrt())
            }
            Law::Linearised => {
                let stiffness = self.static_stiffness() / (1.5 * SPRING_ROOT);
                (stiffness, SPRING_ROOT * SPRING_ROOT, SPRING_ROOT)
            }
        }
    }

    /// How far the bodies are from parting at rest: the static overlap, and what a spring in series
    /// is pressed (m).
    pub fn static_approach(&self) -> f64 {
        self.static_overlap + self.compliance * self.static_force
    }

    /// Change of the overlap alone where the bodies have come closer by `change` (m): what a spring
    /// in series leaves of it (m).
    fn without_spring(&self, change: f64) -> f64 {
        if self.compliance == 0.0 {
            return change;
        }
        // Newton's method on `f = F(change - f c)`, from the tangent at rest; the slope of the
        // difference is at least 1, so a few iterations end at rounding.
        let stiffness = |overlap: f64| match self.law {
            Law::Linearised => self.static_stiffness(),
            _ => self.stiffness_at(self.static_overlap + overlap),
        };
        let mut overlap = change / (1.0 + self.compliance * stiffness(change.max(0.0)));
        for _ in 0..SERIES_ITERATIONS {
            let beyond = overlap + self.compliance * self.overlap_force(overlap) - change;
            let step = beyond / (1.0 + self.compliance * stiffness(overlap));
            overlap -= step;
            if step.abs() <= f64::EPSILON * overlap.abs() {
                break;
            }
        }
        overlap
    }

    /// Change of the force when the bodies come closer by `change` (m) after the overlap `largest`
    /// (m) (N), and its slope (N/m).
    pub fn force_change_after(&self, change: f64, largest: f64) -> (f64, f64) {
        let elastic = || match self.law {
            Law::Hertz if self.compliance == 0.0 => {
                hertz::force_and_tangent(self.stiffness, self.static_overlap.sqrt(), change)
            }
            _ => (self.force_change(change), self.tangent_stiffness(change)),
        };
        let Some(law) = &self.plastic else { return elastic() };
        let overlap = self.static_overlap + change;
        if largest > 0.0 && overlap < largest {
            let (force, slope) = law.unloading(largest).force_and_slope(overlap);
            return (force - self.static_force, slope);
        }
        self.loading_change(change)
    }

    /// The same on first loading.
    pub fn loading_change(&self, change: f64) -> (f64, f64) {
        let overlap = self.static_overlap + change;
        match &self.plastic {
            Some(law) if overlap > law.first_overlap() => {
                let (force, slope) = law.loading(overlap);
                (force - self.static_force, slope)
            }
            _ if self.law == Law::Hertz => {
                hertz::force_and_tangent(self.stiffness, self.static_overlap.sqrt(), change)
            }
            _ => (self.force_change(change), self.tangent_stiffness(change)),
        }
    }

    /// Largest overlap beyond first yield up to rest; 0 where it has not yielded (m).
    pub fn static_largest(&self) -> f64 {
        let has_yielded = |law: &YieldLaw| self.static_overlap > law.first_overlap();
        let own =
            if self.plastic.as_ref().is_some_and(has_yielded) { self.static_overlap } else { 0.0 };
        own.max(self.indented)
    }

    /// The contact at rest under the same force, after the overlap `largest` (m).
    pub(super) fn after(self, largest: f64) -> Self {
        let Some(law) = self.plastic else { return self };
        let new = law.overlap_of(self.static_force);
        if largest <= new.max(law.first_overlap()) {
            return Self { indented: 0.0, static_overlap: new, ..self };
        }
        let static_overlap = law.unloading(largest).overlap_of(self.static_force);
        Self { indented: largest, static_overlap, ..self }
    }

    /// Slope of the force against the overlap where bodies at rest begin to come closer (N/m).
    pub(super) fn starting_slope(&self) -> f64 {
        let largest = self.static_largest();
        if largest > 0.0 {
            self.force_change_after(0.0, largest).1
        } else {
            self.tangent_stiffness(0.0)
        }
    }

    /// How far the bodies are from parting at rest, less what an indentation has taken (m).
    pub fn static_travel(&self) -> f64 {
        self.static_approach() - self.residual_overlap(self.static_largest())
    }

    /// Overlap that remains without force after the overlap `largest` (m) (m).
    pub fn residual_overlap(&self, largest: f64) -> f64 {
        match &self.plastic {
            Some(law) if largest > 0.0 => law.unloading(largest).residual,
            _ => 0.0,
        }
    }

    /// Change of the force when the bodies come closer by `change` (m) (N).
    pub fn force_change(&self, change: f64) -> f64 {
        self.overlap_force(self.without_spring(change))
    }

    /// Change of the force when the overlap grows by `change` (m) over the static one (N).
    fn overlap_force(&self, change: f64) -> f64 {
        match self.law {
            Law::Hertz => hertz::force_change(self.stiffness, self.static_overlap.sqrt(), change),
            Law::Linearised => self.static_stiffness() * change,
            Law::Power(exponent) => {
                power::force_change(self.stiffness, exponent, self.static_overlap, change)
            }
        }
    }

    /// The contact when its overlap has grown by `change` (m) over the static one and grows by
    /// `closing` (m/s).
    pub fn touch(&self, change: f64, closing: f64, past: Past) -> Touch {
        self.touched(self.force_change_after(change, past.largest).0, change, closing, past)
    }

    fn touched(&self, force_change: f64, change: f64, closing: f64, past: Past) -> Touch {
        let elastic = self.static_force + force_change;
        let overlap = self.static_approach() + change - self.residual_overlap(past.largest);
        Touch { overlap, closing, elastic, closed: past.closed }
    }

    /// Change of the force, losses included (N).
    pub fn lossy_force_change(&self, change: f64, closing: f64, past: Past) -> f64 {
        let (elastic, _) = self.force_change_after(change, past.largest);
        let Some(loss) = self.loss else { return elastic };
        elastic + loss.force(self.stiffness, self.touched(elastic, change, closing, past))
    }

    /// The same (N), and its slopes against the overlap (N/m) and the closing speed (N s/m).
    pub fn lossy_change_and_slopes(
        &self,
        change: f64,
        closing: f64,
        past: Past,
    ) -> (f64, [f64; 2]) {
        let (elastic, slope) = self.force_change_after(change, past.largest);
        let Some(loss) = self.loss else { return (elastic, [slope, 0.0]) };
        let touch = self.touched(elastic, change, closing, past);
        let (force, tangent) = loss.force_and_tangent(self.stiffness, slope, touch);
        (elastic + force, [tangent.stiffness, tangent.damping])
    }

    /// Stiffness against further changes (N/m).
    pub fn tangent_stiffness(&self, change: f64) -> f64 {
        let stiffness = match self.law {
            Law::Linearised => self.static_stiffness(),
            _ => self.stiffness_at(self.static_overlap + self.without_spring(change)),
        };
        stiffness / (1.0 + self.compliance * stiffness)
    }

    /// Elastic energy, that of the static overlap and of a spring in series included (J).
    pub fn energy(&self, change: f64) -> f64 {
        let change = self.without_spring(change);
        let spring = if self.compliance > 0.0 {
            0.5 * self.compliance * (self.static_force + self.overlap_force(change)).powi(2)
        } else {
            0.0
        };
        spring + self.overlap_energy(change)
    }

    /// Elastic energy of the overlap (J).
    fn overlap_energy(&self, change: f64) -> f64 {
        match self.law {
            Law::Hertz => hertz::energy(self.stiffness, self.static_overlap + change),
            Law::Power(exponent) => {
                power::energy(self.stiffness, exponent, self.static_overlap + change)
            }
            Law::Linearised => {
                hertz::energy(self.stiffness, self.static_overlap)
                    + (self.static_force + 0.5 * self.static_stiffness() * change) * change
            }
        }
    }

    /// Elastic energy above the static one less the work that the static force did: what a change
    /// of the overlap by `change` (m) has cost; exact to rounding however small the change (J).
    ///
    /// With `s` and `r` the square roots of the present and the static overlap it is
    /// `A (s - r)^2 (2/5 s^3 + 4/5 s^2 r + 6/5 s r^2 + 3/5 r^3)` while closed.
    pub fn energy_change(&self, change: f64) -> f64 {
        if self.compliance > 0.0 {
            let overlap = self.without_spring(change);
            let force = self.overlap_force(overlap);
            let contact = Self { compliance: 0.0, ..*self };
            return contact.energy_change(overlap) + 0.5 * self.compliance * force * force;
        }
        match self.law {
            Law::Linearised => return 0.5 * self.static_stiffness() * change * change,
            Law::Power(exponent) => {
                return power::energy_change(self.stiffness, exponent, self.static_overlap, change);
            }
            Law::Hertz => (),
        }
        let gap = (-self.static_overlap - change).max(0.0);
        let r = self.static_overlap.sqrt();
        let s = (self.static_overlap + change).max(0.0).sqrt();
        // `change / (s + r)`, which has no digits to lose.
        let rise = (change + gap) / (s + r).max(f64::MIN_POSITIVE);
        let shape = s * s * (0.4 * s + 0.8 * r) + r * r * (1.2 * s + 0.6 * r);
        self.stiffness * rise * rise * shape + self.static_force * gap
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `k u`, by Hertz's law, from the smallest overlap to far above any that a bench has.
    #[test]
    fn a_spring_is_a_hertz_contact_under_an_immense_preload() {
        let (stiffness, static_overlap) = (1.194e8, 7.35e-6);
        let static_force = hertz::force(stiffness, static_overlap);
        let law = Law::Linearised;
        let spring = Contact { stiffness, static_force, static_overlap, law, ..Contact::OPEN };
        let (as_hertz, _, root) = spring.as_hertz();
        let k = 1.5 * stiffness * static_overlap.sqrt();
        for change in [-1.0, -1e-5, 1e-30, 1e-9, 3e-6, 1.0] {
            let (force, tangent) = hertz::force_and_tangent(as_hertz, root, change);
            assert!((force / (k * change) - 1.0).abs() < 1e-15, "{change}: {force}");
            assert!((tangent / k - 1.0).abs() < 1e-15, "{change}: {tangent}");
        }
    }

    #[test]
    fn energy_change_agrees_with_the_plain_difference() {
        let (stiffness, overlap) = (1.194e8, 7.35e-6);
        let static_force = hertz::force(stiffness, overlap);
        let contact = Contact { stiffness, static_force, static_overlap: overlap, ..Contact::OPEN };
        for change in [-1e-5, -7.35e-6, -3e-6, -1e-7, 0.0, 1e-7, 4e-6, 2e-5] {
            let plain = contact.energy(change) - contact.energy(0.0) - static_force * change;
            let scale = contact.energy(change.abs());
            assert!((contact.energy_change(change) - plain).abs() <= 1e-14 * scale, "{change}");
        }
        let small = contact.energy_change(1e-18) / (0.5 * contact.static_stiffness() * 1e-36);
        assert!((small - 1.0).abs() < 1e-9);
    }

    /// With the exponent 1.5 these are Hertz's functions, to rounding, closed, open and for small
    /// changes.
    #[test]
    fn the_exponent_one_and_a_half_is_hertzs() {
        let (a, rest) = (1.194e8, 7.35e-6);
        let static_force = hertz::force(a, rest);
        let contact = Contact { stiffness: a, static_force, static_overlap: rest, ..Contact::OPEN };
        assert!((power::overlap(a, 1.5, static_force) / rest - 1.0).abs() < 1e-15);
        for change in [-1e-5, -7.35e-6, -3e-6, -1e-7, -1e-13, 1e-13, 1e-7, 4e-6, 2e-5] {
            let same = |found: f64, expected: f64| {
                assert!((found - expected).abs() <= 2e-14 * expected.abs(), "{change}: {found}");
            };
            same(power::force_change(a, 1.5, rest, change), contact.force_change(change));
            same(power::energy_change(a, 1.5, rest, change), contact.energy_change(change));
            same(
                power::tangent_stiffness(a, 1.5, rest + change),
                contact.tangent_stiffness(change),
            );
        }
    }
}
