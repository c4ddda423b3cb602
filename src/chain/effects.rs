//! Optional physics of the chain, on only if a scene has its table.
//!
//! An effect whose force does not depend on the state is folded into the static solution before the
//! first step and costs nothing during the run. Losses go into the contacts ([`super::loss`]); each
//! is a row of [`LOSS_MODELS`], and its law an arm in [`super::ContactLoss`].

use std::fmt::Write as _;

use super::EndOfContact;
use super::loss::{ContactLoss, KINDS};
use super::plasticity::{PlasticModel, Plasticity};
use super::restitution::{Restitution, coefficient};
use super::support::Support;
use crate::magnet::Magnet;
use crate::quantity::{Dimension, engineering};

/// A model of losses in contacts.
#[derive(Debug, Clone, Copy)]
pub struct LossModel {
    /// Name of its table in a scene, `[effects.<name>]`.
    pub name: &'static str,
    /// Key of its coefficient.
    pub key: &'static str,
    /// Its coefficient in words.
    pub label: &'static str,
    /// Unit of the coefficient.
    pub unit: &'static str,
    /// Dimension of the coefficient.
    pub dimension: Dimension,
    /// Largest coefficient that a scene may have (unit).
    pub largest: f64,
    /// Whether it has an exponent.
    pub has_exponent: bool,
}

/// The models of losses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LossKind {
    /// A dashpot in every closed contact: `F = A d^1.5 + gamma ddot`.
    ///
    /// The force jumps where a contact closes and, if it ends at zero overlap, where it opens.
    /// Restitution falls with falling speed. Source: E. B. Herbold, V. F. Nesterenko, Phys. Rev. E
    /// 75, 021304 (2007); of the two ends of contact, T. Schwager, T. Pöschel, Granular Matter 9,
    /// 465 (2007). Valid as an effective loss fitted to one experiment; no material has this
    /// `gamma`.
    Dashpot,
    /// Viscoelastic spheres: `F = A d^1.5 + 3/2 A eta sqrt(d) ddot`.
    ///
    /// The force goes with the rate of the Hertz force itself, `eta d(A d^1.5)/dt`; `eta` collects
    /// the materials' bulk and shear viscosities. The force is continuous where a contact closes,
    /// with the slope of a square root. Source: G. Kuwabara, K. Kono, Jpn. J. Appl. Phys. 26, 1230
    /// (1987); N. V. Brilliantov, F. Spahn, J.-M. Hertzsch, T. Pöschel, Phys. Rev. E 53, 5382
    /// (1996). Valid for impacts slow against the materials' own relaxation:
    /// `3/2 eta (A/mu)^(2/5) v^(1/5)` well below 1.
    KuwabaraKono,
    /// A power of the closing speed: `F = A d^1.5 + F1 sgn(ddot) (|ddot| / 1 m/s)^alpha` in closed
    /// contacts.
    ///
    /// R. Carretero-González, D. Khatri, M. A. Porter, P. G. Kevrekidis, C. Daraio, Phys. Rev.
    /// Lett. 102, 024102 (2009) fit `alpha = 1.81` for steel, brass and PTFE, with the loss acting
    /// on each bead by the difference of its two closing speeds. That conserves momentum only for
    /// `alpha = 1`; here each contact has the loss of its own closing speed, which always does, and
    /// which is the same for `alpha = 1`: their coefficients are no more than a start for a fit.
    /// Jumps as the dashpot's do.
    PowerLaw,
}

/// The models, in the order of [`super::loss::LossTerms`].
pub const LOSS_MODELS: [LossModel; KINDS] = [
    LossModel {
        name: "dashpot",
        key: "gamma",
        label: "gamma",
        unit: "N*s/m",
        dimension: Dimension::DAMPING,
        // Beyond it a bead of this bench would stop within a nanosecond.
        largest: 1e5,
        has_exponent: false,
    },
    LossModel {
        name: "kuwabara_kono",
        key: "eta",
        label: "eta",
        unit: "s",
        dimension: Dimension::TIME,
        // Hundreds of times the duration of an impact.
        largest: 1e-3,
        has_exponent: false,
    },
    LossModel {
        name: "power_law_loss",
        key: "force_at_1_m_per_s",
        label: "force at 1 m/s",
        unit: "N",
        dimension: Dimension::FORCE,
        largest: 1e5,
        has_exponent: true,
    },
];

