//! Metadata of a recording: its scene, its sensors, and its chain's pass bands.

use std::collections::BTreeMap;

use crate::analysis::dispersion::DiatomicChain;
use crate::quantity::Uncertain;
use crate::quantity::engineering;
use crate::recording::TraceSet;
use crate::scene::{PlatePlace, Scene, SceneError, Site};
use crate::sensor::InChain;

/// Metadata groups of distances begin like this.
const DISTANCE: &str = "hertzscope:distance/";

/// A sensor as the recording's metadata describe it.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedSensor {
    /// Name in the scene.
    pub name: String,
    /// Channel it was wired to, `CH1`.
    pub channel: Option<String>,
    /// Place of its plate, if known.
    pub place: Option<PlatePlace>,
    /// Voltage per force before any droop (V/N).
    pub sensitivity: Option<f64>,
    /// Relative standard uncertainty of the sensitivity, where the sensor was calibrated (1).
    pub sensitivity_u: Option<f64>,
    /// Relative standard uncertainty of the channel's gain for this sensor; 0 for an exact scope,
    /// or one calibrated with the sensor (1).
    pub gain_u: f64,
    /// The channel and range that it was calibrated with as one chain.
    pub chain: Option<InChain>,
    /// Time constant of sensor and scope input (s).
    pub time_constant: Option<f64>,
    /// Relative standard uncertainty of the time constant, where the sensor was calibrated (1).
    pub time_constant_u: Option<f64>,
    /// Kind of the particle in which it was calibrated, if known.
    pub calibrated_host: Option<String>,
}

/// A distance along the chain between two channels' sensors, as the experimenter measured it.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedDistance {
    /// Channel from which, `CH1`.
    pub from: String,
    /// Channel to which.
    pub to: String,
    /// The distance, in metres.
    pub distance: Uncertain,
}

impl RecordedDistance {
    /// The metadata record that keeps it, with its name.
    pub fn facts(&self) -> (String, BTreeMap<String, String>) {
        let facts = [
            ("from", self.from.clone()),
            ("to", self.to.clone()),
            ("distance_m", self.distance.value.to_string()),
            ("distance_u_m", self.distance.u.to_string()),
        ];
        let facts = facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
        (format!("{DISTANCE}{}-{}", self.from, self.to), facts)
    }
}

/// The distances that a recording's metadata tell.
pub fn distances(set: &TraceSet) -> Vec<RecordedDistance> {
    let groups = set.metadata.iter().filter(|(name, _)| name.starts_with(DISTANCE));
    groups
        .filter_map(|(_, facts)| {
            let number =
                |key: &str| facts.get(key)?.parse().ok().filter(|value: &f64| value.is_finite());
            Some(RecordedDistance {
                from: facts.get("from")?.clone(),
                to: facts.get("to")?.clone(),
                distance: Uncertain::normal(number("distance_m")?, number("distance_u_m")?),
            })
        })
        .collect()
}

/// The scene that travels with a recording; none where none does, as with a real scope's files.
///
/// # Errors
/// [`SceneError`] for a scene that this version cannot read, or that stands on a file that is not
/// there.
pub fn scene(set: &TraceSet) -> Option<Result<Scene, SceneError>> {
    let attachment = set.attachments.iter().find(|a| a.media_type == "application/toml")?;
    let name = attachment.name.strip_suffix(".toml").unwrap_or(&attachment.name);
    attached_scene(set, name)
}

/// The attached scene `name`: the merged one, which needs no other file, or in recordings of older
/// versions the scene as typed.
fn attached_scene(set: &TraceSet, name: &str) -> Option<Result<Scene, SceneError>> {
    let attachment = [".merged.toml", ".toml"].into_iter().find_map(|ending| {
        let file = format!("{name}{ending}");
        set.attachments.iter().find(|attachment| attachment.name == file)
    })?;
    let text = String::from_utf8_lossy(&attachment.data);
    Some(Scene::from_text(name, &attachment.name, &text))
}

/// The scene of one shot: that of the recording, or where the shot has another, that one, with what
/// was turned of it.
///
/// # Errors
/// As [`scene`].
pub fn scene_of(set: &TraceSet, shot: u32) -> Option<Result<Scene, SceneError>> {
    let Some(facts) = set.metadata.get(&format!("hertzscope:shot/{shot}")) else {
        return scene(set);
    };
    let name = facts.get("scene")?;
    let knob = |key: &str| facts.get(key)?.parse().ok();
    let (mass, speed) = (knob("striker_mass_kg"), knob("striker_speed_m_s"));
    match attached_scene(set, name)? {
        Ok(scene) => Some(Ok(scene.altered(mass, speed, knob("magnet_force_n")).ok()?)),
        Err(error) => Some(Err(error)),
    }
}

