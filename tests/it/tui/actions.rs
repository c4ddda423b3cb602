//! Actions to the model.

use super::bench::{after, channel, four_channels, model, recording, spectrum, step};
use hertzscope::recording::TraceSet;
use hertzscope::scope::Source;
use hertzscope::tui::axis::{TurnDirection, Vertical};
use hertzscope::tui::model::{Action, Popup, ScreenState, Visibility};

const ZOOM_IN: Action = Action::TimePerDivision { turn: TurnDirection::Down, anchor: 0.0 };
const ZOOM_OUT: Action = Action::TimePerDivision { turn: TurnDirection::Up, anchor: 0.0 };

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-12 + 1e-9 * expected.abs()
}

fn vertical(model: &ScreenState) -> Vertical {
    model.vertical(&model.selected().expect("a selected trace").waveform)
}

fn time_scale(model: &ScreenState) -> f64 {
    model.window().expect("a window").scale
}

#[test]
fn a_channel_button_selects_then_turns_off_then_on() {
    let visibility = |model: &ScreenState| model.visibility(&model.captures()[1].waveform);
    let model = after(four_channels(), &[Action::Channel(2)]);
    assert!(model.is_selected(Source::Channel(2)));
    assert_eq!(visibility(&model), Visibility::Shown);
    let model = after(model, &[Action::Channel(2)]);
    assert_eq!(visibility(&model), Visibility::Off);
    assert!(model.is_selected(Source::Channel(2)));
    let model = after(model, &[Action::Channel(2)]);
    assert_eq!(visibility(&model), Visibility::Shown);
    // A button of a channel that is off brings it back, whatever was selected meanwhile.
    let model = after(model, &[Action::Channel(2), Action::Channel(1), Action::Channel(2)]);
    assert_eq!(visibility(&model), Visibility::Shown);
}

#[test]
fn a_button_without_channel_says_so_and_changes_nothing() {
    let model = after(model(recording(vec![vec![step()]])), &[Action::Channel(4)]);
    assert!(model.is_selected(Source::Channel(1)));
    assert_eq!(model.notice.as_deref(), Some("CH4 is not in this shot"));
    assert_eq!(after(model, &[Action::Reset]).notice, None);
}

#[test]
fn tab_goes_round_the_traces() {
    let next = Action::NextTrace(TurnDirection::Up);
    let model = after(four_channels(), &[next, next, next]);
    assert!(model.is_selected(Source::Channel(4)));
    let model = after(model, &[next]);
    assert!(model.is_selected(Source::Channel(1)));
    let model = after(model, &[Action::NextTrace(TurnDirection::Down)]);
    assert!(model.is_selected(Source::Channel(4)));
}

#[test]
fn volts_per_division_go_in_steps_of_1_2_5() {
    let mut model = four_channels();
    for expected in [0.2, 0.1, 0.05, 0.02] {
        model = after(model, &[Action::VoltsPerDivision(TurnDirection::Down)]);
        assert!(near(vertical(&model).scale, expected), "{expected}");
    }
    // One level is 20 mV: a finer scale than a level a division shows nothing more.
    model = after(model, &[Action::VoltsPerDivision(TurnDirection::Down)]);
    assert!(near(vertical(&model).scale, 0.02));
    for expected in [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0] {
        model = after(model, &[Action::VoltsPerDivision(TurnDirection::Up)]);
        assert!(near(vertical(&model).scale, expected), "{expected}");
    }
}

/// Real files have scales such as 0.288 V/div, set with the fine knob.
#[test]
fn a_recorded_scale_between_two_steps_is_found_again() {
    let fine = channel(1, 0.288, 0.0, |_| 0.0);
    let mut model = model(recording(vec![vec![fine]]));
    for (turn, expected) in [
        (TurnDirection::Up, 0.5),
        (TurnDirection::Down, 0.288),
        (TurnDirection::Down, 0.2),
        (TurnDirection::Up, 0.288),
    ] {
        model = after(model, &[Action::VoltsPerDivision(turn)]);
        assert!(near(vertical(&model).scale, expected), "{expected}");
    }
}

#[test]
fn only_the_selected_trace_is_moved() {
    let model = after(
        four_channels(),
        &[
            Action::Position(TurnDirection::Up),
            Action::Position(TurnDirection::Up),
            Action::Position(TurnDirection::Up),
        ],
    );
    assert!(near(vertical(&model).position, 1.2));
    let other = after(model, &[Action::Channel(2)]);
    assert!(near(vertical(&other).position, -1.0));
}

#[test]
fn seconds_per_division_go_in_steps_of_1_2_5_5_until_a_point_a_division() {
    let mut model = four_channels();
    for expected in [100e-6, 50e-6, 25e-6, 10e-6, 5e-6, 2.5e-6, 1e-6, 1e-6] {
        model = after(model, &[ZOOM_IN]);
        assert!(near(time_scale(&model), expected), "{expected}");
    }
    let out = vec![ZOOM_OUT; 9];
    let model = after(model, &out);
    assert!(near(time_scale(&model), 250e-6));
    assert!(!model.is_zoomed());
}

