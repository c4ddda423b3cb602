//! The bench behind the screen: knobs make scenes, scenes are struck on a thread, answers come back
//! in order.

use std::sync::mpsc::Receiver;
use std::time::Duration;

use super::bench::{after, compute, draw};
use hertzscope::chain::LossKind;
use hertzscope::recording::TraceSet;
use hertzscope::scene::Scene;
use hertzscope::scope::{AcquireMode, Coupling, Source, TriggerSource};
use hertzscope::tui::axis::TurnDirection;
use hertzscope::tui::job::Queue;
use hertzscope::tui::model::knobs::BenchKnob;
use hertzscope::tui::model::{Action, Palette, Request, RunState, ScreenState, SidePanel, update};
use hertzscope::tui::pages;
use hertzscope::tui::work::{ScreenEvent, Workers};
use ratatui::layout::Size;
use tui_input::InputRequest;

/// Far longer than any strike takes.
const TIMEOUT: Duration = Duration::from_secs(120);
const SIZE: Size = Size { width: 80, height: 24 };

/// A bench with its threads.
pub struct Session {
    pub model: ScreenState,
    staff: Workers,
    news: Receiver<ScreenEvent>,
}

impl Session {
    pub fn bench(scene: &str) -> Self {
        let mut model = ScreenState::new(TraceSet::default(), scene.to_owned(), Palette::Colour);
        model.open_bench(scene.to_owned());
        let (staff, news) = Workers::start(None, false);
        let mut session = Self { model, staff, news };
        session.settle();
        session
    }

    pub fn act(&mut self, actions: &[Action]) {
        for action in actions {
            update(&mut self.model, *action);
            self.settle();
        }
    }

    /// Types a line on the command line.
    pub fn command(&mut self, line: &str) {
        update(&mut self.model, Action::Prompt(""));
        for letter in line.chars() {
            update(&mut self.model, Action::Type(letter));
        }
        self.act(&[Action::Submit]);
    }

    /// Waits until everything that was asked for has come.
    fn settle(&mut self) {
        compute(&mut self.model);
        let is_file = |request: &Request| match request {
            Request::Job(job) => job.queue == Queue::File,
            request => matches!(request, Request::Save(_)),
        };
        let writes = self.model.requests.iter().any(is_file);
        self.staff.serve(&mut self.model, SIZE);
        while writes && self.model.notice.is_none() {
            self.next();
        }
        while self
            .model
            .recordings
            .front()
            .live
            .as_ref()
            .is_some_and(hertzscope::tui::model::LiveBench::is_waiting)
        {
            self.next();
        }
    }

    /// Waits for the next news.
    pub fn next(&mut self) {
        let news = self.news.recv_timeout(TIMEOUT).expect("an answer");
        news.apply(&mut self.model);
        compute(&mut self.model);
        self.staff.serve(&mut self.model, SIZE);
    }
}

fn knob(label: &str) -> usize {
    BenchKnob::ALL.iter().position(|knob| knob.label == label).expect("a knob")
}

/// Selects a knob.
fn choose(session: &mut Session, label: &str) {
    let wanted = Some(knob(label));
    while session.model.recordings.front().live.as_ref().map(|live| live.knob) != wanted {
        session.act(&[Action::NextKnob(TurnDirection::Up)]);
    }
}

fn type_text(session: &mut Session, text: &str) {
    let letters: Vec<Action> = text.chars().map(Action::Type).collect();
    session.act(&letters);
}

fn scene(session: &Session) -> &Scene {
    session.model.recordings.front().scene.as_ref().expect("a bench")
}

fn peak(session: &Session) -> f64 {
    let live = session.model.recordings.front().live.as_ref().expect("a bench");
    let summary = live.summary.as_ref().expect("an impact");
    summary.sensors[0].first_peak.expect("a pulse").dynamic_n
}

#[test]
fn a_bench_opens_struck_and_triggered() {
    let session = Session::bench("magnet-0.61g");
    assert_eq!(session.model.captures().len(), 4);
    let screen = draw(&session.model, 80, 24);
    for words in ["Trig'd", "simulated", "M Pos: 1.00ms", "CH1↑500mV", "M 250µs"] {
        screen.find(words);
    }
}

