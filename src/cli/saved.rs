//! Set-up and screen that a scope saves beside its curves.

use crate::data;
use crate::instrument::Instrument;
use crate::measurement::metadata;
use crate::recording::format::set_up_of;
use crate::recording::{Shot, TraceSet};
use crate::scene::{SceneError, oscilloscope};
use crate::scpi::{Preferences, Reply, Session};
use crate::screen::Screen;

/// Set-up and screen of one shot.
pub struct Saved {
    /// Content of the `.SET` file; none where the whole front panel is not known.
    pub set_up: Option<Vec<u8>>,
    /// The screen.
    pub screen: Screen,
}

/// Set-up and screen of a shot: by the scene that travels with the recording, by the `.SET` file
/// that was imported with the captures, or, for the screen, by what the captures tell.
///
/// # Errors
/// [`SceneError`] for a recording whose scene cannot be read any more.
pub fn saved(set: &TraceSet, shot: &Shot) -> Result<Saved, SceneError> {
    if let Some(file) = set_up_of(set, shot.number) {
        // Whatever model it was: any of the family draws it.
        let model = data::instrument_names("").first().copied().unwrap_or_default();
        let mut instrument = Instrument::new(oscilloscope(model)?, 0.0, 0);
        set_up_as(&mut instrument, &file.data);
        let screen = screen_of(&mut instrument, shot);
        return Ok(Saved { set_up: Some(file.data.clone()), screen });
    }
    let Some(scene) = metadata::scene_of(set, shot.number) else {
        return Ok(Saved { set_up: None, screen: Screen::of_captures(&shot.captures) });
    };
    let scene = scene?;
    let mut instrument = Instrument::of(&scene.scope, scene.seed);
    // A served scope is set as its clients left it.
    if let Some(notes) = set.notes.get(&shot.number) {
        set_up_as(&mut instrument, notes.set_up.as_bytes());
    }
    let screen = screen_of(&mut instrument, shot);
    let mut session = Session::new(Preferences::new(true));
    let set_up = match session.receive(&mut instrument, b"SET?\n") {
        Reply::Now(bytes) => Some(bytes),
        Reply::None | Reply::WhenIdle(_) => None,
    };
    Ok(Saved { set_up, screen })
}

/// Sets an instrument as `SET?` told of one, scales between the steps included.
fn set_up_as(instrument: &mut Instrument, told: &[u8]) {
    for number in 1..=instrument.model.channels {
        instrument.panel.channel_mut(number).fine = true;
    }
    let mut session = Session::new(Preferences::new(false));
    session.receive(instrument, told);
    session.end_of_message(instrument);
}

/// The instrument's screen with the traces of a shot, spectra and references included.
fn screen_of(instrument: &mut Instrument, shot: &Shot) -> Screen {
    instrument.store(&shot.captures);
    let traces = Screen::of_captures(&shot.captures).traces;
    Screen { traces, ..Screen::of(instrument) }
}
