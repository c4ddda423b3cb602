//! What one contact takes out of the motion: the part of its force that follows the closing speed.
//!
//! `F_loss = gamma ddot + 3/2 A eta sqrt(d) ddot + F1 sgn(ddot) (|ddot| / 1 m/s)^alpha`, `d` the
//! overlap: dashpot, Kuwabara and Kono, power law; their sources stand with the effects. A contact
//! ends where its overlap ends, and then pulls before it ends, or where its whole force would turn
//! into a pull: there it is held at zero, and the elastic energy that it still has goes to nobody.

use super::hertz;

/// Kinds of loss, in the order of [`LossTerms`].
pub const KINDS: usize = 3;

/// Accounts behind the bodies of a chain with losses: one a kind of loss, and the energy in
/// contacts held at zero force.
pub const ACCOUNTS: usize = KINDS + 1;

/// Force (N) or power (J/s) of each kind: dashpot, Kuwabara-Kono, power law.
pub type LossTerms = [f64; KINDS];

/// Where the tangent of Kuwabara and Kono's force has its pole, overlaps are taken as this share of
/// the root at 1 um (m^0.5).
const SMALLEST_ROOT: f64 = 1e-6;

/// What ends a contact with losses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndOfContact {
    /// The overlap comes back to zero; before that the contact pulls.
    ZeroOverlap,
    /// The force comes back to zero; the contact never pulls.
    ZeroForce,
}

impl EndOfContact {
    /// As written in scenes.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ZeroOverlap => "zero_overlap",
            Self::ZeroForce => "zero_force",
        }
    }
}

/// The losses of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLoss {
    /// Coefficient `gamma` of the dashpot (N s/m).
    pub dashpot: f64,
    /// Time `eta` of Kuwabara and Kono (s).
    pub relaxation: f64,
    /// Force `F1` of the power law at 1 m/s (N).
    pub power_force: f64,
    /// Exponent `alpha` of the power law (1).
    pub power_exponent: f64,
    /// What ends the contact.
    pub end: EndOfContact,
}

/// A contact at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Overlap, negative across a gap (m).
    pub overlap: f64,
    /// Its rate (m/s).
    pub closing: f64,
    /// Elastic force, static part included (N).
    pub elastic: f64,
    /// Whether the contact counts as closed: where forces jump, the sign of a vanishing overlap
    /// must not decide.
    pub closed: bool,
}

/// Tangents of what a lossy contact takes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tangent {
    /// Of the force against the overlap, the elastic part included (N/m).
    pub stiffness: f64,
    /// Of the force against the closing speed (N s/m).
    pub damping: f64,
    /// Of the power of each kind of loss against the overlap (J/s/m).
    pub power_by_overlap: LossTerms,
    /// Of the power of each kind of loss against the closing speed (N).
    pub power_by_closing: LossTerms,
}

impl ContactLoss {
    /// Nothing lost.
    pub(crate) const NONE: Self = Self {
        dashpot: 0.0,
        relaxation: 0.0,
        power_force: 0.0,
        power_exponent: 1.0,
        end: EndOfContact::ZeroOverlap,
    };

    /// Whether the force jumps where the contact opens or closes.
    pub fn jumps(&self) -> bool {
        self.dashpot > 0.0 || self.power_force > 0.0
    }

    /// The same losses in a contact that may pull.
    pub(crate) fn unheld_end(self) -> Self {
        Self { end: EndOfContact::ZeroOverlap, ..self }
    }

    /// Coefficient of each kind (unit).
    pub fn coefficients(&self) -> LossTerms {
        [self.dashpot, self.relaxation, self.power_force]
    }

    /// Whether anything is lost at all.
    pub fn is_some(&self) -> bool {
        self.jumps() || self.relaxation > 0.0
    }

    /// Force of each kind, nothing held (N).
    pub(crate) fn terms(&self, stiffness: f64, touch: Touch) -> LossTerms {
        let Touch { overlap, closing, closed, .. } = touch;
        let viscous = if self.relaxation > 0.0 {
            self.relaxation * hertz::tangent_stiffness(stiffness, overlap) * closing
        } else {
            0.0
        };
        if !closed {
            return [0.0, viscous, 0.0];
        }
        let power = power_law(self.power_force, self.power_exponent, closing);
        [self.dashpot * closing, viscous, power]
    }

