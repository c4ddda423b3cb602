//! Actions, and what each does to the model.

use tui_input::InputRequest;

use super::command::COMMANDS;
use super::screen_state::{Action, ScreenState};
use super::state::{Popup, SidePanel};
use super::traces::{next_math, next_trace, press, reset, truth, unit};
use crate::scope::Source;
use crate::tui::axis::TurnDirection;
use crate::tui::keys::groups;

/// Does what `action` asks.
pub fn update(model: &mut ScreenState, action: Action) {
    let notice = model.notice.take_if(|_| !matches!(action, Action::Tick(_)));
    let was_asked = notice.is_some_and(|notice| notice.ends_with(QUIT_QUESTION));
    if let Some(page) = model.page
        && model.panel == Popup::Scope
        && (page.0.act)(model, action)
    {
        return model.derive();
    }
    match action {
        Action::Quit => model.running = false,
        Action::Back => back(model, was_asked),
        Action::Toggle(panel) => toggle(model, panel),
        Action::Scroll(turn, lines) => scroll(model, turn, lines),
        Action::Row(turn, rows) => move_row(model, turn, rows),
        Action::Channel(number) => press(model, Source::Channel(number)),
        Action::Trace(source) => press(model, source),
        Action::NextTrace(turn) => next_trace(model, turn),
        Action::OnOff => model.selected.into_iter().for_each(|source| press(model, source)),
        Action::VoltsPerDivision(turn) => model.turn_volts(turn),
        Action::Position(turn) => model.turn_position(turn),
        Action::TimePerDivision { turn, anchor } => model.turn_time(turn, anchor),
        Action::Pan(turn) => model.turn_pan(turn),
        Action::Reset => reset(model),
        Action::Autoset => model.autoset(),
        Action::Math => next_math(model),
        Action::Reference => model.keep_reference(),
        Action::Truth => truth(model),
        Action::Bands => model.switch_bands(),
        Action::Unit => unit(model),
        Action::Cursors => model.next_cursors(),
        Action::OtherCursor => model.cursors.active = 1 - model.cursors.active,
        Action::MoveCursor(turn) => model.move_cursor(turn),
        Action::Snap(turn) => model.snap_cursor(turn),
        Action::SnapToArrival => model.snap_to_arrival(),
        Action::Press { x, y } => model.press_at(x, y),
        Action::Drag { x, y } => model.drag_to(x, y),
        Action::Page(page) => model.open_page(page),
        Action::Side(SidePanel::Knobs) if model.bench().is_none() => {}
        Action::Side(side) => model.open_side(side),
        Action::NextRecording => model.next_recording(),
        Action::Shot(turn) => {
            model.change_shot(turn);
            model.follow_from_here();
        }
        Action::Ends(turn) => {
            let last = model.shots().saturating_sub(1);
            model.go_to(if turn == TurnDirection::Up { last } else { 0 });
            model.follow_from_here();
        }
        Action::RunStop if model.recordings.front().live.is_some() => model.run_stop(),
        Action::RunStop => model.play_or_stop(),
        Action::Speed(turn) => model.change_speed(turn),
        Action::Tick(seconds) => model.tick(seconds),
        Action::Persistence => model.persist(),
        Action::Single => model.arm(),
        Action::Force => model.force(),
        Action::Impact => model.impact(),
        Action::TriggerLevel(turn) => model.turn_level(turn),
        Action::TriggerSlope => model.other_slope(),
        Action::TriggerMode => model.other_mode(),
        Action::Coupling => model.next_coupling(),
        Action::Probe => model.next_probe(),
        Action::Bandwidth => model.switch_bandwidth_limit(),
        Action::TriggerSource => model.next_trigger_source(),
        Action::Acquisition => model.next_acquisition(),
        Action::NextKnob(turn) => model.next_knob(turn),
        Action::TurnKnob(turn) => model.turn_knob(turn),
        Action::Switch => model.switch_effect_of_knob(),
        Action::TypeKnob => model.type_knob(),
        Action::Prompt(start) => model.open_prompt(start),
        typed @ (Action::Type(_)
        | Action::Edit(_)
        | Action::Erase
        | Action::Submit
        | Action::Complete
        | Action::Recall(_)
        | Action::Search) => type_on_the_prompt(model, typed),
    }
    model.derive();
}