#[test]
fn a_faster_striker_makes_a_higher_pulse_and_the_tuned_scene_says_so() {
    let mut session = Session::bench("magnet-0.61g");
    let (speed, force) = (scene(&session).striker_speed().expect("a striker"), peak(&session));
    choose(&mut session, "striker speed");
    session.act(&[Action::TurnKnob(TurnDirection::Up); 8]);
    // Eight of twenty-four turns a decade, each rounded to three digits.
    let faster = scene(&session).striker_speed().expect("a striker");
    assert!((faster / speed / 10f64.cbrt() - 1.0).abs() < 0.02, "{faster} from {speed}");
    assert!(peak(&session) > 1.5 * force, "{} from {force}", peak(&session));
    // What is saved is a scene that stands on the one that was opened, and is the one that was
    // struck.
    let text = session.model.recordings.front().live.as_ref().expect("a bench").text();
    let saved = Scene::from_text("saved", "saved.toml", &text).expect("a sound scene");
    assert_eq!(saved.striker_speed(), Some(faster));
    assert!(text.starts_with("base = \"magnet-0.61g\"\n"), "{text}");
}

#[test]
fn knobs_read_what_the_scene_says() {
    let session = Session::bench("magnet-0.61g");
    let reading = |label: &str| {
        let knob = BenchKnob::ALL[knob(label)];
        knob.reading(scene(&session), Some(Source::Channel(1)))
    };
    for (label, expected) in [
        ("striker mass", "610 mg"),
        ("striker speed", "440 mm/s"),
        ("magnet force", "2.38 N"),
        ("gravity", "9.81 m/s^2"),
        ("dashpot", "off"),
        ("accuracy", "1e-6"),
        ("scope noise", "0.020 div"),
        ("sensitivity", "393 mV/N"),
        ("plate offset", "+0.00"),
    ] {
        assert_eq!(reading(label), expected, "{label}");
    }
}

/// Static force between the first two particles (N).
fn preload(session: &Session) -> f64 {
    scene(session).chain.contacts()[2].static_force
}

/// A force on top, a magnet of constant force, and a ring at its distance: typed, turned, switched
/// on; what presses on the chain follows.
#[test]
fn every_preload_is_a_knob() {
    let mut session = Session::bench("magnet-0.61g");
    let before = preload(&session);
    choose(&mut session, "force on top");
    session.act(&[Action::TurnKnob(TurnDirection::Up)]);
    let notice = session.model.notice.as_deref().expect("a word").to_owned();
    assert!(notice.contains("no force on top: E"), "{notice}");
    session.act(&[Action::TypeKnob]);
    assert_eq!(session.model.prompt(), "set chain.top.force ");
    type_text(&mut session, "1.5 N");
    session.act(&[Action::Submit]);
    assert!((preload(&session) - before - 1.5).abs() < 1e-9, "{}", preload(&session));
    session.act(&[Action::TurnKnob(TurnDirection::Up)]);
    // A twenty-fourth of a decade, with three digits.
    assert!((preload(&session) - before - 1.65).abs() < 1e-9, "{}", preload(&session));

    let mut session = Session::bench("gravity-0.61g");
    let before = preload(&session);
    choose(&mut session, "magnet force");
    session.act(&[Action::TypeKnob]);
    assert_eq!(session.model.notice.as_deref(), Some("magnet force is off: o switches it on"));
    session.act(&[Action::Switch]);
    assert!(
        (preload(&session) - before - 1.0).abs() < 1e-9,
        "{:?}",
        session.model.notice.as_deref()
    );

    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("ring.toml");
    let magnet = "[effects.magnet_preload]\nmodel = \"ring-12-6-6\"\nparticle = 1\n";
    for (place, label) in [("distance = \"-0.2 mm\"", "distance"), ("force = \"2 N\"", "force")] {
        std::fs::write(&file, format!("base = \"magnet-0.61g\"\n{magnet}{place}\n"))
            .expect("a file");
        let mut session = Session::bench(&file.display().to_string());
        choose(&mut session, &format!("magnet {label}"));
        let before = preload(&session);
        session.act(&[Action::TurnKnob(TurnDirection::Down)]);
        assert_ne!(preload(&session), before, "{label}: {:?}", session.model.notice.as_deref());
        let text = session.model.recordings.front().live.as_ref().expect("a bench").text();
        let turned = if label == "force" { "force = \"1.82 N\"" } else { "distance = \"-0.3 mm\"" };
        assert!(text.contains(turned), "{text}");
        // Of force and distance, the panel shows what the scene says.
        session.act(&[Action::Side(SidePanel::Knobs)]);
        let screen = draw(&session.model, 80, 24);
        let other = if label == "force" { "magnet distance" } else { "magnet force" };
        assert!(!screen.has(other), "{other}");
    }
}

