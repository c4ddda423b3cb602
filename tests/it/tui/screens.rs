//! The model to screens. On 80 x 24 the graticule's top left cell is (9, 2).

use std::path::Path;

use super::bench::{after, channel, draw, four_channels, model, recording, spectrum, step};
use hertzscope::recording::Origin;
use hertzscope::tui::axis::TurnDirection;
use hertzscope::tui::keys::{TRACE_HINTS, bindings, groups};
use hertzscope::tui::model::command::COMMANDS;
use hertzscope::tui::model::{Action, Palette, Popup, ScreenState};
use hertzscope::tui::pages;
use ratatui::style::{Color, Modifier};

/// Column of division line `line`, counted from the left.
const fn across(line: u16) -> u16 {
    9 + 7 * line
}

/// Row of division line `line`, counted from the top.
const fn down(line: u16) -> u16 {
    2 + 2 * line
}

const ZOOM_IN: Action = Action::TimePerDivision { turn: TurnDirection::Down, anchor: 0.0 };

#[test]
fn a_step_of_1_v_at_500_mv_per_division_rises_by_two_divisions() {
    let screen = draw(&four_channels(), 80, 24);
    // Before the trigger on the ground line, 4 divisions from the top; after it 2 divisions higher.
    assert_eq!(screen.rows_of(across(1) - 3, Color::Yellow), [down(4)]);
    for line in 2..10 {
        assert_eq!(screen.rows_of(across(line), Color::Yellow), [down(2)]);
    }
    // The edge joins them, on the trigger's column, one division from the left.
    let edge: Vec<u16> = (down(2)..=down(4)).collect();
    assert_eq!(screen.rows_of(across(1), Color::Yellow), edge);
}

#[test]
fn on_a_large_screen_the_same_step_stands_in_the_same_division() {
    let screen = draw(&four_channels(), 200, 60);
    // 38 dots across a division, 25 dots up: 19 columns, and the line of 2 V/div at dot 50, in row
    // 12.
    assert_eq!(screen.rows_of(9 + 19 * 5, Color::Yellow), [2 + 50 / 4]);
    assert_eq!(screen.rows_of(9 + 10, Color::Yellow), [2 + 100 / 4]);
    screen.find("CH1 500mV");
    screen.find("TDS2014");
}

#[test]
fn ground_markers_stand_where_zero_volts_is() {
    let screen = draw(&four_channels(), 80, 24);
    for (marker, row) in [("1▸", down(4)), ("2▸", down(5)), ("3▸", down(6)), ("4▸", down(7))]
    {
        assert_eq!(screen.find(marker), (7, row), "{marker}");
    }
    assert_eq!(screen.cell(7, down(5)).fg, Color::Cyan);
    assert_eq!(screen.cell(7, down(6)).fg, Color::Magenta);
    assert_eq!(screen.cell(7, down(7)).fg, Color::Green);
}

#[test]
fn a_ground_beyond_the_screen_is_an_arrow_at_its_edge() {
    let above = channel(1, 0.5, 4.5, |_| 0.0);
    let below = channel(2, 0.5, -4.5, |_| 0.0);
    let screen = draw(&model(recording(vec![vec![above, below]])), 80, 24);
    assert_eq!(screen.find("1▴"), (7, down(0)));
    assert_eq!(screen.find("2▾"), (7, down(8)));
}

#[test]
fn the_trigger_is_marked_above_its_time() {
    assert_eq!(draw(&four_channels(), 80, 24).find("▼"), (across(1), 1));
    // Zoomed in around 1 ms, it is left of the screen.
    let zoomed = after(four_channels(), &[ZOOM_IN, ZOOM_IN]);
    assert_eq!(draw(&zoomed, 80, 24).find("◀"), (across(0), 1));
}

#[test]
fn readouts_say_scales_with_units() {
    let screen = draw(&four_channels(), 80, 24);
    let channels = screen.row(20);
    for reading in ["CH1 500mV", "CH2 1.00V", "CH3 200mV", "CH4 500mV", "M 250µs"] {
        assert!(channels.contains(reading), "{reading} in {channels}");
    }
    assert!(!channels.contains('*') && !channels.contains("clipped"));
    let detail = screen.row(21);
    for part in ["CH1 500mV/div", "pos 0.00div", "DC", "probe 10X", "2500 points"] {
        assert!(detail.contains(part), "{part} in {detail}");
    }
}