impl LossKind {
    /// All of them, in the order of [`LOSS_MODELS`].
    pub const ALL: [Self; KINDS] = [Self::Dashpot, Self::KuwabaraKono, Self::PowerLaw];

    /// Its row.
    pub fn model(self) -> &'static LossModel {
        &LOSS_MODELS[self as usize]
    }

    /// The one with this table.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.model().name == name)
    }
}

/// Another coefficient for the contacts between two kinds of bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactOverride {
    /// Names of the two bodies, in either order.
    pub between: [String; 2],
    /// The coefficient there; 0 where it follows from a restitution (unit).
    pub value: f64,
    /// The restitution that it follows from.
    pub restitution: Option<Restitution>,
}

/// Whether `pair` names these two bodies, in either order.
pub(crate) fn is_pair<T: AsRef<str>>([a, b]: &[T; 2], upper: &str, lower: &str) -> bool {
    let (a, b) = (a.as_ref(), b.as_ref());
    (a == upper && b == lower) || (a == lower && b == upper)
}

/// A loss's coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct LossSpec {
    /// The coefficient of all contacts without an override; 0 where it follows from a restitution
    /// (unit).
    pub value: f64,
    /// The restitution that it follows from, contact by contact.
    pub restitution: Option<Restitution>,
    /// Exponent of the power law; 1 for the others (1).
    pub exponent: f64,
    /// Coefficients of some contacts.
    pub overrides: Vec<ContactOverride>,
    /// What ends a contact; the same for all losses of a chain.
    pub end: EndOfContact,
}

impl LossSpec {
    /// The same coefficient (unit) in all contacts, and the exponent 1.
    pub fn everywhere(value: f64, end: EndOfContact) -> Self {
        Self { value, restitution: None, exponent: 1.0, overrides: Vec::new(), end }
    }

    /// The coefficient between the bodies so named (unit), or the restitution that it follows from.
    pub fn between(&self, upper: &str, lower: &str) -> (f64, Option<Restitution>) {
        let own = self.overrides.iter().find(|own| is_pair(&own.between, upper, lower));
        own.map_or((self.value, self.restitution), |own| (own.value, own.restitution))
    }

    /// The settings in words.
    fn summary(&self, model: &LossModel) -> String {
        let text = |value: f64, restitution: &Option<Restitution>| match restitution {
            None => engineering(value, model.unit, 4),
            Some(Restitution { value, speed }) => {
                format!("by a restitution of {value} at {}", engineering(*speed, "m/s", 4))
            }
        };
        let mut words = String::new();
        if model.has_exponent {
            let _ = write!(words, "exponent {}, ", self.exponent);
        }
        let _ = write!(words, "{} {}", model.label, text(self.value, &self.restitution));
        for ContactOverride { between: [upper, lower], value, restitution } in &self.overrides {
            let value = text(*value, restitution);
            let _ = write!(words, ", between {upper} and {lower} {value}");
        }
        format!("{words}; a contact ends at {}", self.end.name().replace('_', " "))
    }
}

/// `[effects.gravity]`: weight `F = m g` on every body, the striker too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gravity {
    /// Acceleration along the chain, from the striker's end to the other (m/s²).
    pub acceleration: f64,
}

/// `[effects.contact_law]`: `F = A overlap^p` with `A` and `p` as measured, in place of what
/// follows from Hertz's law.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLaw {
    /// Exponent `p` of all contacts without their own (1).
    pub exponent: f64,
    /// Their `A`, in N/m^p (unit).
    pub stiffness: f64,
    /// Names of two bodies, in either order, with exponent (1) and `A` of their contacts (N/m^p).
    pub between: Vec<([String; 2], f64, f64)>,
}

impl ContactLaw {
    /// Exponent (1) and `A` (N/m^p) of the contact between the bodies so named.
    pub fn of(&self, upper: &str, lower: &str) -> (f64, f64) {
        let own = self.between.iter().find(|(pair, ..)| is_pair(pair, upper, lower));
        own.map_or((self.exponent, self.stiffness), |(_, exponent, stiffness)| {
            (*exponent, *stiffness)
        })
    }

    /// The settings in words.
    fn summary(&self) -> String {
        let law = |exponent: f64, stiffness: f64| {
            let force = engineering(stiffness * MICROMETRE.powf(exponent), "N", 4);
            format!("F = {force} (overlap/µm)^{exponent}")
        };
        let mut words = law(self.exponent, self.stiffness);
        for ([upper, lower], exponent, stiffness) in &self.between {
            let _ = write!(words, ", between {upper} and {lower} {}", law(*exponent, *stiffness));
        }
        words
    }
}