/// Whether `set` was simulated with a scope without errors of its gain.
pub fn is_scope_exact(set: &TraceSet) -> bool {
    let effects = set.metadata.get("hertzscope:recording").and_then(|facts| facts.get("effects"));
    effects.is_some_and(|effects| !effects.contains("scope_errors"))
}

/// The sensors that a recording's metadata name.
pub fn sensors(set: &TraceSet) -> Vec<RecordedSensor> {
    sensors_below(set, "hertzscope:sensor/")
}

/// The sensors of one shot: those of the recording, or where the shot has a scene of its own, that
/// one's.
pub fn sensors_of(set: &TraceSet, shot: u32) -> Vec<RecordedSensor> {
    let own = format!("hertzscope:shot/{shot}");
    if set.metadata.contains_key(&own) {
        sensors_below(set, &format!("{own}/sensor/"))
    } else {
        sensors(set)
    }
}

impl RecordedSensor {
    /// Relative standard uncertainty of newtons from the sensitivity and the channel's gain (1).
    pub fn scale_u(&self) -> f64 {
        self.sensitivity_u.unwrap_or(0.0).hypot(self.gain_u)
    }

    /// Relative limit within which the channel's gain is evenly distributed; 0 where it is normal,
    /// as the quotient of two ranges' gains (1).
    pub fn gain_half_width(&self) -> f64 {
        if self.chain.is_some() { 0.0 } else { 3f64.sqrt() * self.gain_u }
    }

    /// What to say where the channel's gain counts.
    pub fn gain_note(&self) -> Option<String> {
        if self.gain_u <= 0.0 {
            return None;
        }
        let channel = self.channel.as_deref().unwrap_or("the channel");
        let chain = self.chain.map_or_else(String::new, |chain| {
            let (channel, range) = (chain.channel, engineering(chain.range, "V/div", 3));
            format!(" (the sensor was calibrated in chain with CH{channel} at {range}, not with this range)")
        });
        Some(format!(
            "{channel}: newtons count the scope's gain with u = {:.2} %, from its data sheet{chain}",
            100.0 * self.gain_u
        ))
    }

    /// What to say where it sits in another kind of particle in `scene` than it was calibrated in.
    pub fn host_note(&self, scene: &Scene) -> Option<String> {
        let (calibrated, Site::Particle(particle)) = (self.calibrated_host.as_ref()?, self.site()?)
        else {
            return None;
        };
        let host = &scene.chain.bodies().get(scene.chain.body_of(particle))?.name;
        (**host != **calibrated).then(|| {
            format!(
                "{}: its sensor was calibrated in {calibrated} and sits in {host}: another host passes another share of the force to the plate, in a heavy one about 30 % less than in a light one",
                self.name
            )
        })
    }

    /// Its host, if known.
    pub fn site(&self) -> Option<Site> {
        self.place.map(|place| place.site)
    }
}

fn sensors_below(set: &TraceSet, prefix: &str) -> Vec<RecordedSensor> {
    let groups = set.metadata.iter().filter(|(name, _)| name.starts_with(prefix));
    groups.map(|(_, facts)| sensor(facts)).collect()
}

fn sensor(facts: &BTreeMap<String, String>) -> RecordedSensor {
    let number = |key: &str| {
        let value: f64 = facts.get(key)?.parse().ok()?;
        (value.is_finite() && value > 0.0).then_some(value)
    };
    let offset = |key: &str| facts.get(key).and_then(|text| text.parse().ok()).unwrap_or(0.0);
    let site = facts.get("site").and_then(|site| match site.strip_prefix("particle ") {
        Some(particle) => particle.parse().ok().map(Site::Particle),
        None => (site == "wall").then_some(Site::Wall),
    });
    RecordedSensor {
        name: facts.get("name").cloned().unwrap_or_default(),
        channel: facts.get("channel").cloned(),
        place: site.map(|site| PlatePlace {
            site,
            offset: offset("offset"),
            offset_u: offset("offset_u"),
        }),
        sensitivity: number("sensitivity_v_per_n"),
        sensitivity_u: number("sensitivity_u_relative"),
        gain_u: number("gain_u_relative").unwrap_or(0.0),
        chain: InChain::of_facts(facts),
        time_constant: number("time_constant_s"),
        time_constant_u: number("time_constant_u_relative"),
        calibrated_host: facts.get("calibrated_host").cloned(),
    }
}

