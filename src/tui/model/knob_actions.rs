//! Actions on the knobs of the bench: turning the selected one, and switching its effect.

use super::knobs::{BenchKnob, switched};
use super::{Page, ScreenState};
use crate::tui::axis::TurnDirection;

impl ScreenState {
    /// Turns the selected knob.
    pub(super) fn turn_knob(&mut self, turn: TurnDirection) {
        let Some(live) = self.bench() else { return };
        let knob = BenchKnob::ALL.get(live.knob).copied();
        let (Some(knob), Some(scene)) = (knob, self.scene.clone()) else { return };
        let (source, tuned) = (self.selected, self.tuned());
        match knob.turned(&scene, &tuned, source, turn) {
            Ok((path, value)) => self.set_value(path, value),
            Err(problem) => self.notice = Some(problem),
        }
    }

    /// Opens the command line to type a value for the selected knob.
    pub(super) fn type_knob(&mut self) {
        let Some(knob) = self.bench().map(|live| live.knob) else { return };
        let path = self
            .scene
            .as_ref()
            .and_then(|scene| BenchKnob::ALL.get(knob)?.path_in(scene, self.selected));
        match path {
            Some(path) => self.open_prompt(&format!("set {path} ")),
            None => self.notice = Some("select a channel with a sensor first".to_owned()),
        }
    }

    /// Switches the selected knob's effect, or on the page of accuracy the selected effect.
    pub(super) fn switch_effect(&mut self) {
        if self.bench().is_none() {
            return;
        }
        if self.is_served() {
            let word = "effects of a served bench are set in its scene: view the scene itself";
            self.notice = Some(word.to_owned());
            return;
        }
        let named = if self.page == Page::Accuracy {
            self.selected_effect()
        } else {
            self.live.as_ref().and_then(|live| BenchKnob::ALL.get(live.knob)?.effect)
        };
        let Some(scene) = self.scene.clone() else { return };
        let Some(effect) = named else {
            self.notice = Some("this knob belongs to no effect that could be switched".to_owned());
            return;
        };
        match switched(&scene, &self.tuned(), effect) {
            Ok(settings) => {
                let Some(((path, value), rest)) = settings.split_last() else { return };
                if let Some(live) = &mut self.live {
                    live.settings.extend(rest.iter().cloned());
                }
                self.set_value(path.clone(), value.clone());
            }
            Err(problem) => self.notice = Some(problem),
        }
    }
}