/// `[effects.linearised_contacts]`: contacts linearised about the static state,
/// `F = F0 + beta (change of overlap)`, `beta = 3/2 A^(2/3) F0^(1/3)`.
///
/// The linear chain of the paper's Figs 4 and 5. A linearised contact never opens and pulls when it
/// is drawn apart, so this holds only while dynamic forces are far below the static ones; every
/// contact must be precompressed. Source: Herbold et al. (2009), Eqs (3) to (6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearisedContacts;

/// `[effects.magnet_law]`: the force of a ring or of a measured table follows the particle as it
/// moves, `F(d0 - u)` in place of `F(d0)`.
///
/// A spring of 1.4 to 3.9 N/mm beside contacts of 500: the particle travels 21 to 215 um under the
/// paper's strikers, so the force changes by 3 to 8 % each 50 um of it. Source: `crate::magnet`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MagnetLaw;

/// (m)
const MICROMETRE: f64 = 1e-6;
/// What a temperature in kelvin is above one in degrees Celsius.
const ZERO_CELSIUS: f64 = 273.15;

/// `[effects.magnet_preload]`: a magnet that pulls one ferromagnetic particle, with a constant
/// force or as a ring or a measured table says.
///
/// The constant force is what the paper's calculations use. Source: Herbold et al. (2009), section
/// II; Daraio et al., Phys. Rev. E 73, 026610 (2006). In the static state the others are a constant
/// force as well; with [`MagnetLaw`] it changes as the particle moves.
#[derive(Debug, Clone, PartialEq)]
pub struct MagnetPreload {
    /// The particle it acts on, counted from 1 at the top.
    pub particle: usize,
    /// Its force, downward positive.
    pub force: MagnetForce,
}

/// How hard a magnet pulls.
#[derive(Debug, Clone, PartialEq)]
pub enum MagnetForce {
    /// The same everywhere (N).
    Constant(f64),
    /// As a magnet does at its place.
    Placed(PlacedMagnet),
}

/// A ring or a measured table at its place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedMagnet {
    /// The magnet.
    pub magnet: Magnet,
    /// Its temperature (K).
    pub temperature: f64,
    /// Distance of the particle's centre from its face.
    pub at: PlacedAt,
}

/// When the distance from the magnet's face was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlacedAt {
    /// In the static state, all loads on (m).
    Rest(f64),
    /// With bodies that only touch, before anything presses (m).
    Unloaded(f64),
    /// Where it pulls with this force in the static state.
    Pull {
        /// The force (N).
        force: f64,
        /// The distance that it follows from (m).
        distance: f64,
    },
}

impl PlacedMagnet {
    /// Moves the magnet to where it pulls with `force` (N) at rest, of several places to the
    /// nearest to where it was.
    pub fn moved_to(&self, force: f64, present: f64) -> Option<Self> {
        let places = self.magnet.distances(force, self.temperature);
        let nearest = places
            .into_iter()
            .min_by(|a, b| (a - present).abs().total_cmp(&(b - present).abs()))?;
        Some(Self { at: PlacedAt::Rest(nearest), ..self.clone() })
    }
}

impl MagnetPreload {
    /// The settings in words.
    fn summary(&self) -> String {
        match &self.force {
            MagnetForce::Constant(force) => {
                format!("{} on particle {}", engineering(*force, "N", 4), self.particle)
            }
            MagnetForce::Placed(PlacedMagnet { magnet, temperature, at }) => {
                let (distance, when) = match at {
                    PlacedAt::Rest(distance) | PlacedAt::Pull { distance, .. } => {
                        (distance, "at rest")
                    }
                    PlacedAt::Unloaded(distance) => (distance, "before anything presses"),
                };
                let distance = engineering(*distance, "m", 4);
                let (name, particle) = (&magnet.name, self.particle);
                let celsius = temperature - ZERO_CELSIUS;
                format!(
                    "{name}, its face {distance} from particle {particle} {when}, at {celsius:.1} °C"
                )
            }
        }
    }
}

