//! The physics that a scene switches on: `[effects.NAME]`, one row of [`EffectsKeys`] each.
//!
//! `NAME = false` switches off what a base scene switches on; `state = "off"` does, too, and keeps
//! the numbers. Effects that are switched off are read all the same, so that mistakes in them are
//! reported.

use super::bodies::{particle_in, particle_number};
use super::document::Node;
use super::magnets::{RingKeys, TableKeys, law};
use super::problem::one_of;
use super::table::{Bound, FromKey, FromTable, Key, Keys, Kind, Places, TableReader};
use super::table::{
    difference, effect, flag, list_of, not_negative, quantity, table, text, texts, word, words,
};
use crate::chain::effects::is_pair;
use crate::chain::{
    ContactLaw, ContactOverride, EffectsSpec, EndOfContact, Gravity, LOSS_MODELS,
    LinearisedContacts, LossSpec, MagnetForce, MagnetLaw, MagnetPreload, PlacedAt, PlacedMagnet,
    PlasticModel, Plasticity, Restitution,
};
use crate::magnet::Magnet;
use crate::quantity::{Dimension, engineering};
use crate::sensor::SensorTolerance;

/// The value of an effect's key `state`; its other keys stay as they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectSwitch {
    /// On; so is a table without the key.
    On,
    /// Off.
    Off,
    /// Off if the change is negligible.
    Auto,
}

impl<'a> FromKey<'a> for EffectSwitch {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        let Kind::Word(words) = key.kind else { return table.refuse(key, node) };
        let word = words().into_iter().find(|word| node.is_text(word));
        match word {
            Some("on") => Some(Self::On),
            Some("off") => Some(Self::Off),
            Some(_) => Some(Self::Auto),
            None => table.refuse(key, node),
        }
    }

    fn from_default(_: &'static str) -> Option<Self> {
        Some(Self::On)
    }
}

const STATE: Key = Key::new(Kind::Word(|| vec!["on", "off"]))
    .or("on")
    .named("state", "\"off\" keeps the numbers, \"auto\" omits it if the change is negligible");
/// The key of every effect.
const SWITCH: &[Key] = &[STATE];
/// The same of an effect with an upper bound of its influence.
const AUTO_SWITCH: &[Key] = &[Key { kind: Kind::Word(|| vec!["on", "off", "auto"]), ..STATE }];

/// The table of an effect.
pub struct Effect<T> {
    keys: T,
    state: EffectSwitch,
}

impl<'a, T: FromTable<'a>> FromKey<'a> for Effect<T> {
    fn from_node(table: &TableReader<'a>, key: &'static Key, node: &'a Node) -> Option<Self> {
        let path = table.path_of(key.name);
        if table.is_off(key.name) {
            return None;
        }
        if !node.is_table() {
            let expected =
                format!("a table [{path}], or `{path} = false` to switch the effect off");
            table.problem(key.name, node.describe(), expected);
            return None;
        }
        let inner = TableReader::of(node, &path, key.below(), table.problems())?;
        let state = key.below().iter().flat_map(|keys| keys.iter()).find(|key| key.name == "state");
        let state = state.and_then(|key| inner.get(key)).unwrap_or(EffectSwitch::On);
        Some(Self { keys: T::from_table(&inner)?, state })
    }
}

table! {
    /// `[effects]`: one row for each effect.
    pub struct EffectsKeys<'a> {
        gravity: Effect<GravityKeys<'a>> = effect(&[AUTO_SWITCH, GravityKeys::KEYS]),
        scope_noise: Effect<NoiseKeys<'a>> = effect(&[SWITCH, NoiseKeys::KEYS]),
        /// gain and zero of each channel within the data sheet, drawn from the seed
        scope_errors: Effect<NoKeys<'a>> = effect(&[SWITCH, NoKeys::KEYS]),
        /// from shot to shot
        striker_speed_spread: Effect<SpreadKeys<'a>> = effect(&[SWITCH, SpreadKeys::KEYS]),
        /// plates that differ from their data, drawn from the seed
        sensor_tolerance: Effect<ToleranceKeys<'a>> = effect(&[SWITCH, ToleranceKeys::KEYS]),
        /// a magnet that pulls a particle
        magnet_preload: Effect<MagnetPlaceKeys<'a>> =
            effect(&[SWITCH, MagnetPlaceKeys::KEYS, RingKeys::KEYS, TableKeys::KEYS]),
        /// default with a described magnet: its force follows the particle
        magnet_law: Effect<NoKeys<'a>> = effect(&[AUTO_SWITCH, NoKeys::KEYS]),
        /// contacts that yield where their softer body has a `yield_strength`
        plasticity: Effect<PlasticityKeys<'a>> = effect(&[AUTO_SWITCH, PlasticityKeys::KEYS]),
        /// a measured exponent and stiffness of the contacts
        contact_law: Effect<ContactLawKeys<'a>> = effect(&[SWITCH, ContactLawKeys::KEYS]),
        /// contacts as springs about the static state
        linearised_contacts: Effect<NoKeys<'a>> = effect(&[SWITCH, NoKeys::KEYS]),
    }
}

