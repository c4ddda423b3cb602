//! Actions on the knobs of the bench: turning the selected one, and switching its effect.

use super::knobs::{BenchKnob, switched};
use super::screen_state::ScreenState;
use crate::tui::axis::TurnDirection;

impl ScreenState {
    /// Selects the next knob of those that the bench has.
    pub(super) fn next_knob(&mut self, turn: TurnDirection) {
        let scene = self.recordings.front().scene.clone();
        let Some(live) = self.bench() else { return };
        let count = BenchKnob::ALL.len();
        let step = match turn {
            TurnDirection::Up => 1,
            TurnDirection::Down => count - 1,
        };
        let is_shown = |place: usize| {
            let knob = BenchKnob::ALL.get(place);
            knob.zip(scene.as_ref()).is_none_or(|(knob, scene)| knob.is_shown(scene))
        };
        let places = (1..=count).map(|turns| (live.knob + turns * step) % count);
        live.knob = places.into_iter().find(|place| is_shown(*place)).unwrap_or(live.knob);
    }

    /// Turns the selected knob.
    pub(super) fn turn_knob(&mut self, turn: TurnDirection) {
        let Some(live) = self.bench() else { return };
        let knob = BenchKnob::ALL.get(live.knob).copied();
        let (Some(knob), Some(scene)) = (knob, self.recordings.front().scene.clone()) else {
            return;
        };
        let (source, tuned) = (self.selected, self.tuned());
        match knob.turned(&scene, &tuned, source, turn) {
            Ok((path, value)) => self.set_value(path, value),
            Err(problem) => self.notice = Some(problem),
        }
    }

    /// Opens the command line to type a value for the selected knob.
    pub(super) fn type_knob(&mut self) {
        let Some(knob) = self.bench().and_then(|live| BenchKnob::ALL.get(live.knob)) else {
            return;
        };
        let Some(scene) = &self.recordings.front().scene else { return };
        let is_off = knob.effect.is_some() && knob.value(scene, self.selected).is_none();
        match knob.path_in(scene, self.selected) {
            Some(_) if is_off => {
                self.notice = Some(format!("{} is off: o switches it on", knob.label));
            }
            Some(path) => self.open_prompt(&format!("set {path} ")),
            None => self.notice = Some("select a channel with a sensor first".to_owned()),
        }
    }

    /// Switches the effect of the selected knob.
    pub(super) fn switch_effect_of_knob(&mut self) {
        let live = self.recordings.front().live.as_ref();
        let effect = live.and_then(|live| BenchKnob::ALL.get(live.knob)?.effect);
        self.switch_effect(effect);
    }

    /// Switches `effect`, if there is one.
    pub(in crate::tui) fn switch_effect(&mut self, effect: Option<&str>) {
        if self.bench().is_none() {
            return;
        }
        if self.is_served() {
            let word = "effects of a served bench are set in its scene: view the scene itself";
            self.notice = Some(word.to_owned());
            return;
        }
        let Some(scene) = self.recordings.front().scene.clone() else { return };
        let Some(effect) = effect else {
            self.notice = Some("this knob belongs to no effect that could be switched".to_owned());
            return;
        };
        match switched(&scene, &self.tuned(), effect) {
            Ok(settings) => {
                let Some(((path, value), rest)) = settings.split_last() else { return };
                if let Some(live) = &mut self.recordings.front_mut().live {
                    live.settings.extend(rest.iter().cloned());
                }
                self.set_value(path.clone(), value.clone());
            }
            Err(problem) => self.notice = Some(problem),
        }
    }
}
