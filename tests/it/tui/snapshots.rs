//! Every page as a whole, at 80 x 24 and 200 x 60, against `snapshots/`.
//!
//! A change detector: the screens were written by the program. They show what a change does to the
//! pages, and are no reference; what a page must show is in the other tests of this folder.
//!
//! A snapshot is the screen's text and below it its colours, a letter a cell: small for the sixteen
//! colours, a capital where the cell is reversed, a point for the terminal's own.
//! `HERTZSCOPE_WRITE=1 cargo test --test it snapshots` writes them anew; look at what changed
//! before you keep it.

use std::fmt::Write as _;
use std::path::Path;

use super::bench::{Screen, after, channel, draw, four_channels, recording};
use super::live::Session;
use hertzscope::measurement::compare::score_limits::ScoreLimits;
use hertzscope::measurement::compare::{Align, ComparedShot as Against, compare};
use hertzscope::studies::cost::{ChosenMethod, CostStudy, Point, Reference};
use hertzscope::studies::effects::{Change, EffectState, EffectVerdict, Ledger, LedgerEntry};
use hertzscope::studies::hard_cases::{CaseResult, CaseVerdict};
use hertzscope::tui::axis::TurnDirection;
use hertzscope::tui::model::{Action, JobState, Palette, Popup, ScreenState, SidePanel, update};
use hertzscope::tui::pages;
use ratatui::style::{Color, Modifier};

fn letter(colour: Color, reversed: bool) -> char {
    let letter = match colour {
        Color::Red => 'r',
        Color::Green => 'g',
        Color::Yellow => 'y',
        Color::Blue => 'b',
        Color::Magenta => 'm',
        Color::Cyan => 'c',
        Color::Gray => 'n',
        Color::DarkGray => 'd',
        Color::LightRed => 'e',
        Color::LightGreen => 'f',
        Color::LightBlue => 'l',
        Color::LightMagenta => 'k',
        Color::White => 'w',
        Color::Reset => return if reversed { ':' } else { '.' },
        other => panic!("{other:?} is none of the colours that every terminal has"),
    };
    if reversed { letter.to_ascii_uppercase() } else { letter }
}

/// Text and colours.
fn written(screen: &Screen, (width, height): (u16, u16)) -> String {
    let mut text =
        screen.text().lines().fold(String::new(), |all, row| all + row.trim_end() + "\n");
    for y in 0..height {
        let row: String = (0..width)
            .map(|x| {
                let cell = screen.cell(x, y);
                assert_eq!(cell.bg, Color::Reset, "a background at ({x}, {y})");
                letter(cell.fg, cell.modifier.contains(Modifier::REVERSED))
            })
            .collect();
        let _ = writeln!(text, "{}", row.trim_end_matches('.'));
    }
    text
}

/// Takes out of the last impact what differs from machine to machine.
fn clear_wall_time(model: &mut ScreenState) {
    let live = model.recordings.front_mut().live.as_mut();
    if let Some(summary) = live.and_then(|live| live.summary.as_mut()) {
        summary.wall_s = 0.0;
    }
}