table! {
    /// An effect without numbers.
    pub struct NoKeys<'a> {}
}

table! {
    /// `[effects.gravity]`.
    pub struct GravityKeys<'a> {
        acceleration: f64 = quantity(Dimension::ACCELERATION, Bound::Any).required(),
    }
}

table! {
    /// `[effects.scope_noise]`.
    pub struct NoiseKeys<'a> {
        rms: f64 = not_negative(Dimension::DIVISION).required(),
    }
}

/// Largest relative standard deviation of the striker's speed (1).
const MAX_SPREAD: f64 = 0.5;

table! {
    /// `[effects.striker_speed_spread]`.
    pub struct SpreadKeys<'a> {
        /// standard deviation
        relative: f64 = quantity(Dimension::NONE, Bound::Within(0.0, MAX_SPREAD)).required(),
    }
}

table! {
    /// `[effects.sensor_tolerance]`.
    pub struct ToleranceKeys<'a> {
        spread: f64 = quantity(Dimension::NONE, Bound::Within(0.0, 0.5)).required(),
        temperature_change: f64 = difference(Dimension::TEMPERATURE),
        permittivity_coefficient: f64 = quantity(Dimension::PER_TEMPERATURE, Bound::Any),
        d33_coefficient: f64 = quantity(Dimension::PER_TEMPERATURE, Bound::Any),
    }
}

table! {
    /// `[effects.plasticity]`.
    pub struct PlasticityKeys<'a> {
        /// or `walton_braun`, with a restitution
        model: PlasticLaw = word::<PlasticLaw>().required().needs("\"thornton\" or \"walton_braun\""),
        /// of `walton_braun`, at any speed
        restitution: f64 = quantity(Dimension::NONE, Bound::Within(0.01, 1.0)),
        /// whether shots start with the indentations of the shots before
        keep_indentations: bool = flag().or("false"),
    }
}

table! {
    /// `[effects.contact_law]`: `F = force (overlap/at)^exponent`.
    pub struct ContactLawKeys<'a> {
        exponent: f64 = quantity(Dimension::NONE, Bound::Within(1.0, 5.0)).required(),
        /// at the overlap:
        force: f64 = quantity(Dimension::FORCE, Bound::FORCE).required(),
        overlap: f64 = quantity(Dimension::LENGTH, Bound::LENGTH).required(),
        /// other numbers where two kinds of bodies touch
        contacts: Vec<TableReader<'a>> = list_of(&[PairLawKeys::KEYS]),
    }
}

table! {
    /// An entry of its `contacts`.
    pub struct PairLawKeys<'a> {
        between: Places<'a> = texts().required(),
        exponent: f64 = quantity(Dimension::NONE, Bound::Within(1.0, 5.0)).required(),
        force: f64 = quantity(Dimension::FORCE, Bound::FORCE).required(),
        overlap: f64 = quantity(Dimension::LENGTH, Bound::LENGTH).required(),
    }
}