    /// The force that a contact of stiffness `A` (N/m^1.5) has beyond its elastic one (N).
    pub fn force(&self, stiffness: f64, touch: Touch) -> f64 {
        let force = self.terms(stiffness, touch).iter().sum();
        if self.holds(force, touch) { -touch.elastic } else { force }
    }

    /// The force that the contact would have if nothing held it, and the sum of its parts'
    /// magnitudes (N).
    pub(crate) fn unheld(&self, stiffness: f64, touch: Touch) -> (f64, f64) {
        let terms = self.terms(stiffness, touch);
        let sizes = terms.iter().map(|term| term.abs()).sum::<f64>();
        (touch.elastic + terms.iter().sum::<f64>(), touch.elastic.abs() + sizes)
    }

    /// Whether the contact is held at zero force where its losses would pull with `force` (N).
    fn holds(&self, force: f64, touch: Touch) -> bool {
        self.end == EndOfContact::ZeroForce && touch.elastic + force < 0.0
    }

    /// Slope of the loss against the closing speed, nothing held (N s/m).
    pub fn damping(&self, stiffness: f64, overlap: f64, closing: f64) -> f64 {
        let power = if self.power_force > 0.0 {
            let speed = closing.abs().max(f64::MIN_POSITIVE);
            self.power_force * self.power_exponent * speed.powf(self.power_exponent - 1.0)
        } else {
            0.0
        };
        self.dashpot + self.relaxation * hertz::tangent_stiffness(stiffness, overlap) + power
    }

    /// The force that a contact of stiffness `A` (N/m^1.5) has beyond its elastic one (N), and the
    /// tangents of both together, whose elastic one (N/m) is `elastic_tangent`.
    pub fn force_and_tangent(
        &self,
        stiffness: f64,
        elastic_tangent: f64,
        touch: Touch,
    ) -> (f64, Tangent) {
        let terms = self.terms(stiffness, touch);
        let force = terms.iter().sum();
        let held = self.holds(force, touch);
        let tangent = self.tangent_of(terms, (stiffness, elastic_tangent), touch, held);
        (if held { -touch.elastic } else { force }, tangent)
    }

    /// The tangents, of both stiffnesses, where it is known whether the contact is `held`.
    pub fn tangent_as(&self, stiffnesses: (f64, f64), touch: Touch, held: bool) -> Tangent {
        self.tangent_of(self.terms(stiffnesses.0, touch), stiffnesses, touch, held)
    }

    fn tangent_of(
        &self,
        terms: LossTerms,
        (stiffness, elastic_tangent): (f64, f64),
        touch: Touch,
        held: bool,
    ) -> Tangent {
        let Touch { overlap, closing, closed, .. } = touch;
        let mut tangent = Tangent::default();
        if held {
            return tangent;
        }
        let viscous = self.relaxation * hertz::tangent_stiffness(stiffness, overlap);
        // d sqrt(d)/dd = 1/(2 sqrt(d)) has a pole at first touch, where no step could follow it.
        let root = overlap.max(0.0).sqrt().max(SMALLEST_ROOT);
        let steepening =
            if overlap > 0.0 { 0.75 * self.relaxation * stiffness * closing / root } else { 0.0 };
        let at_zero = Self { relaxation: 0.0, ..*self };
        let jumping = if closed { at_zero.damping(stiffness, overlap, closing) } else { 0.0 };
        tangent.stiffness = elastic_tangent + steepening;
        tangent.damping = viscous + jumping;
        tangent.power_by_overlap[1] = steepening * closing;
        tangent.power_by_closing[1] = 2.0 * viscous * closing;
        tangent.power_by_closing[0] = 2.0 * terms[0];
        tangent.power_by_closing[2] = (self.power_exponent + 1.0) * terms[2];
        tangent
    }
}

/// Force of a power law of `at_one` (N) at 1 m/s and an exponent (1) where bodies close at
/// `closing` (m/s) (N).
fn power_law(at_one: f64, exponent: f64, closing: f64) -> f64 {
    if at_one > 0.0 { at_one * closing.abs().powf(exponent).copysign(closing) } else { 0.0 }
}