/// What is typed on the command line, or where a search is typed.
fn type_on_the_prompt(model: &mut ScreenState, action: Action) {
    match action {
        Action::Type(letter) => {
            model.prompt.handle(InputRequest::InsertChar(letter));
        }
        Action::Edit(request) => {
            model.prompt.handle(request);
        }
        Action::Erase => erase(model),
        Action::Submit if model.panel == Popup::Search => model.panel = Popup::Help,
        Action::Submit => model.submit(),
        Action::Complete => model.complete_prompt(),
        Action::Recall(turn) => model.recall(turn),
        Action::Search => {
            model.prompt.reset();
            model.scroll = 0;
            model.panel = Popup::Search;
        }
        _ => {}
    }
}

/// Takes the last letter back; before the first one the command line closes.
fn erase(model: &mut ScreenState) {
    if model.prompt.handle(InputRequest::DeletePrevChar).is_none()
        && model.prompt.value().is_empty()
    {
        model.panel = if model.panel == Popup::Search { Popup::Help } else { Popup::Scope };
    }
}

/// Closes what is open: a panel, then a page, then the side, then everything.
/// How the question ends before a bench whose settings are not saved is left.
const QUIT_QUESTION: &str = ":write FILE.toml saves them, Esc again quits";

/// Closes what is open, at last the screen; `was_asked` after the question.
fn back(model: &mut ScreenState, was_asked: bool) {
    if model.panel == Popup::Search {
        model.panel = Popup::Help;
        model.prompt.reset();
    } else if model.panel != Popup::Scope {
        model.panel = Popup::Scope;
        model.prompt.reset();
    } else if model.page.is_some() {
        model.page = None;
        model.play.running = false;
    } else if model.side != SidePanel::Nothing {
        model.side = SidePanel::Nothing;
    } else {
        let live = model.recordings.front().live.as_ref();
        let unsaved = live.is_some_and(|live| live.settings != live.written);
        if unsaved && !was_asked {
            model.notice = Some(format!("the bench's settings are not saved: {QUIT_QUESTION}"));
        } else {
            model.running = false;
        }
    }
}

/// Selects another row of a page that is a list: up is towards the first one.
fn move_row(model: &mut ScreenState, turn: TurnDirection, by: usize) {
    let Some(rows) = model.page.and_then(|page| page.0.rows) else { return };
    let last = rows(model).saturating_sub(1);
    model.row = match turn {
        TurnDirection::Up => model.row.saturating_sub(by),
        TurnDirection::Down => (model.row + by).min(last),
    };
}

fn toggle(model: &mut ScreenState, panel: Popup) {
    model.scroll = 0;
    model.prompt.reset();
    model.panel = if model.panel == panel { Popup::Scope } else { panel };
}

/// Moves a panel's text by `lines`; there is always a line left to see.
fn scroll(model: &mut ScreenState, turn: TurnDirection, lines: usize) {
    let last = match model.panel {
        Popup::Scope | Popup::Prompt => return move_row(model, turn, lines),
        Popup::Help | Popup::Search => {
            let groups = groups();
            let rows: usize = groups.iter().map(|(_, rows)| rows.len() + 2).sum();
            rows + COMMANDS.len()
        }
        Popup::Log => {
            let set = &model.recordings.front().set;
            set.problems.len() + set.log.len()
        }
    };
    model.scroll = match turn {
        TurnDirection::Up => model.scroll.saturating_sub(lines),
        TurnDirection::Down => (model.scroll.saturating_add(lines)).min(last),
    };
}