#[test]
fn the_status_line_says_what_is_on_screen() {
    let mut set = recording(vec![vec![step()], vec![step()], vec![step()]]);
    set.problems = vec!["chunk 3 is damaged".to_owned()];
    set.shots[1].origin = Origin::Measured;
    let model = model(set);
    let first = draw(&model, 80, 24).row(0);
    for part in ["steel chain", "Stop", "Shot 1/3", "simulated", "M Pos: 1.00ms", "1 problem"] {
        assert!(first.contains(part), "{part} in {first}");
    }
    let second = draw(&after(model, &[Action::Shot(TurnDirection::Up)]), 80, 24).row(0);
    assert!(second.contains("Shot 2/3") && second.contains("measured"), "{second}");
}

#[test]
fn axes_are_labelled_in_the_selected_traces_units() {
    let screen = draw(&four_channels(), 80, 24);
    for (line, text) in [(0, "2.00V"), (3, "500mV"), (4, "0V"), (8, "-2.00V")] {
        let row = screen.row(down(line));
        assert!(row.starts_with(text), "{text} in {row}");
    }
    let times = screen.row(19);
    for text in ["0s", "500µs", "1.00ms", "1.50ms", "2.00ms"] {
        assert!(times.contains(text), "{text} in {times}");
    }
    let second = draw(&after(four_channels(), &[Action::Channel(2)]), 80, 24);
    assert!(second.row(down(0)).starts_with("5.00V"));
}

#[test]
fn labels_have_the_digits_that_a_zoom_needs() {
    let zoomed = after(four_channels(), &[ZOOM_IN; 6]);
    let screen = draw(&zoomed, 80, 24);
    // 2.5 µs/div around 1 ms.
    assert!(screen.row(0).contains("M Pos: 1.0000ms"), "{}", screen.row(0));
    assert!(screen.row(19).contains("990.00µs"), "{}", screen.row(19));
    assert!(screen.row(19).contains("1.0100ms"), "{}", screen.row(19));
}

#[test]
fn the_selected_channel_is_highlighted() {
    let highlighted = |model: &ScreenState, text: &str| {
        let screen = draw(model, 80, 24);
        let (x, y) = screen.find(text);
        screen.cell(x, y).modifier.contains(Modifier::REVERSED)
    };
    let model = four_channels();
    assert!(highlighted(&model, "CH1 500mV"));
    assert!(!highlighted(&model, "CH2 1.00V"));
    let model = after(model, &[Action::Channel(2)]);
    assert!(!highlighted(&model, "CH1 500mV"));
    assert!(highlighted(&model, "CH2 1.00V"));
}

#[test]
fn the_selected_trace_lies_on_top() {
    let flat = |number| channel(number, 0.5, 0.0, |_| 0.0);
    let model = model(recording(vec![vec![flat(1), flat(2)]]));
    assert_eq!(draw(&model, 80, 24).cell(40, down(4)).fg, Color::Yellow);
    let model = after(model, &[Action::Channel(2)]);
    assert_eq!(draw(&model, 80, 24).cell(40, down(4)).fg, Color::Cyan);
}

#[test]
fn a_scale_that_was_not_recorded_has_a_star() {
    let model = after(four_channels(), &[Action::VoltsPerDivision(TurnDirection::Up)]);
    let screen = draw(&model, 80, 24);
    screen.find("CH1 1.00V* ");
    screen.find("CH1 1.00V/div  *recorded 500mV/div");
    // A volt is one division now.
    assert_eq!(screen.rows_of(across(5), Color::Yellow), [down(3)]);
}

#[test]
fn a_moved_trace_takes_its_ground_marker_along() {
    let up = Action::Position(TurnDirection::Up);
    let screen = draw(&after(four_channels(), &[up, up]), 80, 24);
    assert_eq!(screen.find("1▸"), (7, down(3)));
    assert_eq!(screen.rows_of(across(5), Color::Yellow), [down(1)]);
    screen.find("*recorded 500mV/div at 0.00div");
}

#[test]
fn clipped_records_are_flagged() {
    let clipped = channel(1, 0.1, 0.0, |time| if time < 1e-3 { 0.0 } else { 9.0 });
    let screen = draw(&model(recording(vec![vec![clipped]])), 80, 24);
    screen.find("CH1 100mV clipped");
    // From 1 ms to the end at 2.249 ms.
    screen.find("clipped 1250 of 2500");
}

#[test]
fn a_channel_that_is_off_leaves_the_screen() {
    let model = after(four_channels(), &[Action::OnOff]);
    let screen = draw(&model, 80, 24);
    screen.find("CH1 off");
    assert!(screen.rows_of(across(5), Color::Yellow).is_empty());
    assert!(!screen.has("1▸"));
}