#[test]
fn the_scopes_knobs_set_the_scope_while_it_runs() {
    let mut session = Session::bench("magnet-0.61g");
    session.act(&[Action::VoltsPerDivision(TurnDirection::Up)]);
    let scale = |session: &Session| session.model.captures()[0].waveform.vertical.scale;
    assert_eq!(scale(&session), 2.0);
    // As on a recording; a multiple of the front panel's steps of 0.04.
    session.act(&[Action::Position(TurnDirection::Up)]);
    let position = session.model.captures()[0].waveform.vertical.position;
    assert_eq!(position, 2.4, "{:?}", session.model.notice.as_deref());
    session.act(&[Action::TimePerDivision { turn: TurnDirection::Down, anchor: 0.0 }]);
    assert_eq!(scene(&session).scope.time_base, 100e-6);
    session.act(&[Action::Coupling]);
    let coupling = session.model.captures()[0].waveform.vertical.coupling;
    assert_eq!(coupling, Some(Coupling::Ac));
    session.act(&[Action::TriggerLevel(TurnDirection::Up)]);
    // A tenth of a division of 2 V.
    assert!((scene(&session).scope.trigger.level - 0.7).abs() < 1e-12);
    // Stopped, the same key moves the picture, and a star says so.
    session.act(&[Action::RunStop, Action::VoltsPerDivision(TurnDirection::Up)]);
    assert_eq!(scale(&session), 2.0);
    draw(&session.model, 80, 24).find("CH1 5.00V*");
}

#[test]
fn a_setting_that_the_scene_refuses_is_taken_back_and_told() {
    let mut session = Session::bench("magnet-0.61g");
    let before = session.model.recordings.front().live.as_ref().expect("a bench").text();
    session.command("set striker.speed -1 m/s");
    let notice = session.model.notice.as_deref().expect("a word about it").to_owned();
    assert!(notice.contains("speed"), "{notice}");
    assert_eq!(session.model.recordings.front().live.as_ref().expect("a bench").text(), before);
    assert_eq!(session.model.captures().len(), 4);
}

#[test]
fn effects_are_switched_and_come_back_as_they_were() {
    let mut session = Session::bench("magnet-0.61g");
    choose(&mut session, "gravity");
    session.act(&[Action::Switch]);
    assert!(scene(&session).spec.effects.gravity.is_none());
    session.act(&[Action::Switch]);
    let gravity = scene(&session).spec.effects.gravity.as_ref().expect("gravity");
    assert_eq!(gravity.acceleration, 9.81);
    // A loss that the scene does not name comes with numbers of its own.
    session.act(&[Action::NextKnob(TurnDirection::Up), Action::Switch]);
    assert!(
        scene(&session).spec.effects.loss(LossKind::Dashpot).is_some(),
        "{:?}",
        session.model.notice.as_deref()
    );
}

