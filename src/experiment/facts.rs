//! Metadata of a recording before the first sample: everything needed to make it again.

use std::collections::BTreeMap;

use super::outcome::EnergyLedger;
use super::outcome::effects;
use super::{Integration, Outcome, RunError, method};
use crate::recording::mcap::ShotNotes;
use crate::recording::mcap::message::EnergyMessage;
use crate::recording::{Attachment, TraceSet};
use crate::scene::{PlacedSensor, Scene, Site, gain_u, input_load};
use crate::scope::Deviation;
use crate::scope::set_up::set_up_text;
use crate::sensor::MotionKind;

/// Metadata records by name.
pub type Facts = BTreeMap<String, BTreeMap<String, String>>;

/// The metadata of a recording of `scene`.
///
/// # Errors
/// [`RunError::Unstable`] for a step that no run could survive: better before the file is made.
pub fn facts(scene: &Scene, integration: Integration) -> Result<Facts, RunError> {
    let method = method(scene, integration)?;
    let accuracy = match integration {
        Integration::Accuracy(accuracy) => {
            format!("{accuracy:e}")
        }
        Integration::Method(_) => "by hand".to_owned(),
    };
    let on: Vec<String> =
        effects(scene).into_iter().map(|(name, set)| format!("{name} ({set})")).collect();
    let setup = &scene.scope;
    let mut facts = Facts::new();
    let mut add = |group: &str, pairs: Vec<(&str, String)>| {
        let pairs = pairs.into_iter().map(|(key, value)| (key.to_owned(), value));
        facts.insert(group.to_owned(), pairs.collect());
    };
    add(
        "hertzscope:recording",
        vec![
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("scene", scene.name.clone()),
            ("title", scene.title.clone()),
            ("scene_sha256", scene.texts.hash().to_owned()),
            ("seed", scene.seed.to_string()),
            ("method", method.to_string()),
            ("accuracy", accuracy),
            ("effects", on.join("; ")),
            ("time_base", "seconds after the striker's first contact".to_owned()),
        ],
    );
    add(
        "hertzscope:scope",
        vec![
            ("model", setup.model.name.clone()),
            ("serial", setup.model.serial.clone()),
            ("firmware", setup.model.firmware.clone()),
            ("set_up", set_up_text(setup)),
        ],
    );
    for (number, sensor) in (1..).zip(&scene.motion_sensors) {
        let place = match sensor.kind {
            MotionKind::Vibrometer { particle, .. }
            | MotionKind::Accelerometer { particle, .. } => {
                format!("particle {particle}")
            }
            MotionKind::StrainGauge { end, distance, .. } => {
                let end = if end == 0 { "top" } else { "bottom" };
                format!("rod at the {end}, {distance} m from its face")
            }
        };
        let pairs = vec![
            ("name", sensor.name.clone()),
            ("kind", sensor.kind.name().to_owned()),
            ("site", place),
            ("unit", sensor.kind.unit().to_owned()),
            ("sensitivity_v_per_unit", sensor.sensitivity.to_string()),
        ];
        add(&format!("hertzscope:motion_sensor/{number}"), pairs);
    }
    for (number, sensor) in (1..).zip(&scene.sensors) {
        add(&format!("hertzscope:sensor/{number}"), sensor_facts(scene, sensor));
    }
    Ok(facts)
}

fn sensor_facts(scene: &Scene, placed: &PlacedSensor) -> Vec<(&'static str, String)> {
    let sensor = &placed.sensor;
    let measured = &sensor.measured;
    let mut facts = vec![
        ("name", placed.name.clone()),
        (
            "site",
            match placed.site {
                Site::Particle(particle) => format!("particle {particle}"),
                Site::Wall => "wall".to_owned(),
            },
        ),
        ("offset", placed.offset.to_string()),
        ("offset_u", placed.offset_u.to_string()),
        ("model", sensor.model.clone()),
    ];
    // A circuit that was measured whole outranks the plate's data.
    if measured.time_constant.is_none() || measured.sensitivity.is_none() {
        facts.push(("d33_c_per_n", sensor.stack_charge().to_string()));
        facts.push(("plate_capacitance_f", sensor.stack_capacitance().to_string()));
        facts.push(("cable_capacitance_f", sensor.cable_capacitance.to_string()));
    }
    facts.extend(sensor.calibrated_host.clone().map(|host| ("calibrated_host", host)));
    let wired = (1..).zip(&scene.scope.channels).find_map(|(number, channel)| {
        let channel = channel.as_ref()?;
        (channel.input.as_ref() == Some(&placed.name)).then_some((number, channel))
    });
    // What the experimenter knows; with a tolerance, the plate at the bench is another one.
    let circuit = wired.map(|(_, channel)| sensor.connect(input_load(&scene.scope.model, channel)));
    // What the scene states outranks the sensor's file.
    let u = |key: &str, value: Option<f64>, of_file: Option<f64>| {
        let stated = scene.stated_uncertainty_of(&format!("sensors.{}.{key}", placed.name));
        let standard = stated.zip(value).map(|(s, value)| s.distribution.standard(value) / value);
        standard.or(of_file)
    };
    let sensitivity = circuit.map(|circuit| circuit.sensitivity).or(measured.sensitivity);
    let sensitivity_u = u("sensitivity", sensitivity, measured.sensitivity_u);
    let time_constant = circuit.map(|circuit| circuit.time_constant).or(measured.time_constant);
    let time_constant_u = u("tau", time_constant, measured.time_constant_u);
    let pairs =
        [("sensitivity_u_relative", sensitivity_u), ("time_constant_u_relative", time_constant_u)];
    facts.extend(pairs.into_iter().filter_map(|(key, u)| Some((key, u?.to_string()))));
    if let Some(((number, channel), circuit)) = wired.zip(circuit) {
        facts.push(("channel", format!("CH{number}")));
        // A bench whose scope is exact has no error of the gain to count.
        let is_exact = channel.deviation == Deviation::default();
        let gain = gain_u(&scene.scope.model, number, &channel.vertical, measured.chain);
        facts.push(("gain_u_relative", if is_exact { 0.0 } else { gain }.to_string()));
        if let Some(chain) = measured.chain {
            facts.extend(chain.facts());
        }
        facts.push(("sensitivity_v_per_n", circuit.sensitivity.to_string()));
        facts.push(("time_constant_s", circuit.time_constant.to_string()));
        let index = scene.sensors.iter().position(|other| other.name == placed.name);
        let there = scene.sensor_tolerance.and(index).and_then(|i| scene.circuit(i, channel));
        if let Some(there) = there {
            facts.push(("true_sensitivity_v_per_n", there.sensitivity.to_string()));
            facts.push(("true_time_constant_s", there.time_constant.to_string()));
        }
    }
    facts
}

