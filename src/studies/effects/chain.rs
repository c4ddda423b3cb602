//! Lines of the effects that act on the chain's motion.

use super::trial::{EffectTrial, of_chain};
use super::{BaselineRun, EffectFinding, EffectState, LedgerEntry};
use crate::chain::{
    Body, Contact, Gravity, LinearisedContacts, LossKind, MagnetForce, MagnetLaw, PlacedAt,
    PlacedMagnet, PlasticModel, Plasticity, Support,
};
use crate::measurement::metadata::mass_without_sensor;
use crate::quantity::engineering;
use crate::scene::{Scene, Site, magnets};

/// Acceleration of free fall that would be switched on (m/s^2).
const FREE_FALL: f64 = 9.81;
/// Masses that differ by less than this are the same but for rounding (1).
const ROUNDING: f64 = 1e-9;
/// The ring that stands for real magnets in the criterion of a constant force.
const RING: &str = "ring-15-6-6";
/// How much heavier a particle may be with a plate in it: bench notes of such sensors have up to
/// this (1).
const HOST_SPREAD: f64 = 0.06;

/// Runs `other` against the scene; `is_on` tells whether the scene is the one with the effect. Why
/// there is no trial, if there is none.
fn against(
    subject: &BaselineRun<'_>,
    other: Result<Scene, String>,
    is_on: bool,
) -> (Option<EffectTrial>, String) {
    let trial = other.and_then(|other| {
        let (with, without) = if is_on { (subject.scene, &other) } else { (&other, subject.scene) };
        of_chain(with, without, subject.accuracy)
    });
    match trial {
        Ok(trial) => (Some(trial), String::new()),
        Err(error) => (None, format!("; not to be compared: {error}")),
    }
}

fn state(is_on: bool) -> EffectState {
    if is_on { EffectState::On } else { EffectState::Off }
}

/// Gravity: the chain's weight against the weakest first peak.
pub fn gravity(subject: &BaselineRun<'_>) -> LedgerEntry {
    let criterion = "weight of the chain / smallest first peak";
    if subject.scene.lies {
        let reason = "the chain lies across it".to_owned();
        let finding = EffectFinding { state: EffectState::Off, value: None, reason, trial: None };
        return finding.entry("gravity", criterion);
    }
    let gravity = subject.scene.spec.effects.gravity;
    let is_on = gravity.is_some();
    let acceleration = gravity.map_or(FREE_FALL, |gravity| gravity.acceleration);
    let other = subject.rebuilt(|scene| {
        scene.spec.effects.gravity = (!is_on).then_some(Gravity { acceleration });
    });
    let (trial, failed) = against(subject, other, is_on);
    let mass: f64 = subject.scene.spec.particles.iter().map(|body| body.mass).sum();
    let weight = mass * acceleration;
    let words =
        if is_on { "on by the scene" } else { "no table in the scene; compared with 9.81 m/s²" };
    let reason = format!("{words}: the chain weighs {}{failed}", engineering(weight, "N", 3));
    let value = Some(weight / subject.wave);
    EffectFinding { state: state(is_on), value, reason, trial }.entry("gravity", criterion)
}

/// The magnet's force.
pub fn magnet_preload(subject: &BaselineRun<'_>) -> LedgerEntry {
    let criterion = "force of the magnet / smallest first peak";
    let Some(magnet) = subject.scene.chain.magnet() else {
        let reason = "no table in the scene; it needs a force, or a magnet's name".to_owned();
        return EffectFinding { state: EffectState::Off, value: None, reason, trial: None }
            .entry("magnet_preload", criterion);
    };
    let other = subject.rebuilt(|scene| {
        scene.spec.effects.magnet_preload = None;
        scene.spec.effects.magnet_law = None;
    });
    let (trial, failed) = against(subject, other, true);
    let force = engineering(magnet.force, "N", 3);
    let name = subject.scene.chain.bodies().get(magnet.body).map_or("", |body| &*body.name);
    let reason = format!("on by the scene: {force} on the {name}{failed}");
    let value = Some(magnet.force / subject.wave);
    EffectFinding { state: EffectState::On, value, reason, trial }
        .entry("magnet_preload", criterion)
}