#[test]
fn an_armed_scope_takes_one_trigger_and_stops() {
    let mut session = Session::bench("magnet-0.61g");
    session.act(&[Action::Single]);
    let acquisition = |session: &Session| {
        session.model.recordings.front().live.as_ref().expect("a bench").acquisition
    };
    assert_eq!(acquisition(&session), RunState::Armed);
    draw(&session.model, 80, 24).find("Armed");
    session.act(&[Action::Impact]);
    assert_eq!(acquisition(&session), RunState::Stopped);
    assert_eq!(session.model.shot().expect("a shot").number, 2);
    session.act(&[Action::Impact]);
    assert_eq!(session.model.shot().expect("a shot").number, 2, "a stopped scope sees nothing");
}

#[test]
fn a_stale_answer_is_let_go() {
    let mut session = Session::bench("magnet-0.61g");
    // The strikes of two turns are answered in the wrong order.
    update(&mut session.model, Action::TurnKnob(TurnDirection::Up));
    update(&mut session.model, Action::Impact);
    assert!(
        matches!(session.model.take_requests().as_slice(), [Request::Job(job)] if job.queue == Queue::Bench)
    );
    // The strike at the start was the first.
    let shot = session.model.shot().cloned();
    session.model.apply_strike_result(3, Err("the newest".to_owned()));
    session.model.apply_strike_result(2, Err("stale".to_owned()));
    assert_eq!(session.model.notice.as_deref(), Some("the newest"));
    assert_eq!(session.model.shot().cloned(), shot);
}

#[test]
fn only_the_newest_of_waiting_strikes_is_asked_for() {
    let mut session = Session::bench("magnet-0.61g");
    for _ in 0..5 {
        update(&mut session.model, Action::TurnKnob(TurnDirection::Up));
    }
    assert_eq!(session.model.take_requests().len(), 1);
}

#[test]
fn what_was_seen_is_saved_and_opens_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name).display().to_string();
    let mut session = Session::bench("magnet-0.61g");
    session.command("set striker.speed 0.5 m/s");
    for name in ["shot.mcap", "traces.csv", "tuned.toml", "screen.svg"] {
        session.command(&format!("write {}", file(name)));
        let notice = session.model.notice.as_deref().expect("a word about it");
        assert!(notice.starts_with("wrote"), "{notice}");
    }
    let open = |name: &str| hertzscope::recording::format::open(std::path::Path::new(&file(name)));
    let recording = open("shot.mcap").expect("a recording");
    let traces = &session.model.shot().expect("a shot").captures;
    assert_eq!(&recording.shots[0].captures, traces);
    let csv = open("traces-CH2.csv").expect("a capture");
    assert_eq!(csv.shots[0].captures[0].waveform.codes, traces[1].waveform.codes);
    let scene = Scene::load(file("tuned.toml")).expect("a scene");
    assert_eq!(scene.striker_speed(), Some(0.5));
    let picture = std::fs::read_to_string(file("screen.svg")).expect("a picture");
    assert!(picture.starts_with("<svg") && picture.contains(">Trig'd"), "no picture");
    session.command(&format!("write {}", file("shot.mcap")));
    // Nothing is replaced: the next number is taken.
    assert!(session.model.notice.as_deref().expect("a word").ends_with("shot-2.mcap"));
    assert_eq!(open("shot.mcap").expect("a recording"), recording);
}

#[test]
fn a_bench_held_against_its_own_recording_differs_by_less_than_a_level() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap").display().to_string();
    let mut session = Session::bench("magnet-0.61g");
    session.command(&format!("write {file}"));
    session.command(&format!("compare {file}"));
    while session.model.jobs.comparison.done().is_none() {
        session.next();
    }
    let worst = |session: &Session| {
        let compared = session.model.jobs.comparison.done().expect("scores");
        compared.comparison.channels.iter().map(|c| c.max_lsb).fold(0.0, f64::max)
    };
    assert!(worst(&session) < 1.0, "{}", worst(&session));
    assert_eq!(session.model.page, Some(pages::compare::PAGE));
    // A faster striker is another measurement; the comparison follows the knob, once what is under
    // way has arrived: scores come first, the judgement by the bench's uncertainty after them.
    session.command("set striker.speed 0.6 m/s");
    while worst(&session) <= 10.0 {
        session.next();
    }
}