fn contact_law(keys: &ContactLawKeys<'_>, pairs: &[(&str, &str)]) -> Option<ContactLaw> {
    let law = |exponent: Option<f64>, force: Option<f64>, overlap: Option<f64>| {
        let exponent = exponent?;
        Some((exponent, force? / overlap?.powf(exponent)))
    };
    let own = keys.contacts.iter().flatten().map(|table| {
        let keys = PairLawKeys::read(table);
        let names = two_kinds(table, &keys.between.unwrap_or_default(), pairs);
        let (exponent, stiffness) = law(keys.exponent, keys.force, keys.overlap)?;
        Some((names?, exponent, stiffness))
    });
    let between: Option<Vec<_>> = own.collect();
    let (exponent, stiffness) = law(keys.exponent, keys.force, keys.overlap)?;
    Some(ContactLaw { exponent, stiffness, between: between? })
}

/// The two kinds of bodies of the list `between`, which touch by `pairs`.
fn two_kinds(
    table: &TableReader<'_>,
    names: &Places<'_>,
    pairs: &[(&str, &str)],
) -> Option<[String; 2]> {
    let [(upper, _), (lower, _)] = names.as_slice() else {
        table.problem("between", format!("{} names", names.len()), "two kinds of bodies");
        return None;
    };
    let meets = |(a, b): &(&str, &str)| is_pair(&[*a, *b], upper, lower);
    if !pairs.is_empty() && !pairs.iter().any(meets) {
        let found = format!("\"{upper}\" and \"{lower}\", which do not touch");
        let mut known: Vec<&(&str, &str)> = pairs.iter().collect();
        known.sort();
        known.dedup();
        let known = known.iter().map(|(a, b)| format!("{a} and {b}"));
        table.problem("between", found, one_of(known));
    }
    Some([(*upper).to_owned(), (*lower).to_owned()])
}

/// A law of plastic contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlasticLaw {
    /// Hertz's law up to first yield, a straight line beyond.
    Thornton,
    /// Straight lines.
    WaltonBraun,
}

words! { PlasticLaw { "thornton" => Thornton, "walton_braun" => WaltonBraun } }

fn plasticity(keys: &PlasticityKeys<'_>) -> Option<Plasticity> {
    let model = match keys.model? {
        PlasticLaw::Thornton => {
            if keys.table.has("restitution") {
                let expected = "none: Thornton's law makes its own, by the yield strength";
                keys.table.problem("restitution", "a restitution", expected);
            }
            PlasticModel::Thornton
        }
        PlasticLaw::WaltonBraun => {
            keys.table.require(PlasticityKeys::KEYS, "restitution");
            PlasticModel::WaltonBraun(keys.restitution?)
        }
    };
    Some(Plasticity { model, keeps_indentations: keys.keep_indentations? })
}

words! {
    EndOfContact {
        Self::ZeroOverlap.name() => ZeroOverlap,
        Self::ZeroForce.name() => ZeroForce,
    }
}

/// Models of losses in contacts.
const LOSSES: usize = LOSS_MODELS.len();
/// The effects of [`LOSS_MODELS`]; each table has the coefficient's name from there.
pub(super) const LOSS_KEYS: &[Key; LOSSES] = &[loss_key(0), loss_key(1), loss_key(2)];
/// Keys of the tables of losses: the coefficient, the end of a contact, and other coefficients.
const TABLES: &[[Key; 5]; LOSSES] = &[loss_keys(0), loss_keys(1), loss_keys(2)];
/// Keys of another coefficient where two kinds of bodies touch.
const CONTACTS: &[[Key; 4]; LOSSES] = &[contact_keys(0), contact_keys(1), contact_keys(2)];
/// Below an exponent of one the loss would be infinitely steep at rest.
const EXPONENT: &[Key; 1] =
    &[quantity(Dimension::NONE, Bound::Within(1.0, 5.0)).required().named("exponent", "")];

const fn loss_key(index: usize) -> Key {
    const WITH: [Keys; LOSSES] = [
        &[AUTO_SWITCH, &TABLES[0], EXPONENT],
        &[AUTO_SWITCH, &TABLES[1], EXPONENT],
        &[AUTO_SWITCH, &TABLES[2], EXPONENT],
    ];
    const WITHOUT: [Keys; LOSSES] =
        [&[AUTO_SWITCH, &TABLES[0]], &[AUTO_SWITCH, &TABLES[1]], &[AUTO_SWITCH, &TABLES[2]]];
    let model = LOSS_MODELS[index];
    let keys = if model.has_exponent { WITH[index] } else { WITHOUT[index] };
    effect(keys).named(model.name, "")
}