/// A real magnet's force changes with distance. Where the scene's own is constant, a shipped ring
/// that pulls as hard stands beside it.
pub fn magnet_law(subject: &BaselineRun<'_>) -> LedgerEntry {
    let criterion = "slope of the magnet's force x travel of its particle / force";
    let off = |reason: &str| {
        let reason = reason.to_owned();
        EffectFinding { state: EffectState::Off, value: None, reason, trial: None }
            .entry("magnet_law", criterion)
    };
    let chain = &subject.scene.chain;
    let Some(magnet) = chain.magnet() else { return off("no magnet in the scene") };
    let is_on = chain.pull().is_some();
    let (other, words) = if magnet.pull.is_some() {
        let other =
            subject.rebuilt(|scene| scene.spec.effects.magnet_law = (!is_on).then_some(MagnetLaw));
        (other, if is_on { "on by the scene" } else { "held constant by the scene" })
    } else {
        let Some(ring) = ring(magnet.force) else {
            return off("the scene's force is constant; no ring that ships pulls so hard");
        };
        let other = subject.rebuilt(|scene| {
            if let Some(magnet) = &mut scene.spec.effects.magnet_preload {
                magnet.force = MagnetForce::Placed(ring);
            }
            scene.spec.effects.magnet_law = Some(MagnetLaw);
        });
        (other, "the scene's force is constant; compared with ring-15-6-6, which pulls as hard")
    };
    let pulled = match &other {
        Ok(other) if !is_on => other.chain.pull().map(|(_, pull)| pull.clone()),
        _ => magnet.pull.clone(),
    };
    let path = subject.bench.film().displacements.get(magnet.body);
    let travel = path.map_or(0.0, |path| path.iter().fold(0.0_f64, |most, x| most.max(x.abs())));
    let slope = pulled.map_or(0.0, |pull| pull.slope(0.0));
    let (trial, failed) = against(subject, other, is_on);
    let reason = format!(
        "{words}: the force grows by {} a millimetre, the particle travels {}{failed}",
        engineering(slope * 1e-3, "N", 3),
        engineering(travel, "m", 3),
    );
    let value = Some(slope.abs() * travel / magnet.force);
    EffectFinding { state: state(is_on), value, reason, trial }.entry("magnet_law", criterion)
}

/// The ring that stands for real ones, where it pulls with `force` (N).
fn ring(force: f64) -> Option<PlacedMagnet> {
    let magnet = magnets::load(RING).ok()?;
    let temperature = magnet.stated_temperature();
    let at = PlacedAt::Rest(*magnet.distances(force, temperature).first()?);
    Some(PlacedMagnet { magnet, temperature, at })
}

/// Shots at speeds of their own: one standard deviation above the mean against the mean.
pub fn striker_speed_spread(subject: &BaselineRun<'_>) -> LedgerEntry {
    let criterion = "standard deviation of the striker's speed / its mean";
    let Some(spread) = subject.scene.striker_speed_spread else {
        let reason = "no table in the scene; it needs relative, the spread".to_owned();
        return EffectFinding { state: EffectState::Off, value: None, reason, trial: None }
            .entry("striker_speed_spread", criterion);
    };
    let mut faster = subject.scene.clone();
    if let Some(speed) = faster.initial_velocities.first_mut() {
        *speed *= 1.0 + spread;
    }
    let (trial, failed) = against(subject, Ok(faster), false);
    let reason = format!(
        "on by the scene: each shot's speed is drawn from the seed; changes are those of one standard deviation{failed}"
    );
    EffectFinding { state: EffectState::On, value: Some(spread), reason, trial }
        .entry("striker_speed_spread", criterion)
}

/// A loss: its decay against the fastest contact's own frequency.
fn loss(subject: &BaselineRun<'_>, kind: LossKind, needs: &str) -> LedgerEntry {
    let name = kind.model().name;
    let setting = subject.scene.spec.effects.loss(kind);
    let criterion = "decay / angular frequency, of the most damped contact";
    if setting.is_none() {
        let reason = format!(
            "no table in the scene, and no value that holds for a material: it needs {needs}"
        );
        return EffectFinding { state: EffectState::Off, value: None, reason, trial: None }
            .entry(name, criterion);
    }
    let alone = subject.rebuilt(|scene| {
        let others = LossKind::ALL.into_iter().filter(|other| *other != kind);
        others.for_each(|other| scene.spec.effects.losses[other as usize] = None);
    });
    let value = alone.map(|s| s.chain.largest_damping(&s.initial_velocities)).ok();
    let without = subject.rebuilt(|scene| scene.spec.effects.remove(name));
    let (trial, failed) = against(subject, without, true);
    let reason = format!("on by the scene: takes energy in every closed contact{failed}");
    EffectFinding { state: EffectState::On, value, reason, trial }.entry(name, criterion)
}

/// Dashpots.
pub fn dashpot(subject: &BaselineRun<'_>) -> LedgerEntry {
    loss(subject, LossKind::Dashpot, "gamma and end_of_contact")
}