#[test]
fn knobs_on_a_recording_say_that_there_is_nothing_to_turn() {
    for action in [
        Action::Impact,
        Action::Single,
        Action::Force,
        Action::TurnKnob(TurnDirection::Up),
        Action::Switch,
        Action::TriggerLevel(TurnDirection::Up),
        Action::TriggerSlope,
        Action::TriggerMode,
        Action::Coupling,
        Action::Probe,
        Action::Side(SidePanel::Knobs),
    ] {
        let model = after(super::bench::four_channels(), &[action]);
        let notice = model.notice.as_deref().unwrap_or_default();
        assert!(notice.contains("view SCENE"), "{action:?}: {notice}");
        assert!(model.is_selected(Source::Channel(1)));
    }
}

#[test]
fn values_are_typed_completed_and_brought_back() {
    let mut session = Session::bench("magnet-0.61g");
    choose(&mut session, "striker speed");
    session.act(&[Action::TypeKnob]);
    assert_eq!(session.model.prompt(), "set striker.speed ");
    type_text(&mut session, "0.5 m/s");
    session.act(&[Action::Submit]);
    assert_eq!(scene(&session).striker_speed(), Some(0.5));
    // The line comes back, and a word is completed.
    session.act(&[Action::Prompt("")]);
    session.act(&[Action::Recall(TurnDirection::Up)]);
    assert_eq!(session.model.prompt(), "set striker.speed 0.5 m/s");
    session.act(&[Action::Recall(TurnDirection::Down)]);
    assert_eq!(session.model.prompt(), "");
    type_text(&mut session, "co");
    session.act(&[Action::Complete]);
    assert_eq!(session.model.prompt(), "compare ");
    type_text(&mut session, "gravity-0.6");
    session.act(&[Action::Complete]);
    assert_eq!(session.model.prompt(), "compare gravity-0.61g ");
    session.act(&[Action::Back]);
}

/// Esc once too often does not throw a bench away whose settings are in no file.
#[test]
fn a_bench_with_unsaved_settings_is_left_at_the_second_esc() {
    let mut session = Session::bench("magnet-0.61g");
    let set = |session: &mut Session, speed: &str| {
        session.act(&[Action::Prompt("")]);
        type_text(session, &format!("set striker.speed {speed}"));
        session.act(&[Action::Submit]);
    };
    set(&mut session, "0.5 m/s");
    session.act(&[Action::Back]);
    let asked = session.model.notice.clone().expect("a question");
    assert!(session.model.is_running() && asked.contains("not saved"), "{asked}");
    // Anything else takes the question back.
    session.act(&[Action::NextTrace(TurnDirection::Up), Action::Back]);
    assert!(session.model.is_running());
    session.act(&[Action::Back]);
    assert!(!session.model.is_running());
    let mut unchanged = Session::bench("magnet-0.61g");
    unchanged.act(&[Action::Back]);
    assert!(!unchanged.model.is_running());
}

#[test]
fn acquisition_mode_and_averages_are_controls() {
    let mut session = Session::bench("magnet-0.61g");
    let mut seen = Vec::new();
    for _ in 0..7 {
        let acquisition = scene(&session).scope.acquisition;
        seen.push((acquisition.mode, acquisition.depth()));
        session.act(&[Action::Acquisition]);
    }
    let averages = [4, 16, 64, 128].map(|number| (AcquireMode::Average, number));
    assert_eq!(seen[..2], [(AcquireMode::Sample, 1), (AcquireMode::PeakDetect, 1)]);
    assert_eq!(seen[2..6], averages);
    assert_eq!(seen[6], (AcquireMode::Sample, 1));
}

#[test]
fn trigger_source_and_bandwidth_limit_are_controls() {
    let mut session = Session::bench("magnet-0.61g");
    session.act(&[Action::Bandwidth]);
    let limited = |session: &Session| {
        scene(session).scope.channels[0].as_ref().expect("CH1").vertical.bandwidth_limited
    };
    assert_eq!(limited(&session), Some(true));
    session.act(&[Action::Bandwidth]);
    assert_eq!(limited(&session), Some(false));
    assert_eq!(scene(&session).scope.trigger.source, TriggerSource::Channel(1));
    session.act(&[Action::TriggerSource]);
    assert_eq!(scene(&session).scope.trigger.source, TriggerSource::Channel(2));
}