/// The linear chain of two masses in turn, or of equal ones, that `scene`'s chain is around `site`,
/// at the static force there; none where the chain is not periodic or nothing presses.
pub fn cell(scene: &Scene, site: Site) -> Option<DiatomicChain> {
    cell_and_force(scene, site).map(|(cell, _)| cell)
}

/// The same with the static force there (N).
pub fn cell_and_force(scene: &Scene, site: Site) -> Option<(DiatomicChain, f64)> {
    cell_under(scene, site, 0.0)
}

/// The same; where nothing presses, under `force` (N).
///
/// `force` overlaps contacts of the exponent `n` by `(F/A)^(1/n)`, which shortens the cell, and
/// gives them the stiffness `n F/overlap`.
pub fn cell_under(scene: &Scene, site: Site, force: f64) -> Option<(DiatomicChain, f64)> {
    let chain = &scene.chain;
    let last = chain.particles();
    let particle = match site {
        Site::Particle(particle) => particle,
        Site::Wall => last,
    };
    let body = |particle: usize| chain.bodies().get(chain.body_of(particle));
    // A particle, its neighbour of the other kind and the next of its own, downward if that is a
    // cell, else upward.
    let is_cell = |upper: usize| {
        let (first, second, third) = (body(upper)?, body(upper + 1)?, body(upper + 2)?);
        (first.repeats_after(second, third) && upper >= 1 && upper + 2 <= last).then_some(upper)
    };
    let upper = is_cell(particle).or_else(|| is_cell(particle.checked_sub(2)?))?;
    // A sensor makes its host heavier: the chain's period has the masses of particles without one.
    let mass = |particle: usize| {
        mass_without_sensor(scene, particle).or_else(|| body(particle).map(|body| body.mass))
    };
    let here = mass(upper)?;
    let other = if body(upper)?.name == body(upper + 1)?.name { here } else { mass(upper + 1)? };
    let contact = chain.contacts().get(chain.body_of(upper) + 1)?;
    let exponent = contact.exponent();
    let is_pressed = contact.static_force > 0.0;
    let overlap = if is_pressed { 0.0 } else { (force / contact.stiffness).powf(1.0 / exponent) };
    let stiffness =
        if overlap > 0.0 { exponent * force / overlap } else { contact.static_stiffness() };
    let cell = DiatomicChain {
        light_mass: here.min(other),
        heavy_mass: here.max(other),
        stiffness,
        exponent,
        cell: chain.distance(upper, upper + 2) - 2.0 * overlap,
    };
    let pressed = if overlap > 0.0 { force } else { contact.static_force };
    (stiffness > 0.0).then_some((cell, pressed))
}

/// Mass that `particle` would have without a sensor: that of the nearest particle in size, then in
/// place, of its kind that hosts none, scaled to its length; none if all of them host one (kg).
pub fn mass_without_sensor(scene: &Scene, particle: usize) -> Option<f64> {
    let chain = &scene.chain;
    let body = |p: usize| chain.bodies().get(chain.body_of(p));
    let host = body(particle)?;
    let is_bare = |p: &usize| scene.sensors.iter().all(|s| s.site != Site::Particle(*p));
    let candidate = |p: usize| {
        let bare = body(p).filter(|bare| bare.name == host.name)?;
        let ratio = host.length / bare.length;
        Some((ratio.ln().abs(), p.abs_diff(particle), bare.mass * ratio.powi(3)))
    };
    let candidates = (1..=chain.particles()).filter(is_bare).filter_map(candidate);
    let nearest = candidates.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    nearest.map(|(.., mass)| mass)
}

/// A contact of each cell of `beads` (1 or 2) in the periodic part of `scene`'s chain around
/// `particle`, from the top; none where it is not periodic.
pub fn cells(scene: &Scene, particle: usize, beads: usize) -> Option<Vec<usize>> {
    let chain = &scene.chain;
    let body = |p: usize| chain.bodies().get(chain.body_of(p));
    let takes_turns = |p: usize| {
        let (first, second, third) = (body(p)?, body(p + 1)?, body(p + 2)?);
        Some(first.repeats_after(second, third))
    };
    let turns = |p: usize| p >= 1 && p + 2 <= chain.particles() && takes_turns(p).unwrap_or(false);
    let start = [particle, particle.saturating_sub(1), particle.saturating_sub(2)];
    let start = start.into_iter().find(|p| turns(*p))?;
    let first = (1..=start).rev().take_while(|p| turns(*p)).last()?;
    let last = (start..=chain.particles()).take_while(|p| turns(*p)).last()? + 2;
    Some((first..last).step_by(beads.max(1)).map(|p| chain.body_of(p) + 1).collect())
}
