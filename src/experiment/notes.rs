//! Notes on a run: what its readings and its record lack, and where it leaves what its laws are
//! good for.

use super::acquisition::trigger_scale;
use super::extremes::Extremes;
use super::outcome::Reading;
use crate::chain::Chain;
use crate::note::Note;
use crate::quantity::engineering;
use crate::recording::Shot;
use crate::scene::{PlacedSensor, Scene, Site};
use crate::scope::acquire::TriggerPosition;

/// Hertz's law is for overlaps far below the bodies' sizes: beyond this share of a particle's
/// length it does not hold (1).
const MAX_OVERLAP_SHARE: f64 = 0.1;

/// All notes on a run whose readings are `sensors` and whose largest forces are `extremes`, and
/// those on its scene.
pub fn notes(
    scene: &Scene,
    sensors: &[Reading],
    shot: &Shot,
    found: Option<TriggerPosition>,
    extremes: Option<&Extremes>,
) -> Vec<Note> {
    let drawn = scene.striker_speed_spread.and(scene.velocities(shot.number).first().copied());
    let drawn = drawn.map(|speed| {
        let sentence = format!("the striker's speed was drawn: {}", engineering(speed, "m/s", 4));
        Note::new("striker_speed_drawn", sentence).with("speed_m_per_s", speed)
    });
    let mut notes: Vec<Note> = drawn.into_iter().collect();
    notes.extend(scene.sensors.iter().filter_map(|placed| transferred(scene, placed)));
    notes.extend(level_in_hysteresis(scene));
    notes.extend(not_triggered(scene, found));
    for capture in &shot.captures {
        let (clipped, source) = (capture.waveform.clipped(), capture.waveform.source.to_string());
        if clipped > 0 {
            let sentence = format!(
                "{source}: {clipped} samples at the end of the converter's range may be clipped"
            );
            let note = Note::new("clipped", sentence).with("channel", source);
            notes.push(note.with("samples", clipped));
        }
    }
    notes.extend(echoes(scene));
    notes.extend(indented(&scene.chain));
    notes.extend(without_strength(scene));
    notes.extend(sensors.iter().filter(|s| s.first_peak.is_none()).map(no_peak));
    if let Some(extremes) = extremes {
        let forces = extremes.forces(&scene.chain);
        notes.extend(yielding(&scene.chain, &forces));
        notes.extend(deep_overlap(&scene.chain, &forces));
        notes.extend(beyond_table(&scene.chain, extremes.pulled));
    }
    notes.extend(scene.notes.iter().cloned());
    notes
}

/// Contacts that stay elastic with plasticity on, since the strengths of both bodies are unknown.
fn without_strength(scene: &Scene) -> Option<Note> {
    scene.spec.effects.plasticity?;
    let contacts = scene.chain.contacts().iter().enumerate();
    let elastic = contacts.filter(|(_, c)| c.stiffness > 0.0 && c.yield_force.is_none());
    let elastic: Vec<usize> = elastic.map(|(j, _)| j).collect();
    let (upper, lower) = scene.chain.beside(*elastic.first()?);
    let sentence = format!(
        "{} contacts stay elastic: the first is between {upper} and {lower}, whose materials have no yield_strength",
        elastic.len()
    );
    Some(Note::new("yield_strength_unknown", sentence).with("contacts", elastic.len()))
}

/// Contacts that earlier shots have indented.
fn indented(chain: &Chain) -> Option<Note> {
    let indented = chain.contacts().iter().filter(|contact| contact.indented > 0.0);
    let residuals: Vec<f64> = indented.map(|c| c.residual_overlap(c.indented)).collect();
    let deepest = residuals.iter().copied().reduce(f64::max)?;
    let sentence = format!(
        "earlier shots have indented {} contacts, the deepest by {}",
        residuals.len(),
        engineering(deepest, "m", 3)
    );
    let note = Note::new("indented", sentence).with("contacts", residuals.len());
    Some(note.with("deepest_m", deepest))
}

/// A calibration in another kind of host than the one it is used in: a plate in a steel cylinder
/// feels 0.69 of what one in a PTFE sphere feels.
fn transferred(scene: &Scene, placed: &PlacedSensor) -> Option<Note> {
    let calibrated = placed.sensor.calibrated_host.as_ref()?;
    let host = match placed.site {
        Site::Particle(particle) => {
            let body = scene.chain.bodies().get(scene.chain.body_of(particle))?;
            body.name.to_string()
        }
        Site::Wall => "the wall".to_owned(),
    };
    (host != *calibrated).then(|| {
        let sentence = format!(
            "{}: its sensor was calibrated in {calibrated} and sits in {host}: another host passes another share of the force to the plate",
            placed.name
        );
        let note = Note::new("calibrated_in_another_host", sentence);
        let note = note.with("sensor", placed.name.as_str()).with("host", host.as_str());
        note.with("calibrated_host", calibrated.as_str())
    })
}

fn level_in_hysteresis(scene: &Scene) -> Option<Note> {
    let hysteresis = scene.scope.model.trigger_hysteresis * trigger_scale(scene)?;
    let level = scene.scope.trigger.level;
    (level.abs() < hysteresis).then(|| {
        let sentence = format!(
            "the trigger level {} is within the trigger's hysteresis of {} around zero: a pulse from rest may not trigger",
            engineering(level, "V", 3),
            engineering(hysteresis, "V", 3)
        );
        let note = Note::new("level_within_hysteresis", sentence).with("level_v", level);
        note.with("hysteresis_v", hysteresis)
    })
}

