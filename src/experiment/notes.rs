//! Notes of a run for the user.

use super::acquisition::trigger_scale;
use super::frames::Frames;
use super::outcome::Reading;
use crate::chain::Chain;
use crate::quantity::engineering;
use crate::recording::Shot;
use crate::scene::{PlacedSensor, Scene, Site};
use crate::scope::acquire::TriggerPosition;

/// A calibration in another kind of host than the one it is used in: a plate in a steel cylinder feels 0.69 of what one in a PTFE sphere feels.
fn transferred(scene: &Scene, placed: &PlacedSensor) -> Option<String> {
    let calibrated = placed.sensor.calibrated_host.as_ref()?;
    let host = match placed.site {
        Site::Particle(particle) => {
            let body = scene.chain.bodies().get(scene.chain.body_of(particle))?;
            body.name.to_string()
        }
        Site::Wall => "the wall".to_owned(),
    };
    (host != *calibrated).then(|| {
        format!(
            "{}: its sensor was calibrated in {calibrated} and sits in {host}: another host passes another share of the force to the plate",
            placed.name
        )
    })
}

/// Notes on trigger, clipping, and pulses that did not come.
pub fn notes(
    scene: &Scene,
    sensors: &[Reading],
    shot: &Shot,
    found: Option<TriggerPosition>,
) -> Vec<String> {
    let mut notes = Vec::new();
    let drawn = scene.striker_speed_spread.and(scene.velocities(shot.number).first().copied());
    let told = |v| format!("the striker's speed was drawn: {}", engineering(v, "m/s", 4));
    notes.extend(drawn.map(told));
    notes.extend(scene.sensors.iter().filter_map(|placed| transferred(scene, placed)));
    if let Some(scale) = trigger_scale(scene) {
        let (level, deaf) =
            (scene.scope.trigger.level, scene.scope.model.trigger_hysteresis * scale);
        if level.abs() < deaf {
            notes.push(format!("the trigger level {} is within the trigger's hysteresis of {} around zero: a pulse from rest may not trigger", engineering(level, "V", 3), engineering(deaf, "V", 3)));
        }
    }
    let interval = scene.scope.signal_interval();
    let apart = engineering(interval, "s", 3);
    let passed = format!(
        "no sample crossed the trigger's level (they are {apart} apart; shorter pulses may be missed)"
    );
    match found {
        None => {
            notes.push(format!("the scope was not triggered: {passed}, so there are no captures"));
        }
        Some(found) if !found.crossed => {
            notes.push(format!(
                "{passed}; automatic mode recorded from the striker's first contact"
            ));
        }
        Some(_) => {}
    }
    for capture in &shot.captures {
        let clipped = capture.waveform.clipped();
        if clipped > 0 {
            notes.push(format!(
                "{}: {clipped} samples at the end of the converter's range may be clipped",
                capture.waveform.source
            ));
        }
    }
    for sensor in sensors.iter().filter(|s| s.first_peak.is_none()) {
        let felt = if sensor.largest_s.is_some() {
            let force = engineering(sensor.largest_n, "N", 3);
            format!("the force was still rising, at {force}, when the scene's duration ended")
        } else {
            "no pulse arrived within the scene's duration".to_owned()
        };
        notes.push(format!("{}: {felt}", sensor.name));
    }
    notes
}

/// A note on a particle that left the distances for which its magnet's force was measured, as far as the film's frames show.
pub fn beyond_table(chain: &Chain, film: &Frames) -> Option<String> {
    let (body, pull) = chain.pull()?;
    let [near, far] = pull.known();
    let path = film.displacements.get(body)?;
    let beyond = |u: &f64| (near - (pull.distance - u)).max(pull.distance - u - far);
    let most = path.iter().map(beyond).fold(0.0, f64::max);
    (most > 0.0).then(|| {
        format!(
            "the magnet's particle goes at least {} beyond the ends of its table: there its force is taken to be that of the end",
            engineering(most, "m", 2)
        )
    })
}