/// The effects that a scene has; `None` is off.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EffectsSpec {
    /// The losses, in the order of [`LOSS_MODELS`].
    pub losses: [Option<LossSpec>; KINDS],
    /// `[effects.gravity]`
    pub gravity: Option<Gravity>,
    /// `[effects.contact_law]`
    pub contact_law: Option<ContactLaw>,
    /// `[effects.linearised_contacts]`
    pub linearised_contacts: Option<LinearisedContacts>,
    /// `[effects.magnet_law]`
    pub magnet_law: Option<MagnetLaw>,
    /// `[effects.magnet_preload]`
    pub magnet_preload: Option<MagnetPreload>,
    /// `[effects.plasticity]`
    pub plasticity: Option<Plasticity>,
    /// What is behind the walls at the top and at the bottom: `[drive]`, rods and plates.
    pub supports: [Support; 2],
}

impl EffectsSpec {
    /// Names and settings of the effects that are on, sorted by name.
    pub fn settings(&self) -> Vec<(&'static str, String)> {
        let losses = LOSS_MODELS.iter().zip(&self.losses);
        let losses = losses.filter_map(|(m, spec)| Some((m.name, spec.as_ref()?.summary(m))));
        let mut all: Vec<(&'static str, String)> = losses.collect();
        if let Some(gravity) = self.gravity {
            all.push(("gravity", engineering(gravity.acceleration, "m/s²", 4)));
        }
        all.extend(self.contact_law.as_ref().map(|law| ("contact_law", law.summary())));
        if self.linearised_contacts.is_some() {
            let words = "Eq. (3): never open, right only far below the static force";
            all.push(("linearised_contacts", words.to_owned()));
        }
        if self.magnet_law.is_some() {
            let words = "the magnet's force changes as its particle moves";
            all.push(("magnet_law", words.to_owned()));
        }
        all.extend(self.magnet_preload.as_ref().map(|m| ("magnet_preload", m.summary())));
        if let Some(Plasticity { model, keeps_indentations }) = self.plasticity {
            let mut words = match model {
                PlasticModel::Thornton => "thornton: contacts yield".to_owned(),
                PlasticModel::WaltonBraun(e) => format!("walton_braun, restitution {e}"),
            };
            if keeps_indentations {
                words.push_str(", indentations stay from shot to shot");
            }
            all.push(("plasticity", words));
        }
        for (support, end) in self.supports.iter().zip(["top", "bottom"]) {
            all.extend(support.summary(end));
        }
        all.sort_unstable_by_key(|(name, _)| *name);
        all
    }

    /// Switches the effect called `name` off; none of that name, no change.
    pub fn remove(&mut self, name: &str) {
        match name {
            "contact_law" => self.contact_law = None,
            "gravity" => self.gravity = None,
            "linearised_contacts" => self.linearised_contacts = None,
            "magnet_law" => self.magnet_law = None,
            "magnet_preload" => self.magnet_preload = None,
            "plasticity" => self.plasticity = None,
            _ => {
                if let Some(kind) = LossKind::named(name) {
                    self.losses[kind as usize] = None;
                }
            }
        }
    }

    /// A loss that is on.
    pub fn loss(&self, kind: LossKind) -> Option<&LossSpec> {
        self.losses[kind as usize].as_ref()
    }

    /// The same effects with a loss.
    pub fn with_loss(mut self, kind: LossKind, spec: LossSpec) -> Self {
        self.losses[kind as usize] = Some(spec);
        self
    }

    /// The losses of the contact between the bodies so named, of this stiffness `A` (N/m^1.5) and
    /// reduced mass (kg); none if nothing is lost.
    pub fn loss_between(
        &self,
        upper: &str,
        lower: &str,
        (stiffness, mass): (f64, f64),
    ) -> Option<ContactLoss> {
        let end = self.end_of_contact()?;
        let of = |kind: LossKind| {
            let Some(spec) = self.loss(kind) else { return 0.0 };
            match spec.between(upper, lower) {
                (value, None) => value,
                (_, Some(given)) => {
                    coefficient((kind as usize, end, spec.exponent), given, stiffness, mass)
                }
            }
        };
        let [dashpot, relaxation, power_force] = LossKind::ALL.map(of);
        let power_exponent = self.loss(LossKind::PowerLaw).map_or(1.0, |power| power.exponent);
        let loss = ContactLoss { dashpot, relaxation, power_force, power_exponent, end };
        loss.is_some().then_some(loss)
    }

    /// What ends a contact; none if nothing is lost.
    pub fn end_of_contact(&self) -> Option<EndOfContact> {
        self.losses.iter().flatten().next().map(|spec| spec.end)
    }
}