fn not_triggered(scene: &Scene, found: Option<TriggerPosition>) -> Option<Note> {
    let mut channels = scene.scope.channels.iter().flatten();
    let is_connected = channels.any(|channel| channel.input.is_some());
    if found.is_some_and(|found| found.crossed) || !is_connected {
        return None;
    }
    let interval = scene.scope.signal_interval();
    let passed = format!(
        "no sample crossed the trigger's level (they are {} apart; shorter pulses may be missed)",
        engineering(interval, "s", 3)
    );
    let note = match found {
        None => Note::new(
            "not_triggered",
            format!("the scope was not triggered: {passed}, so there are no captures"),
        ),
        Some(_) => Note::new(
            "recorded_without_trigger",
            format!("{passed}; automatic mode recorded from the striker's first contact"),
        ),
    };
    Some(note.with("interval_s", interval))
}

/// Rods whose far ends return echoes while the record is taken.
fn echoes(scene: &Scene) -> impl Iterator<Item = Note> {
    let (_, span) = scene.scope.record_span();
    let end = scene.duration.max(span);
    let ends = scene.chain.supports().iter().zip(["top", "bottom"]);
    ends.filter_map(move |(support, place)| {
        let delay = support.backing()?.echo?.delay;
        (delay < end).then(|| {
            let sentence = format!(
                "the rod at the {place} returns an echo {} after each force on it, within the record of {}",
                engineering(delay, "s", 4),
                engineering(end, "s", 3)
            );
            Note::new("echo_within_record", sentence).with("end", place).with("delay_s", delay)
        })
    })
}

fn no_peak(sensor: &Reading) -> Note {
    let name = sensor.name.as_str();
    let note = if sensor.largest_s.is_some() {
        let force = engineering(sensor.largest_n, "N", 3);
        let sentence = format!(
            "{name}: the force was still rising, at {force}, when the scene's duration ended"
        );
        Note::new("force_still_rising", sentence).with("force_n", sensor.largest_n)
    } else {
        let sentence = format!("{name}: no pulse arrived within the scene's duration");
        Note::new("no_pulse", sentence)
    };
    note.with("sensor", name)
}

/// A particle that left the distances for which its magnet's force was measured: its displacements
/// (m) reach from the first to the second.
fn beyond_table(chain: &Chain, [least, largest]: [f64; 2]) -> Option<Note> {
    let (_, pull) = chain.pull()?;
    let [near, far] = pull.known();
    let most = (near - (pull.distance - largest)).max(pull.distance - least - far);
    (most > 0.0).then(|| {
        let sentence = format!(
            "the magnet's particle goes {} beyond the ends of its table: there its force is taken to be that of the end",
            engineering(most, "m", 2)
        );
        Note::new("beyond_magnet_table", sentence).with("distance_m", most)
    })
}

/// Overlaps that are no longer small beside the particles, under the largest `forces` of the
/// contacts (N).
fn deep_overlap(chain: &Chain, forces: &[f64]) -> Option<Note> {
    if chain.is_linear() {
        return None;
    }
    let share = |j: usize| {
        let (contact, most) = (chain.contacts().get(j)?, *forces.get(j)?);
        let beside = [j.checked_sub(1), Some(j)].into_iter().flatten();
        // A flat-faced body of which only the mass is told has none.
        let lengths = beside.filter_map(|i| chain.bodies().get(i)).map(|body| body.length);
        let lengths = lengths.filter(|length| *length > 0.0);
        let overlap = contact.overlap_under(most);
        Some((j, overlap / lengths.fold(f64::INFINITY, f64::min)))
    };
    let real = (0..chain.contacts().len()).filter(|j| chain.contacts()[*j].stiffness > 0.0);
    let (j, most) = real.filter_map(share).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (upper, lower) = chain.beside(j);
    (most > MAX_OVERLAP_SHARE).then(|| {
        let sentence = format!(
            "the overlap between {upper} and {lower} reaches {most:.1} times the length of the smaller one: Hertz's law does not hold there, and these results are not those of a real chain"
        );
        Note::new("beyond_hertz", sentence).with("contact", j).with("overlap_share", most)
    })
}

/// Contacts whose largest `forces` (N) make their softer body yield.
fn yielding(chain: &Chain, forces: &[f64]) -> Option<Note> {
    let mut worst: Option<(f64, f64, usize)> = None;
    let mut count = 0;
    for (j, (contact, &most)) in chain.contacts().iter().zip(forces).enumerate() {
        let Some(limit) = contact.yield_force else { continue };
        if most > limit && contact.plastic.is_none() {
            count += 1;
            if worst.is_none_or(|(force, other, _)| most / limit > force / other) {
                worst = Some((most, limit, j));
            }
        }
    }
    let (force, limit, j) = worst?;
    let (upper, lower) = chain.beside(j);
    let exceed = if count == 1 { "contact exceeds" } else { "contacts exceed" };
    let sentence = format!(
        "{count} {exceed} the force at which the softer body yields ({} between {upper} and {lower}, yields at {}): [effects.plasticity] is off, real peaks will be lower",
        engineering(force, "N", 3),
        engineering(limit, "N", 2)
    );
    let note = Note::new("yielding", sentence).with("contacts", count).with("contact", j);
    Some(note.with("force_n", force).with("yield_force_n", limit))
}