#[test]
fn an_overview_shows_what_part_is_on_screen() {
    assert!(!draw(&four_channels(), 80, 24).has("["));
    // 100 µs/div of 250 µs/div: two fifths of the record in the middle, from 3 to 7 divisions.
    let screen = draw(&after(four_channels(), &[ZOOM_IN]), 80, 24);
    let strip = screen.row(22);
    assert!(strip.starts_with("2.5x"), "{strip}");
    assert_eq!(screen.find("[").0, across(3));
    assert_eq!(screen.find("]").0, across(7));
    screen.find("M 100µs*");
}

#[test]
fn a_spectrum_has_its_own_units() {
    let screen = draw(&model(recording(vec![vec![spectrum()]])), 80, 24);
    screen.find("MATH 10.0dB");
    screen.find("50.0kHz/div");
    screen.find("Pos: 250kHz");
    assert!(screen.row(19).contains("300kHz"), "{}", screen.row(19));
    assert!(screen.row(down(0)).starts_with("50.0dB"), "{}", screen.row(down(0)));
    assert!(!screen.has("▼"), "a spectrum has no trigger");
    // The line of 10 dB, in the centre; the floor 4 divisions lower.
    let line: Vec<u16> = (down(4)..=down(8)).collect();
    assert_eq!(screen.rows_of(across(5), Color::Red), line);
    assert_eq!(screen.rows_of(across(2), Color::Red), [down(8)]);
}

#[test]
fn help_lists_every_key_and_command() {
    let mut model = after(four_channels(), &[Action::Toggle(Popup::Help)]);
    let mut all = String::new();
    for _ in 0..60 {
        all += &draw(&model, 80, 24).text();
        model = after(model, &[Action::Scroll(TurnDirection::Down, 1)]);
    }
    for (title, rows) in groups() {
        assert!(all.contains(title), "{title}");
        for (label, help) in rows {
            assert!(all.contains(&label), "{label}");
            assert!(all.contains(help), "{help}");
        }
    }
    for command in COMMANDS {
        assert!(all.contains(&command.usage()), "{}", command.usage());
        assert!(all.contains(command.help()), "{}", command.help());
    }
}

#[test]
fn a_search_in_the_help_leaves_what_it_finds() {
    let typed: Vec<Action> = "cursor".chars().map(Action::Type).collect();
    let search = [&[Action::Toggle(Popup::Help), Action::Search], &typed[..]].concat();
    let found = after(four_channels(), &search);
    let text = draw(&found, 80, 24).text();
    assert!(text.contains("Keys with: cursor") && text.contains("c v"), "{text}");
    assert!(!text.contains("Tab Shift+Tab"), "{text}");
    // Enter keeps it for scrolling, Esc shows all keys again, the next one the scope.
    let kept = after(found, &[Action::Submit]);
    assert_eq!(kept.panel(), Popup::Help);
    assert!(!draw(&kept, 80, 24).text().contains("Tab Shift+Tab"));
    let all = after(four_channels(), &[&search[..], &[Action::Back]].concat());
    assert!(draw(&all, 80, 24).text().contains("Keys: / searches"));
    assert_eq!(after(all, &[Action::Back]).panel(), Popup::Scope);
}

/// What the last line names on a page is a key there.
#[test]
fn hints_name_keys_that_exist() {
    let check = |hints: &[(&str, &str)]| {
        for (keys, what) in hints {
            for key in keys.split(' ') {
                let general =
                    bindings().any(|b| b.label.split_whitespace().any(|word| word == key));
                let of_page = pages::PAGES.iter().any(|page| page.0.key.to_string() == key);
                assert!(general || of_page, "{key}: {what}");
            }
        }
    };
    check(TRACE_HINTS);
    for page in pages::PAGES.iter().copied() {
        check(page.0.hints);
        // Without a scene these two say that nothing can be run.
        if page == pages::accuracy::PAGE || page == pages::effects::PAGE {
            continue;
        }
        let screen = draw(&after(four_channels(), &[Action::Page(page)]), 80, 24);
        let last = screen.row(23);
        assert!(last.starts_with("? help"), "{page:?}: {last}");
    }
}

#[test]
fn xy_has_ch1_to_the_right() {
    let selected: [(&[Action], &str); 2] = [(&[], "CH2"), (&[Action::Channel(3)], "CH3")];
    for (select, upward) in selected {
        let model = after(after(four_channels(), select), &[Action::Page(pages::xy::PAGE)]);
        let text = draw(&model, 80, 24).text();
        assert!(text.contains(&format!("XY: {upward} upward, CH1 to the right")), "{text}");
    }
}