#[test]
fn zooming_around_a_point_leaves_it_where_it_is() {
    let in_at_trigger = Action::TimePerDivision { turn: TurnDirection::Down, anchor: -4.0 };
    let model = after(four_channels(), &[in_at_trigger]);
    let window = model.window().expect("a window");
    // The trigger, time 0, was 4 divisions left of the centre and still is.
    assert!(near(window.centre - 4.0 * window.scale, 0.0));
}

#[test]
fn panning_moves_the_picture_and_stops_at_the_ends_of_the_record() {
    let model = after(four_channels(), &[Action::Pan(TurnDirection::Up)]);
    assert!(!model.is_zoomed(), "the whole record is on screen");
    let model = after(model, &[ZOOM_IN, Action::Pan(TurnDirection::Up)]);
    // The picture moves right by half a division of 100 µs: earlier times come into view.
    let window = model.window().expect("a window");
    assert!(near(window.centre, 0.95e-3));
    let model = after(model, &[Action::Pan(TurnDirection::Up); 100]);
    let left = model.window().expect("a window").left();
    assert!(near(left, -250e-6), "{left}");
}

#[test]
fn reset_brings_back_everything_but_what_is_off() {
    let model = after(
        four_channels(),
        &[
            Action::Channel(2),
            Action::Channel(2),
            Action::Channel(1),
            ZOOM_IN,
            Action::VoltsPerDivision(TurnDirection::Up),
            Action::Position(TurnDirection::Up),
            Action::Reset,
        ],
    );
    assert!(!model.is_zoomed());
    let recorded = Vertical { scale: 0.5, position: 0.0 };
    assert!(vertical(&model).same_as(&recorded));
    let second = &model.captures()[1].waveform;
    assert_eq!(model.visibility(second), Visibility::Off);
}

#[test]
fn another_shot_is_shown_at_the_same_place() {
    let shots = vec![vec![step()], vec![step()], vec![spectrum()]];
    let next = Action::Shot(TurnDirection::Up);
    let model = after(model(recording(shots)), &[ZOOM_IN, next]);
    assert_eq!(model.shot_index(), 1);
    assert!(near(time_scale(&model), 100e-6));
    // A spectrum has other abscissae: it is shown as recorded.
    let model = after(model, &[next]);
    assert!(model.is_selected(Source::Math));
    assert!(near(time_scale(&model), 50e3));
    let model = after(model, &[next]);
    assert_eq!(model.shot_index(), 2);
    assert!(model.notice.as_deref().is_some());
}

#[test]
fn a_spectrum_and_a_signal_are_not_on_screen_together() {
    let set = recording(vec![vec![step(), spectrum()]]);
    let model = after(model(set), &[ZOOM_IN]);
    let visibility = |model: &ScreenState, index: usize| {
        let capture = &model.captures()[index];
        model.visibility(&capture.waveform)
    };
    assert_eq!(visibility(&model, 0), Visibility::Shown);
    assert_eq!(visibility(&model, 1), Visibility::OtherAxis);
    let model = after(model, &[Action::NextTrace(TurnDirection::Up)]);
    assert_eq!(visibility(&model, 0), Visibility::OtherAxis);
    assert_eq!(visibility(&model, 1), Visibility::Shown);
    assert!(near(time_scale(&model), 50e3));
}

#[test]
fn escape_closes_a_panel_before_it_leaves() {
    let model = after(four_channels(), &[Action::Toggle(Popup::Help)]);
    assert_eq!(model.panel(), Popup::Help);
    let model = after(model, &[Action::Toggle(Popup::Log)]);
    assert_eq!(model.panel(), Popup::Log);
    let model = after(model, &[Action::Back]);
    assert_eq!(model.panel(), Popup::Scope);
    assert!(model.is_running());
    assert!(!after(model, &[Action::Back]).is_running());
}

#[test]
fn every_action_is_harmless_without_a_trace() {
    let actions = [
        Action::Channel(1),
        Action::NextTrace(TurnDirection::Up),
        Action::OnOff,
        Action::VoltsPerDivision(TurnDirection::Up),
        ZOOM_IN,
        Action::Position(TurnDirection::Down),
        Action::Pan(TurnDirection::Up),
        Action::Shot(TurnDirection::Up),
        Action::Shot(TurnDirection::Down),
        Action::Scroll(TurnDirection::Down, 1),
        Action::Reset,
    ];
    for set in [TraceSet::default(), recording(vec![vec![]])] {
        assert!(after(model(set), &actions).window().is_none());
    }
}
