//! Recordings and terminals that nobody wants, and that come anyway.

use super::bench::{after, draw, four_channels, model, recording, step};
use hertzscope::recording::{Capture, TraceSet};
use hertzscope::tui::axis::TurnDirection;
use hertzscope::tui::model::{Action, Popup};
use ratatui::style::Color;

/// Everything that can be done to a trace, twice.
fn handled() -> Vec<Action> {
    let zoom = |turn, anchor| Action::TimePerDivision { turn, anchor };
    let once = [
        zoom(TurnDirection::Down, 0.0),
        zoom(TurnDirection::Down, 4.9),
        Action::Pan(TurnDirection::Down),
        Action::Pan(TurnDirection::Up),
        Action::VoltsPerDivision(TurnDirection::Down),
        Action::VoltsPerDivision(TurnDirection::Up),
        Action::VoltsPerDivision(TurnDirection::Up),
        Action::Position(TurnDirection::Up),
        zoom(TurnDirection::Up, -4.9),
    ];
    [once, once].concat()
}

fn changed(change: impl Fn(&mut Capture)) -> Capture {
    let mut capture = step();
    change(&mut capture);
    capture
}

#[test]
fn a_recording_without_shots_says_so() {
    let screen = draw(&model(TraceSet::default()), 80, 24);
    screen.find("This recording holds no shots.");
    let screen = draw(&model(recording(vec![vec![]])), 80, 24);
    screen.find("This shot holds no captures.");
    screen.find("Shot 1/1");
}

#[test]
fn a_record_without_points_says_so() {
    let empty = changed(|capture| capture.waveform.codes.clear());
    let model = model(recording(vec![vec![empty]]));
    draw(&model, 80, 24).find("CH1 500mV no data");
    let model = after(model, &handled());
    draw(&model, 80, 24);
}

#[test]
fn a_record_of_one_point_is_a_dot() {
    let one = changed(|capture| capture.waveform.codes.truncate(1));
    let screen = draw(&model(recording(vec![vec![one]])), 80, 24);
    let dots: Vec<(u16, u16)> = (9..80)
        .flat_map(|x| screen.rows_of(x, Color::Yellow).into_iter().map(move |y| (x, y)))
        .collect();
    // In the screen's centre, on the ground line.
    assert_eq!(dots, [(44, 10)]);
}

#[test]
fn numbers_that_no_instrument_gives_do_no_harm() {
    let bad = [f64::MAX, 1e300, f64::MIN_POSITIVE, 1e-320, 0.0, -1.0, f64::INFINITY, f64::NAN];
    let fields: [fn(&mut Capture, f64); 8] = [
        |c, v| c.waveform.preamble.x_zero = v,
        |c, v| c.waveform.preamble.x_incr = v,
        |c, v| c.waveform.preamble.y_mult = v,
        |c, v| c.waveform.preamble.y_zero = v,
        |c, v| c.waveform.horizontal_scale = v,
        |c, v| c.waveform.trigger_point = v,
        |c, v| c.waveform.vertical.scale = v,
        |c, v| c.waveform.vertical.position = v,
    ];
    for value in bad {
        for field in fields {
            let capture = changed(|capture| field(capture, value));
            let spectrum = changed(|capture| {
                field(capture, value);
                capture.waveform.preamble.x_unit = "Hz".to_owned();
            });
            for capture in [capture, spectrum] {
                let model = model(recording(vec![vec![capture, step()]]));
                draw(&model, 80, 24);
                draw(&after(model, &handled()), 80, 24);
            }
        }
    }
}

/// All of x is far away and coarse: doubles at 1e300 are 1e284 apart.
#[test]
fn a_record_at_huge_times_is_drawn() {
    let far = changed(|capture| {
        let preamble = &mut capture.waveform.preamble;
        preamble.x_zero = 1e300;
        preamble.x_incr = 1e297;
        capture.waveform.horizontal_scale = 2.5e299;
    });
    let screen = draw(&model(recording(vec![vec![far]])), 80, 24);
    assert_eq!(screen.rows_of(9 + 35, Color::Yellow), [6]);
    screen.find("M 2.50e299s");
}

#[test]
fn a_small_terminal_is_told_what_is_missing() {
    let screen = draw(&four_channels(), 39, 20);
    screen.find("39 x 20");
    screen.find("40 x 12");
    draw(&four_channels(), 40, 12).find("M 250µs");
}

#[test]
fn every_size_of_terminal_can_be_drawn() {
    let zoomed = after(four_channels(), &handled());
    let help = after(four_channels(), &[Action::Toggle(Popup::Help)]);
    let none = Box::new(model(TraceSet::default()));
    for model in [Box::new(four_channels()), Box::new(zoomed), Box::new(help), none] {
        for width in (1..100).step_by(3) {
            for height in 1..46 {
                draw(&model, width, height);
            }
        }
        draw(&model, 1000, 3);
        draw(&model, 2000, 30);
        draw(&model, 40, 1000);
    }
}

#[test]
fn a_title_of_any_length_leaves_room_for_the_rest() {
    let set = recording(vec![vec![step()]]);
    let long = hertzscope::tui::model::ScreenState::new(
        set,
        "gemessen am Mittwoch – 鎖".repeat(20),
        hertzscope::tui::model::Palette::Colour,
    );
    for width in [40, 41, 80, 81] {
        let screen = draw(&long, width, 24);
        screen.find("M Pos: 1.00ms");
        screen.find("…");
    }
}