/// A shifted axis has its labels at round values, each where its value is.
#[test]
fn shifted_axes_have_round_labels() {
    let pan = Action::Pan(TurnDirection::Up);
    let up = Action::Position(TurnDirection::Up);
    let screen = draw(&after(four_channels(), &[ZOOM_IN, pan, up]), 80, 24);
    // 100 µs/div, half a division to the left of 1 ms: 0.8 ms stands 3.5 divisions from the left, 1
    // ms 5.5.
    for (text, division) in [("800µs", 3.5), ("1.00ms", 5.5), ("1.20ms", 7.5)] {
        let row = screen.row(19);
        let at = row.find(text).unwrap_or_else(|| panic!("no {text} in {row}"));
        let middle = row[..at].chars().count() + text.chars().count() / 2;
        let column = 9.0 + 7.0 * division;
        assert!((middle as f64 - column).abs() <= 1.0, "{text} at {middle}, not {column}: {row}");
    }
    // Zero is labelled at its marker, and a volt two divisions above it.
    let (_, ground) = screen.find("1▸");
    assert_eq!(ground, down(4) - 1);
    assert!(screen.row(ground).starts_with("0V"), "{}", screen.row(ground));
    assert!(screen.row(ground - 4).starts_with("1.00V"), "{}", screen.row(ground - 4));
}

/// A word that is no command is answered with all that are, whatever the width.
#[test]
fn an_unknown_command_is_answered_in_full() {
    let typed: Vec<Action> = "foo".chars().map(Action::Type).collect();
    let actions = [&[Action::Prompt("")], &typed[..], &[Action::Submit]].concat();
    let text = draw(&after(four_channels(), &actions), 80, 24).text();
    for command in COMMANDS {
        let usage = command.usage();
        let word = usage.split(' ').next().expect("a word");
        assert!(text.contains(word), "no {word} in {text}");
    }
}

#[test]
fn problems_and_log_have_a_panel() {
    let mut set = recording(vec![vec![step()]]);
    set.problems = vec!["chunk 3 is damaged".to_owned()];
    set.log = vec!["shot 1 taken".to_owned()];
    let screen = draw(&after(model(set), &[Action::Toggle(Popup::Log)]), 80, 24);
    screen.find("chunk 3 is damaged");
    screen.find("shot 1 taken");
}

/// No line of the log is cut, and the last one can be reached.
#[test]
fn long_lines_of_the_log_are_wrapped() {
    let mut set = recording(vec![vec![step()]]);
    set.log = (0..30).map(|line| format!("{} end{line}.", "word ".repeat(30))).collect();
    let model = after(model(set), &[Action::Toggle(Popup::Log)]);
    assert!(draw(&model, 80, 24).has(" end0."));
    let model = after(model, &[Action::Scroll(TurnDirection::Down, 1); 40]);
    assert!(draw(&model, 80, 24).has(" end29."));
}

#[test]
fn a_long_log_is_scrolled() {
    let mut set = recording(vec![vec![step()]]);
    set.log = (0..100).map(|line| format!("line {line}.")).collect();
    let model = after(model(set), &[Action::Toggle(Popup::Log)]);
    assert!(!draw(&model, 80, 24).has("line 30."));
    let model = after(model, &[Action::Scroll(TurnDirection::Down, 1); 20]);
    let screen = draw(&model, 80, 24);
    assert!(screen.has("line 30.") && !screen.has("line 1."));
}

#[test]
fn without_colours_no_cell_has_one() {
    let set = four_channels().recordings.front().set.clone();
    let plain = ScreenState::new(set, "plain".to_owned(), Palette::Plain);
    let plain = after(plain, &[ZOOM_IN]);
    let screen = draw(&plain, 80, 24);
    for y in 0..24 {
        for x in 0..80 {
            assert_eq!(screen.cell(x, y).fg, Color::Reset, "({x}, {y})");
        }
    }
    let (x, y) = screen.find("CH1 500mV");
    assert!(screen.cell(x, y).modifier.contains(Modifier::REVERSED));
    // Traces are told apart by their dots: the selected one is solid, the others are not.
    assert_eq!(screen.cell(20, down(2)).symbol(), "⠉");
    assert_eq!(screen.cell(20, down(5)).symbol(), "⠁");
}

/// The page on the screen has the keys as the help shows them.
#[test]
#[allow(clippy::format_collect, reason = "short texts")]
fn the_page_on_the_screen_has_all_keys() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/screen.md");
    let page = std::fs::read_to_string(page).expect("a page");
    for (title, rows) in groups() {
        let rows: String =
            rows.iter().map(|(keys, what)| format!("\n| `{keys}` | {what} |")).collect();
        let expected = format!("| **{title}** | |{rows}\n");
        assert!(page.contains(&expected), "docs/screen.md lacks\n{expected}");
    }
}