const fn coefficient(index: usize) -> Key {
    let model = LOSS_MODELS[index];
    quantity(model.dimension, Bound::Within(0.0, model.largest)).named(model.key, "")
}

/// A coefficient of restitution, from which the coefficient of each contact follows.
const RESTITUTION: Key = quantity(Dimension::NONE, Bound::Within(0.05, 1.0))
    .named("restitution", "instead of the coefficient, of two bodies that meet at:");
const SPEED: Key = quantity(Dimension::SPEED, Bound::SPEED).named("speed", "");

const fn loss_keys(index: usize) -> [Key; 5] {
    const BELOW: [Keys; LOSSES] = [&[&CONTACTS[0]], &[&CONTACTS[1]], &[&CONTACTS[2]]];
    let end = word::<EndOfContact>()
        .required()
        .needs("\"zero_overlap\", where a contact pulls before it ends, or \"zero_force\"");
    [
        coefficient(index),
        end.named("end_of_contact", "or \"zero_force\""),
        list_of(BELOW[index]).named("contacts", ""),
        RESTITUTION,
        SPEED,
    ]
}

const fn contact_keys(index: usize) -> [Key; 4] {
    [texts().named("between", ""), coefficient(index), RESTITUTION, SPEED]
}

table! {
    /// `[effects.magnet_preload]` beside the magnet itself.
    pub struct MagnetPlaceKeys<'a> {
        particle: &'a Node = particle_number()
            .required()
            .needs("the particle that the magnet pulls, e.g. 1"),
        /// `hertzscope list magnets`; or its own numbers; or force alone, which then is constant
        model: &'a str = text(),
        /// where it pulls so hard; or one of:
        force: f64 = quantity(Dimension::FORCE, Bound::FORCE),
        /// of the particle's centre from the magnet's face, in the static state
        distance: f64 = quantity(Dimension::LENGTH, Bound::Any),
        distance_unloaded: f64 = quantity(Dimension::LENGTH, Bound::Any),
        /// default: that of its data
        temperature: f64 = quantity(Dimension::TEMPERATURE, Bound::Positive),
    }
}

/// What `[effects]` says, besides the chain's own effects.
#[derive(Default)]
pub struct Effects {
    /// The chain's.
    pub spec: EffectsSpec,
    /// Noise of the scope's front end (div).
    pub noise: f64,
    /// Whether the scope's channels have errors within their data sheet.
    pub scope_errors: bool,
    /// How far plates may be from their data.
    pub sensor_tolerance: Option<SensorTolerance>,
    /// Relative standard deviation of the striker's speed (1).
    pub spread: Option<f64>,
    /// Effects whose state is `auto`.
    pub auto: Vec<&'static str>,
}

/// The value of an effect that is there and on.
fn on<T, S>(effect: Option<&Effect<T>>, read: impl FnOnce(&T) -> Option<S>) -> Option<S> {
    let effect = effect?;
    read(&effect.keys).filter(|_| effect.state != EffectSwitch::Off)
}