fn check(name: &str, model: &ScreenState) {
    for size in [(80, 24), (200, 60)] {
        let found = written(&draw(model, size.0, size.1), size);
        let file = format!("tests/it/tui/snapshots/{name}-{}x{}.txt", size.0, size.1);
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(&file);
        if std::env::var_os("HERTZSCOPE_WRITE").is_some() {
            std::fs::write(&path, &found).expect("a snapshot written");
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(found == kept, "{file} is not what is drawn:\n{found}");
    }
}

/// A bench without what differs from machine to machine.
fn bench() -> Session {
    let mut session = Session::bench("magnet-0.61g");
    clear_wall_time(&mut session.model);
    session
}

#[test]
fn made_up_traces() {
    check("scope", &four_channels());
    let zoom = Action::TimePerDivision { turn: TurnDirection::Down, anchor: 0.0 };
    check("zoomed", &after(four_channels(), &[zoom, zoom]));
    check("help", &after(four_channels(), &[Action::Toggle(Popup::Help)]));
    let prompt = [Action::Prompt("write "), Action::Type('x')];
    check("prompt", &after(four_channels(), &prompt));
    let mut beside = four_channels();
    let other = vec![channel(1, 0.2, 1.0, |time| if time < 5e-4 { 0.0 } else { 0.6 })];
    beside.add_behind("yesterday.mcap".to_owned(), recording(vec![other]));
    check("beside", &after(beside, &[Action::Pan(TurnDirection::Up), zoom]));
}

#[test]
fn without_colours() {
    let set = four_channels().recordings.front().set.clone();
    let plain = ScreenState::new(set, "steel chain".to_owned(), Palette::Plain);
    check("plain", &after(plain, &[Action::Cursors, Action::Side(SidePanel::Measurements)]));
}

#[test]
fn the_bench_and_its_traces() {
    let shown = |actions: &[Action]| {
        let mut session = bench();
        session.act(actions);
        clear_wall_time(&mut session.model);
        session.model
    };
    check("bench-knobs", &shown(&[Action::Side(SidePanel::Knobs)]));
    check("bench-truth", &shown(&[Action::Truth]));
    let snap = [
        Action::Snap(TurnDirection::Up),
        Action::OtherCursor,
        Action::Channel(2),
        Action::Snap(TurnDirection::Up),
    ];
    check("bench-cursors", &shown(&[&[Action::Cursors], &snap[..]].concat()));
    check("bench-volts", &shown(&[Action::Cursors, Action::Cursors]));
    check("measurements", &shown(&[Action::Side(SidePanel::Measurements)]));
    check("newtons", &shown(&[Action::Unit, Action::Side(SidePanel::Measurements)]));
    check("math-reference", &shown(&[Action::Math, Action::Reference]));
    check(
        "persistence",
        &shown(&[Action::Persistence, Action::VoltsPerDivision(TurnDirection::Up)]),
    );
    check("autoset", &shown(&[Action::RunStop, Action::Autoset]));
}

#[test]
fn pages_over_frequency_and_against_another_trace() {
    let mut session = bench();
    session.act(&[Action::Channel(2), Action::Page(pages::spectrum::SPECTRUM)]);
    check("spectrum", &session.model);
    session.act(&[Action::Page(pages::spectrum::MAP)]);
    check("map", &session.model);
    session.act(&[Action::Page(pages::xy::PAGE)]);
    check("xy", &session.model);
}

#[test]
fn the_chain_in_motion() {
    let mut session = bench();
    session.act(&[Action::Page(pages::bench::PAGE)]);
    check("motion-rest", &session.model);
    session.command("seek 0.5 ms");
    check("motion", &session.model);
}

#[test]
fn the_comparison() {
    let mut session = bench();
    session.act(&[Action::Page(pages::compare::PAGE)]);
    check("compare-nothing", &session.model);
    let mut other = bench();
    other.command("set effects.magnet_preload.force 2 N");
    let side = |name: &'static str, session: &Session| {
        (
            name,
            session.model.recordings.front().set.clone(),
            session.model.shot().expect("a shot").clone(),
        )
    };
    let (here, there) = (side("lab", &session), side("bench", &other));
    let measured = Against { name: here.0, set: &here.1, shot: &here.2, scene: None };
    let simulated = Against { name: there.0, set: &there.1, shot: &there.2, scene: None };
    let tolerance = ScoreLimits::parse("rms=1lsb").expect("a tolerance");
    let compared = compare(measured, simulated, (Align::Arrival, &[]), &tolerance).expect("scores");
    session.model.jobs.comparison = JobState::Done(Box::new(compared));
    check("compare", &session.model);
    session.act(&[Action::Channel(3), Action::Page(pages::compare::PAGE)]);
    check("compare-overlay", &session.model);
    session.act(&[Action::Page(pages::compare::PAGE)]);
    check("compare-difference", &session.model);
}

fn point(method: &'static str, setting: f64, error: f64, count: u64) -> Point {
    Point {
        source: "a paper",
        method,
        order: 2,
        setting,
        failed: false,
        given_up: false,
        error_peak: Some(error),
        error_arrival: Some(0.1 * error),
        error_trace: Some(error),
        error_energy: Some(error),
        force_evaluations: count,
        wall_s_median: 1e-7 * count as f64,
        wall_s_min: 1e-7 * count as f64,
    }
}