/// The metadata of shot `number` in a recording of another scene, or of the same with other knobs:
/// its scene, what was turned of it, and its sensors.
pub fn shot_facts(scene: &Scene, number: u32, impact: u32) -> Facts {
    let mut known = vec![
        ("scene", scene.name.clone()),
        ("scene_sha256", scene.texts.hash().to_owned()),
        ("seed", scene.seed.to_string()),
        ("impact", impact.to_string()),
    ];
    let knobs = [
        ("striker_mass_kg", scene.spec.striker.as_ref().map(|striker| striker.mass)),
        ("striker_speed_m_s", scene.striker_speed()),
        ("magnet_force_n", scene.chain.magnet().map(|magnet| magnet.force)),
    ];
    known.extend(knobs.into_iter().filter_map(|(key, value)| Some((key, value?.to_string()))));
    let group = |pairs: Vec<(&str, String)>| {
        pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
    };
    let mut facts = Facts::from([(format!("hertzscope:shot/{number}"), group(known))]);
    for (index, sensor) in (1..).zip(&scene.sensors) {
        let name = format!("hertzscope:shot/{number}/sensor/{index}");
        facts.insert(name, group(sensor_facts(scene, sensor)));
    }
    facts
}

/// Ending of the merged scene that travels with a recording.
const MERGED: &str = ".merged.toml";

/// The scene as typed, and merged with everything it is based on, to travel with a recording: the
/// merged one can be read anywhere.
pub fn scene_attachments(scene: &Scene) -> Vec<Attachment> {
    let attachment = |ending: &str, text: &str| Attachment {
        name: format!("{}{ending}", scene.name),
        media_type: "application/toml".to_owned(),
        data: text.as_bytes().to_vec(),
    };
    let merged = scene.texts.merged().map(|text| attachment(MERGED, text));
    std::iter::once(attachment(".toml", &scene.text)).chain(merged).collect()
}

/// The recording of a scene's impacts: their shots with everything that is known about them.
///
/// # Errors
/// As [`facts`].
pub fn recording(
    scene: &Scene,
    integration: Integration,
    outcomes: impl IntoIterator<Item = Outcome>,
) -> Result<TraceSet, RunError> {
    let mut set = TraceSet {
        metadata: facts(scene, integration)?,
        attachments: scene_attachments(scene),
        ..TraceSet::default()
    };
    for outcome in outcomes {
        let notes = shot_notes(scene, &outcome);
        set.log.extend(notes.log.iter().map(|(_, line)| line.clone()));
        set.notes.insert(outcome.shot.number, notes);
        set.shots.push(outcome.shot);
    }
    Ok(set)
}

/// Records of a shot beside its traces.
pub fn shot_notes(scene: &Scene, outcome: &Outcome) -> ShotNotes {
    let energy = &outcome.summary.energy;
    let summary = &outcome.summary;
    let done = format!(
        "{}: {} steps, {} force evaluations, energy drift {:.1e}",
        summary.method, summary.steps, summary.force_evaluations, energy.drift
    );
    let notes = summary.notes.iter().map(|note| (true, note.sentence.clone()));
    ShotNotes {
        set_up: set_up_text(&scene.scope),
        energy: Some(energy_facts(energy, outcome.shot.number)),
        log: std::iter::once((false, done)).chain(notes).collect(),
    }
}

/// The ledger of shot `number` as it is recorded.
fn energy_facts(energy: &EnergyLedger, number: u32) -> EnergyMessage {
    let (end, lost) = (&energy.final_by_kind, &energy.dissipated_by_kind);
    let taken = |name: &str| {
        lost.losses.iter().find(|entry| entry.loss == name).map_or(0.0, |entry| entry.energy)
    };
    EnergyMessage {
        timestamp: None,
        shot: number,
        initial_j: energy.initial,
        final_j: energy.r#final,
        dissipated_j: energy.dissipated,
        drift: energy.drift,
        kinetic_j: end.kinetic,
        elastic_j: end.elastic,
        gravity_j: end.gravity,
        magnet_j: end.magnet,
        end_forces_j: end.end_forces,
        dashpot_j: taken("dashpot"),
        kuwabara_kono_j: taken("kuwabara_kono"),
        power_law_loss_j: taken("power_law_loss"),
        left_in_contacts_j: lost.left_in_contacts,
        plasticity_j: taken("plasticity"),
        top_wall_j: taken("top_wall"),
        bottom_wall_j: taken("bottom_wall"),
        work_of_drive_j: lost.work_of_drive.unwrap_or(0.0),
    }
}