/// Viscoelastic losses.
pub fn kuwabara_kono(subject: &BaselineRun<'_>) -> LedgerEntry {
    loss(subject, LossKind::KuwabaraKono, "eta and end_of_contact")
}

/// Power-law losses.
pub fn power_law_loss(subject: &BaselineRun<'_>) -> LedgerEntry {
    loss(subject, LossKind::PowerLaw, "force_at_1_m_per_s, exponent and end_of_contact")
}

/// Contacts made linear.
pub fn linearised_contacts(subject: &BaselineRun<'_>) -> LedgerEntry {
    let is_on = subject.scene.spec.effects.linearised_contacts.is_some();
    let other = subject.rebuilt(|scene| {
        scene.spec.effects.linearised_contacts = (!is_on).then_some(LinearisedContacts);
    });
    let (trial, failed) = against(subject, other, is_on);
    let value = opening_ratio(subject);
    let reason = match (is_on, value) {
        (true, Some(value)) if value > 1.0 => {
            "on by the scene, though contacts would open: not valid here"
        }
        (true, _) => "on by the scene",
        (false, None) => "off: contacts without static force have no tangent",
        (false, Some(value)) if value > 1.0 => "off: contacts open",
        (false, _) => {
            "off: forces follow Hertz's law; the criterion says how far from small they are"
        }
    };
    let reason = format!("{reason}{failed}");
    EffectFinding { state: state(is_on), value, reason, trial }
        .entry("linearised_contacts", "largest change of a contact force / its static force")
}

/// A measured law of the contacts, against Hertz's.
pub fn contact_law(subject: &BaselineRun<'_>) -> LedgerEntry {
    let is_on = subject.scene.spec.effects.contact_law.is_some();
    let (trial, failed) = if is_on {
        let other = subject.rebuilt(|scene| scene.spec.effects.contact_law = None);
        against(subject, other, true)
    } else {
        (None, String::new())
    };
    let reason = format!("on by the scene; compared with Hertz's law{failed}");
    EffectFinding { state: state(is_on), value: None, reason, trial }.entry("contact_law", "-")
}

/// Largest change of a contact force over its static one; none where a contact has no static force.
fn opening_ratio(subject: &BaselineRun<'_>) -> Option<f64> {
    let chain = &subject.scene.chain;
    let first = usize::from(chain.has_striker());
    let films = chain.contacts().iter().zip(&subject.bench.film().contact_forces).skip(first + 1);
    let ratios = films.filter(|(contact, _)| contact.stiffness > 0.0).map(|(contact, forces)| {
        let change = |force: &f64| (force - contact.static_force).abs();
        forces.iter().map(change).fold(0.0, f64::max) / contact.static_force
    });
    Some(ratios.fold(0.0, f64::max)).filter(|ratio| ratio.is_finite())
}

/// A drive: the force of its contact at the signal's peak, if nothing else moved.
pub fn drive(subject: &BaselineRun<'_>) -> LedgerEntry {
    let criterion = "force of the drive's amplitude on its contact / smallest first peak";
    let finding = match subject.scene.chain.drives().next() {
        None => EffectFinding {
            state: EffectState::Off,
            value: None,
            reason:
                "no [drive] in the scene; it needs an end, a displacement or stack, and a signal"
                    .to_owned(),
            trial: None,
        },
        Some((contact, drive)) => {
            let force = contact.force_change(drive.amplitude);
            let other = subject.rebuilt(|scene| {
                for support in &mut scene.spec.effects.supports {
                    if support.drive().is_some() {
                        *support = Support::Rigid;
                    }
                }
            });
            let (trial, failed) = against(subject, other, true);
            let reason = format!("on by the scene's [drive]{failed}");
            let value = Some(force / subject.wave);
            EffectFinding { state: EffectState::On, value, reason, trial }
        }
    };
    finding.entry("drive", criterion)
}