fn entry(effect: &'static str, state: EffectState, peak: f64) -> LedgerEntry {
    let change = Change {
        speed: Some(0.5 * peak),
        peak: Some(peak),
        arrival: None,
        peak_lsb: Some(10.0 * peak),
        arrival_samples: None,
    };
    LedgerEntry {
        effect,
        state,
        active: state == EffectState::On,
        criterion: "made up",
        is_drawn: false,
        value: Some(1.0),
        reason: format!("{effect} is in this list to be seen"),
        run_times: None,
        change: Some(change),
        verdict: if state == EffectState::On {
            EffectVerdict::Needed
        } else {
            EffectVerdict::NoEffect
        },
    }
}

#[test]
fn accuracy() {
    let mut session = bench();
    session.model.jobs.study = JobState::Busy(0.4);
    update(&mut session.model, Action::Page(pages::accuracy::PAGE));
    session.model.take_requests();
    check("accuracy-busy", &session.model);
    let study = CostStudy {
        scene: "magnet-0.61g".to_owned(),
        reference: Reference {
            method: "made up".to_owned(),
            second: "another".to_owned(),
            error: 1e-12,
            error_trace: 1e-10,
        },
        points: vec![
            point("velocity-verlet", 1e-6, 1e-2, 2000),
            point("velocity-verlet", 5e-7, 2.5e-3, 4000),
            point("velocity-verlet", 2.5e-7, 6e-4, 8000),
            point("rkn-8(6)", 1e-3, 1e-3, 900),
            point("rkn-8(6)", 1e-6, 1e-6, 2200),
            point("rkn-8(6)", 1e-9, 1e-9, 5200),
        ],
        orders: Vec::new(),
        chosen: vec![ChosenMethod {
            accuracy: 1e-6,
            method: "rkn-8(6)",
            setting: 1e-6,
            error: Some(1e-7),
            error_peak: Some(1e-7),
            error_arrival: Some(1e-8),
            error_trace: Some(1e-6),
            error_energy: Some(1e-8),
            force_evaluations: 2500,
            wall_s_median: 2.5e-4,
            wall_s_min: 2.5e-4,
            wall_held_s_median: 6e-4,
            simulated_over_wall: 8.0,
        }],
        level: None,
        sample: 1e-3,
    };
    session.model.jobs.study = JobState::Done(Box::new(study));
    check("accuracy", &session.model);
}

#[test]
fn effects_and_hard_cases() {
    let mut session = bench();
    session.model.jobs.ledger = JobState::Busy(0.4);
    update(&mut session.model, Action::Page(pages::effects::PAGE));
    session.model.take_requests();
    check("effects-busy", &session.model);
    let ledger = Ledger {
        scene: "magnet-0.61g".to_owned(),
        accuracy: 1e-6,
        entries: vec![
            entry("gravity", EffectState::On, 0.0032),
            entry("dashpot", EffectState::Off, -0.12),
            entry("plasticity", EffectState::Auto, 0.0),
        ],
    };
    session.model.jobs.ledger = JobState::Done(Box::new(ledger));
    update(&mut session.model, Action::Row(TurnDirection::Down, 1));
    check("effects", &session.model);
    let case = |case, verdict| CaseResult {
        case,
        why: "it is in this list to be seen, with words enough for more than a line of a narrow terminal, or for two.",
        bound: "1e-6, made up.",
        figure: "energy: 3e-9 of 1e-6".to_owned(),
        found: Some(3e-9),
        limit: Some(1e-6),
        checks: 3,
        verdict,
    };
    let cases = vec![
        case("first contact", CaseVerdict::Right),
        case("second contact", CaseVerdict::Refused),
        case("chaos", CaseVerdict::Right),
    ];
    session.model.jobs.hard_cases = JobState::Done(cases);
    update(&mut session.model, Action::Page(pages::hard_cases::PAGE));
    update(&mut session.model, Action::Row(TurnDirection::Down, 1));
    check("hard-cases", &session.model);
}