/// Reads `[effects]` of a scene with or without a striker. `pairs` are the names of the bodies that
/// touch, none if they are not known; `particles` is their number, 0 if it is not known.
pub fn effects(
    table: &TableReader<'_>,
    has_striker: bool,
    particles: usize,
    pairs: &[(&str, &str)],
) -> Effects {
    let keys = EffectsKeys::read(table);
    let magnet = |place: &MagnetPlaceKeys<'_>| magnet_preload(place, particles);
    let magnet_preload = on(keys.magnet_preload.as_ref(), magnet);
    let is_described = magnet_preload.as_ref().is_some_and(|magnet| !is_constant(magnet));
    if let (Some(law), Some(magnet)) = (&keys.magnet_law, &magnet_preload)
        && is_constant(magnet)
    {
        let expected =
            "a magnet with outer_diameter, ... or [[measured]], whose force changes with distance";
        law.keys.table.problem("", "a magnet of constant force", expected);
    }
    let law_is_off = table.is_off("magnet_law")
        || keys.magnet_law.as_ref().is_some_and(|law| law.state == EffectSwitch::Off);
    let mut ends = Vec::new();
    let effects = LOSS_KEYS.each_ref().map(|key| table.get::<Effect<NoKeys<'_>>>(key));
    let mut losses = [const { None }; LOSSES];
    for (index, (effect, spec)) in effects.iter().zip(&mut losses).enumerate() {
        *spec = on(effect.as_ref(), |keys| loss(&keys.table, index, pairs, &mut ends));
    }
    let spec = EffectsSpec {
        gravity: on(keys.gravity.as_ref(), |keys| {
            keys.acceleration.map(|acceleration| Gravity { acceleration })
        }),
        contact_law: on(keys.contact_law.as_ref(), |keys| contact_law(keys, pairs)),
        linearised_contacts: on(keys.linearised_contacts.as_ref(), |_| Some(LinearisedContacts)),
        magnet_law: (is_described && !law_is_off).then_some(MagnetLaw),
        magnet_preload,
        losses,
        plasticity: on(keys.plasticity.as_ref(), plasticity),
        ..EffectsSpec::default()
    };
    let states = [
        ("gravity", keys.gravity.as_ref().map(|effect| effect.state)),
        ("magnet_law", keys.magnet_law.as_ref().map(|effect| effect.state)),
        ("plasticity", keys.plasticity.as_ref().map(|effect| effect.state)),
    ];
    let losses = LOSS_MODELS.iter().zip(&effects);
    let losses = losses.map(|(model, effect)| (model.name, effect.as_ref().map(|e| e.state)));
    let auto =
        states.into_iter().chain(losses).filter(|(_, state)| *state == Some(EffectSwitch::Auto));
    Effects {
        spec,
        noise: on(keys.scope_noise.as_ref(), |keys| keys.rms).unwrap_or(0.0),
        scope_errors: on(keys.scope_errors.as_ref(), |_| Some(())).is_some(),
        sensor_tolerance: on(keys.sensor_tolerance.as_ref(), |keys| Some(tolerance(keys))),
        spread: on(keys.striker_speed_spread.as_ref(), |keys| {
            if !has_striker {
                keys.table.problem("", "no striker", "[striker], whose speed is spread");
            }
            keys.relative.filter(|relative| *relative > 0.0)
        }),
        auto: auto.map(|(name, _)| name).collect(),
    }
}

/// The table of the magnet, for problems that only the whole chain shows.
pub fn magnet_table<'a>(effects: &TableReader<'a>) -> Option<TableReader<'a>> {
    let node = effects.node("magnet_preload").filter(|node| node.is_table())?;
    let keys = &[SWITCH, MagnetPlaceKeys::KEYS, RingKeys::KEYS, TableKeys::KEYS];
    TableReader::of(node, &effects.path_of("magnet_preload"), keys, effects.problems())
}

fn tolerance(keys: &ToleranceKeys<'_>) -> SensorTolerance {
    if keys.temperature_change.is_some() {
        for key in ["permittivity_coefficient", "d33_coefficient"] {
            keys.table.require(ToleranceKeys::KEYS, key);
        }
    }
    SensorTolerance {
        spread: keys.spread.unwrap_or(0.0),
        temperature: keys.temperature_change.unwrap_or(0.0),
        permittivity_coefficient: keys.permittivity_coefficient.unwrap_or(0.0),
        d33_coefficient: keys.d33_coefficient.unwrap_or(0.0),
    }
}

/// The coefficient of a loss (unit), or the restitution that it follows from.
fn strength(
    table: &TableReader<'_>,
    coefficient: &'static Key,
) -> Option<(f64, Option<Restitution>)> {
    const KEYS: &[Key; 2] = &[RESTITUTION, SPEED];
    let [value, speed]: [Option<f64>; 2] = KEYS.each_ref().map(|key| table.get(key));
    match (table.has(coefficient.name), table.has("restitution")) {
        (true, true) => {
            let found = format!("a restitution beside `{}`", coefficient.name);
            table.problem("restitution", found, "one of them");
            None
        }
        (true, false) => table.get(coefficient).map(|value| (value, None)),
        (false, true) => {
            table.require(KEYS, "speed");
            Some((0.0, Some(Restitution { value: value?, speed: speed? })))
        }
        (false, false) => {
            table.missing(coefficient.name, coefficient.expected());
            None
        }
    }
}