/// Rods and plates: `lambda = A^(2/5) m^(3/5) v^(1/5)/Z` of the outermost body at the fastest
/// speed, of which about 1.7 is lost of the restitution.
pub fn yielding_wall(subject: &BaselineRun<'_>) -> LedgerEntry {
    let criterion = "A^(2/5) m^(3/5) v^(1/5) / impedance, of the outermost body";
    let chain = &subject.scene.chain;
    let fastest = subject.scene.initial_velocities.iter().fold(0.0_f64, |v, w| v.max(w.abs()));
    let ends = [
        (chain.contacts().first(), chain.bodies().first()),
        (chain.contacts().last(), chain.bodies().last()),
    ];
    let ratio = |((contact, body), support): (_, &Support)| {
        let (contact, body): (Option<&Contact>, Option<&Body>) = (contact, body);
        let impedance = support.backing()?.impedance;
        let (contact, mass) = (contact?, body?.mass);
        // The force of the overlap `(m v^2/A)^(1/(p+1))` over `Z v`.
        let (p, stiffness) =
            (contact.exponent(), contact.stiffness.powf(1.0 / (contact.exponent() + 1.0)));
        Some(stiffness * mass.powf(p / (p + 1.0)) * fastest.powf((p - 1.0) / (p + 1.0)) / impedance)
    };
    let value = ends.into_iter().zip(chain.supports()).filter_map(ratio).reduce(f64::max);
    let finding = if value.is_none() {
        let reason = "walls are rigid; a rod or plate in chain.top or chain.bottom gives way";
        let (state, reason) = (EffectState::Off, reason.to_owned());
        EffectFinding { state, value, reason, trial: None }
    } else {
        let other = subject.rebuilt(|scene| {
            for support in &mut scene.spec.effects.supports {
                if support.backing().is_some() {
                    *support = Support::Rigid;
                }
            }
        });
        let (trial, failed) = against(subject, other, true);
        let reason = format!("on by the scene: rods and plates give way{failed}");
        EffectFinding { state: EffectState::On, value, reason, trial }
    };
    finding.entry("yielding_wall", criterion)
}

/// Yielding of the softer bodies.
pub fn plasticity(subject: &BaselineRun<'_>) -> LedgerEntry {
    let films = subject.scene.chain.contacts().iter().zip(&subject.bench.film().contact_forces);
    let ratios = films.filter_map(|(contact, forces)| {
        let limit = contact.yield_force?;
        Some(forces.iter().copied().fold(0.0, f64::max) / limit)
    });
    let value = ratios.reduce(f64::max);
    let is_on = subject.scene.spec.effects.plasticity.is_some();
    let criterion = "largest contact force / force of first yield";
    if value.is_none() {
        let reason = "no material that touches another has a yield_strength".to_owned();
        return EffectFinding { state: state(is_on), value, reason, trial: None }
            .entry("plasticity", criterion);
    }
    let other = subject.rebuilt(|scene| {
        let thornton = Plasticity::new(PlasticModel::Thornton);
        scene.spec.effects.plasticity = (!is_on).then_some(thornton);
    });
    let (trial, failed) = against(subject, other, is_on);
    let words = match (is_on, value) {
        (true, _) => "on by the scene",
        (false, Some(value)) if value > 1.0 => {
            "no table in the scene, though contacts exceed the force at which they yield"
        }
        _ => "no table in the scene, and nothing yields",
    };
    let reason = format!("{words}; compared with thornton{failed}");
    EffectFinding { state: state(is_on), value, reason, trial }.entry("plasticity", criterion)
}

/// Mass of plates in their hosts.
pub fn host_mass(subject: &BaselineRun<'_>) -> LedgerEntry {
    let scene = subject.scene;
    let particles = &scene.spec.particles;
    let host = |site: Site| match site {
        Site::Particle(particle) => particle.checked_sub(1),
        Site::Wall => None,
    };
    let hosts: Vec<usize> = scene.sensors.iter().filter_map(|s| host(s.site)).collect();
    let own = |index: usize| mass_without_sensor(scene, index + 1);
    let ratio = |index: &usize| Some(particles.get(*index)?.mass / own(*index)? - 1.0);
    let value = hosts.iter().filter_map(ratio).reduce(|a, b| if b.abs() > a.abs() { b } else { a });
    let is_on = value.is_some_and(|value| value.abs() > ROUNDING);
    let other = subject.rebuilt(|scene| {
        for index in &hosts {
            if let (Some(own), Some(body)) = (own(*index), scene.spec.particles.get_mut(*index)) {
                body.mass = if is_on { own } else { own * (1.0 + HOST_SPREAD) };
            }
        }
    });
    let (trial, failed) = against(subject, other, is_on);
    let reason = if is_on {
        format!("on by the scene's host_mass{failed}")
    } else if value.is_none() {
        "each particle of the kind has a sensor: its own mass is not known".to_owned()
    } else {
        format!(
            "no host_mass in the scene; compared with hosts {} % heavier{failed}",
            100.0 * HOST_SPREAD
        )
    };
    let value = if hosts.is_empty() { None } else { value };
    EffectFinding { state: state(is_on), value, reason, trial }
        .entry("host_mass", "mass of a sensor's host / mass of its kind - 1")
}