/// Bands of 95 % lie around the traces and follow the knobs; off, they are gone.
#[test]
fn bands_follow_the_knobs() {
    let mut session = Session::bench("magnet-0.61g");
    session.act(&[Action::Bands]);
    let mut highest = |before: f64| {
        let began = std::time::Instant::now();
        loop {
            let captures = session.model.captures();
            let waveform = captures.first().map(|capture| capture.waveform.clone()).expect("CH1");
            if let Some([low, high]) = session.model.bands(&waveform) {
                let top = high.values.iter().copied().fold(0.0, f64::max);
                if top != before {
                    println!("bands after {:?}", began.elapsed());
                    // Beside noise and rounding; where the pulse rises, 5 % of a share of the
                    // record may lie outside.
                    let margin = 4.0 * waveform.preamble.y_mult;
                    let inside = |index: &usize| {
                        let volts = waveform.volts_of(waveform.codes[*index]);
                        let band = low.values[*index] - margin..=high.values[*index] + margin;
                        band.contains(&volts)
                    };
                    let count = low.values.len();
                    let share = (0..count).filter(inside).count() as f64 / count as f64;
                    assert!(share > 0.97, "{share}");
                    session.act(&[Action::TurnKnob(TurnDirection::Up)]);
                    return top;
                }
            }
            session.next();
        }
    };
    let first = highest(0.0);
    // The first knob is the striker's speed.
    let second = highest(first);
    assert!(second > 1.005 * first, "{first} {second}");
    session.act(&[Action::Bands]);
    let waveform = session.model.captures()[0].waveform.clone();
    assert!(session.model.bands(&waveform).is_none());
}

/// The beginning of a command is the command, unless several begin like that.
#[test]
fn the_beginning_of_several_commands_is_refused() {
    let mut session = Session::bench("magnet-0.61g");
    session.command("s striker.speed 0.6 m/s");
    let notice = session.model.notice.clone().expect("a notice");
    assert_eq!(notice, ":s is the beginning of :seek :scene :sensor :set");
    assert!(session.model.recordings.front().live.as_ref().expect("a bench").settings().is_empty());
    session.command("set striker.speed 0.6 m/s");
    assert_eq!(scene(&session).striker_speed(), Some(0.6));
    // The name of a command is the command, also where a longer one begins like it.
    session.command("see 0.1 ms");
    assert_eq!(session.model.page, Some(pages::bench::PAGE));
}

/// The command line has a cursor: letters are typed and deleted where it is.
#[test]
fn the_command_line_is_edited_at_its_cursor() {
    let mut session = Session::bench("magnet-0.61g");
    session.act(&[Action::Prompt("gto 1")]);
    let edit = |request| Action::Edit(request);
    session.act(&[edit(InputRequest::GoToStart), edit(InputRequest::GoToNextChar)]);
    session.act(&[Action::Type('o')]);
    assert_eq!(session.model.prompt(), "goto 1");
    session.act(&[edit(InputRequest::GoToEnd), edit(InputRequest::DeletePrevWord)]);
    assert_eq!(session.model.prompt(), "goto ");
    draw(&session.model, 80, 24).find(":goto");
}

/// A no-break space and a decomposed accent are letters of a name like others.
#[test]
fn a_scene_in_any_folder_is_struck() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path().join("Messungen\u{a0}Fr\u{65}\u{301}\"d\\e");
    std::fs::create_dir(&folder).expect("a folder");
    let file = folder.join("bench.toml");
    std::fs::write(&file, "base = \"magnet-0.61g\"\n").expect("a file");
    let session = Session::bench(file.to_str().expect("a path"));
    assert_eq!(session.model.notice, None);
    assert_eq!(session.model.captures().len(), 4);
}