/// A loss with its overrides, by the row of its model.
fn loss(
    table: &TableReader<'_>,
    index: usize,
    pairs: &[(&str, &str)],
    ends: &mut Vec<EndOfContact>,
) -> Option<LossSpec> {
    let [coefficient, end, contacts, ..] = TABLES.get(index)?;
    let [between, own_coefficient, ..] = CONTACTS.get(index)?;
    let value = strength(table, coefficient);
    let end: Option<EndOfContact> = table.get(end);
    let has_exponent = LOSS_MODELS.get(index)?.has_exponent;
    let exponent = if has_exponent { table.get(&EXPONENT[0]) } else { Some(1.0) };
    if let (Some(end), Some(other)) = (end, ends.first())
        && end != *other
    {
        let expected =
            format!("\"{}\", as for the other losses: a contact ends once", other.name());
        table.problem("end_of_contact", format!("\"{}\"", end.name()), expected);
    }
    ends.extend(end);
    let mut overrides = Vec::new();
    let mut complete = true;
    for own in table.get::<Vec<TableReader<'_>>>(contacts).unwrap_or_default() {
        let names: Places<'_> = own.get(between).unwrap_or_default();
        let value = strength(&own, own_coefficient);
        match two_kinds(&own, &names, pairs).zip(value) {
            Some((between, (value, restitution))) => {
                overrides.push(ContactOverride { between, value, restitution });
            }
            None => complete = false,
        }
    }
    let (value, restitution) = value?;
    let spec = LossSpec { value, restitution, exponent: exponent?, overrides, end: end? };
    complete.then_some(spec)
}

fn is_constant(magnet: &MagnetPreload) -> bool {
    matches!(magnet.force, MagnetForce::Constant(_))
}

fn magnet_preload(keys: &MagnetPlaceKeys<'_>, particles: usize) -> Option<MagnetPreload> {
    let force = magnet_force(keys);
    let particle = particle_in(&keys.table, keys.particle, particles);
    Some(MagnetPreload { particle: particle?, force: force? })
}

/// The magnet's force. A described magnet's follows the particle unless the scene says otherwise.
fn magnet_force(keys: &MagnetPlaceKeys<'_>) -> Option<MagnetForce> {
    let table = &keys.table;
    match (table.has("outer_diameter"), table.has("measured")) {
        (false, false) => {
            table.require(MagnetPlaceKeys::KEYS, "force");
            return keys.force.map(MagnetForce::Constant);
        }
        (true, true) => {
            let _ = law(table);
            table.problem("measured", "a table beside a ring", "one of them");
            return None;
        }
        _ => {}
    }
    let law = law(table);
    let places = ["distance", "distance_unloaded", "force"];
    let found: Vec<&str> = places.into_iter().filter(|key| table.has(key)).collect();
    if found.len() != 1 {
        let expected = "one of distance (in the static state), distance_unloaded and force, the magnet's position";
        let listed = if found.is_empty() { "none of them".to_owned() } else { found.join(" and ") };
        table.problem("distance", listed, expected);
        return None;
    }
    let source = table.node("source").and_then(Node::as_text).unwrap_or_default().to_owned();
    let magnet = Magnet { name: keys.model.unwrap_or("magnet").to_owned(), source, law: law? };
    let temperature = keys.temperature.unwrap_or(magnet.stated_temperature());
    let limit = magnet.temperature_limit();
    if temperature >= limit {
        let expected = format!("less than {limit:.1} K, where it is no magnet any more");
        table.problem("temperature", format!("{temperature:.1} K"), expected);
        return None;
    }
    let at = match (keys.distance, keys.distance_unloaded, keys.force) {
        (Some(distance), _, _) => PlacedAt::Rest(distance),
        (_, Some(distance), _) => PlacedAt::Unloaded(distance),
        (_, _, Some(force)) => {
            let Some(nearest) = magnet.distances(force, temperature).first().copied() else {
                let found = format!("{}, which it reaches nowhere", engineering(force, "N", 4));
                table.problem("force", found, "a force that `hertzscope magnet` shows");
                return None;
            };
            PlacedAt::Pull { force, distance: nearest }
        }
        _ => return None,
    };
    Some(MagnetForce::Placed(PlacedMagnet { magnet, temperature, at }))
}
