//! The screen of a scope that is served somewhere else: what it shows, what its keys do there, and
//! that nobody else notices.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::bench::{compute, draw};
use crate::server::Server;
use hertzscope::client::{Address, Client, ClientTiming};
use hertzscope::recording::mcap::read;
use hertzscope::recording::{Origin, TraceSet};
use hertzscope::scope::{Coupling, Source};
use hertzscope::server::ServerOptions;
use hertzscope::tui::axis::TurnDirection;
use hertzscope::tui::job::with_reasons;
use hertzscope::tui::model::{Action, Palette, RunState, ScreenState, SidePanel, update};
use hertzscope::tui::work::served::ServedConnection;
use hertzscope::tui::work::{ScreenEvent, Workers};
use ratatui::layout::Size;

/// Far longer than anything takes.
const TIMEOUT: Duration = Duration::from_secs(120);
const SIZE: Size = Size { width: 80, height: 24 };

/// Tries a line again quickly.
const TIMING: ClientTiming = ClientTiming {
    reply_timeout: Duration::from_secs(5),
    poll_interval: Duration::from_millis(100),
    retry_interval: Duration::from_millis(20),
};

fn connect(address: &str) -> Result<ServedConnection, String> {
    let address = Address::Socket(address.to_owned());
    let connected = ServedConnection::connect(&address, TIMING, Arc::default());
    connected.map_err(|error| with_reasons(&error))
}

/// A screen on a served scope.
struct Session {
    model: ScreenState,
    staff: Workers,
    news: Receiver<ScreenEvent>,
}

impl Session {
    fn on(server: &Server) -> Self {
        let address = server.address.to_string();
        let scope = connect(&address).expect("a scope");
        Self::with(scope, address)
    }

    fn with(scope: ServedConnection, address: String) -> Self {
        let mut model = ScreenState::new(TraceSet::default(), address, Palette::Colour);
        model.open_served();
        let (mut staff, news) = Workers::start(None, false);
        staff.watch(scope);
        let mut session = Self { model, staff, news };
        session.wait_for(|model| model.recordings.front().scene.as_ref().is_some());
        session
    }

    fn wait_for(&mut self, wanted: impl Fn(&ScreenState) -> bool) {
        while !wanted(&self.model) {
            let news = self.news.recv_timeout(TIMEOUT).expect("news");
            news.apply(&mut self.model);
        }
    }

    fn act(&mut self, action: Action) {
        update(&mut self.model, action);
        compute(&mut self.model);
        self.staff.serve(&mut self.model, SIZE);
    }

    /// The shot on screen.
    fn number(&self) -> u32 {
        self.model.shot().map_or(0, |shot| shot.number)
    }
}

fn peak(model: &ScreenState) -> f64 {
    let capture = model.captures().first().expect("a trace");
    let levels = capture.waveform.codes.iter();
    levels.map(|code| capture.waveform.volts_of(*code)).fold(0.0, f64::max)
}

#[test]
fn it_shows_what_the_scope_shows_and_its_keys_turn_the_scope() {
    let server = Server::at_rest();
    let mut lab = server.connect();
    let mut session = Session::on(&server);
    session.wait_for(|model| {
        model.recordings.front().live.as_ref().is_some_and(|l| l.acquisition == RunState::Running)
    });
    draw(&session.model, 80, 24).find("i strikes the chain");
    session.wait_for(|model| draw(model, 80, 24).text().contains("Ready"));
    session.act(Action::Impact);
    session.wait_for(|model| model.captures().len() == 4);
    // The same numbers as another client's.
    let codes = &session.model.captures()[1].waveform.codes;
    let told = lab.ask("DAT:SOU CH2;ENC ASCI;WID 1;STAR 1;STOP 2500;:CURV?");
    let told: Vec<i16> = told.trim_end().split(',').map(|c| c.parse().expect("a level")).collect();
    assert_eq!(*codes, told);
    let shot = session.model.shot().expect("a shot");
    assert_eq!((shot.number, shot.origin), (1, Origin::Simulated));
    // Sensors and speeds are known, since the scene ships.
    session.act(Action::Side(SidePanel::Measurements));
    draw(&session.model, 80, 24).find("CH1-CH2");
    let vertical = session.model.captures()[0].waveform.vertical;
    assert_eq!((vertical.coupling, vertical.probe), (Some(Coupling::Dc), 1.0));
    let slow = peak(&session.model);

    for (action, query, expected) in [
        (Action::VoltsPerDivision(TurnDirection::Up), "CH1:SCA?", "2.0E0\n"),
        (Action::Position(TurnDirection::Up), "CH1:POS?", "2.4E0\n"),
        (
            Action::TimePerDivision { turn: TurnDirection::Down, anchor: 0.0 },
            "HOR:MAI:SCA?",
            "1.0E-4\n",
        ),
        (
            Action::TimePerDivision { turn: TurnDirection::Up, anchor: 0.0 },
            "HOR:MAI:SCA?",
            "2.5E-4\n",
        ),
        (Action::TriggerSlope, "TRIG:MAI:EDGE:SLO?", "FALL\n"),
        (Action::TriggerSlope, "TRIG:MAI:EDGE:SLO?", "RISE\n"),
        (Action::Coupling, "CH1:COUP?", "AC\n"),
        (Action::Coupling, "CH1:COUP?", "GND\n"),
        (Action::Coupling, "CH1:COUP?", "DC\n"),
        (Action::RunStop, "ACQ:STATE?", "0\n"),
        (Action::Single, "ACQ:STATE?;STOPA?", "1;SEQUENCE\n"),
    ] {
        session.act(action);
        // The command went out before the answer to the next look, and the client's question comes
        // after that.
        let word = expected.trim_end();
        let mut answer = String::new();
        while answer.trim_end() != word {
            let news = session.news.recv_timeout(TIMEOUT).unwrap_or_else(|_| {
                panic!("{action:?}: {query} is still {answer}, expected {word}")
            });
            news.apply(&mut session.model);
            answer = lab.ask(query);
        }
    }
    // The second knob is the striker's speed.
    session.act(Action::NextKnob(TurnDirection::Up));
    session.act(Action::TurnKnob(TurnDirection::Up));
    session.act(Action::TurnKnob(TurnDirection::Up));
    session.act(Action::TurnKnob(TurnDirection::Up));
    let before = session.number();
    session.act(Action::Impact);
    session.wait_for(|model| model.shot().is_some_and(|shot| shot.number > before));
    session.wait_for(|model| {
        model.recordings.front().live.as_ref().is_some_and(|l| l.acquisition == RunState::Stopped)
    });
    assert_eq!(lab.ask("BENC:STRI:SPE?"), "5.87E-1\n");
    // 0.587 m/s for 0.44 m/s: a force between the speed's power 1 of a preloaded chain and 6/5 of
    // an unloaded one.
    let ratio = peak(&session.model) / slow;
    let speeds: f64 = 0.587 / 0.44;
    assert!((0.97 * speeds..1.03 * speeds.powf(1.2)).contains(&ratio), "{ratio}");
    // What is tuned is a scene.
    let text = session.model.recordings.front().live.as_ref().expect("a bench").text();
    let scene = hertzscope::scene::Scene::from_text("tuned", "tuned.toml", &text).expect("a scene");
    assert_eq!(scene.striker_speed(), Some(0.587));
    assert_eq!(scene.scope.channels[0].as_ref().expect("a channel").vertical.scale, 2.0);
}

/// A lab client reads its curve its own way while a screen takes every record: it never gets
/// another curve, another encoding, or an event that it did not cause.
#[test]
fn nobody_else_notices() {
    let impact_every = Some(Duration::from_millis(20));
    let server = Server::with(ServerOptions { impact_every, ..ServerOptions::default() });
    let mut lab = server.connect();
    lab.send(b"*CLS;:DAT:SOU CH2;ENC ASCI;WID 2;STAR 5;STOP 14\n");
    let mut session = Session::on(&server);
    let (mut records, mut asked) = (0, 0);
    while records < 5 || asked < 200 {
        let answer = lab.ask("DAT:SOU?;ENC?;WID?;STAR?;STOP?;:ACQ:NUMAC?");
        assert!(answer.starts_with("CH2;ASCII;2;5;14;"), "{answer}");
        asked += 1;
        for news in session.news.try_iter() {
            news.apply(&mut session.model);
            records += 1;
        }
        assert!(!session.model.notice.as_deref().is_some_and(|word| word.contains("gone")));
    }
    assert_eq!(session.model.captures().len(), 4);
    assert_eq!(lab.ask("*ESR?;EVENT?"), "0;0\n");
}

#[test]
fn a_scope_that_is_gone_is_told() {
    let server = Server::at_rest();
    let mut session = Session::on(&server);
    session.act(Action::Impact);
    session.wait_for(|model| !model.captures().is_empty());
    drop(server);
    session.wait_for(|model| draw(model, 80, 24).text().contains("Lost"));
    assert!(session.model.notice.as_deref().expect("a word").contains("connection lost"));
    // What was seen stays, and keys harm nothing.
    for action in [Action::Impact, Action::VoltsPerDivision(TurnDirection::Up), Action::RunStop] {
        session.act(action);
    }
    assert!(session.model.captures().iter().any(|c| c.waveform.source == Source::Channel(4)));
}

#[test]
fn somebody_else_is_refused() {
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = port.local_addr().expect("an address").to_string();
    let stranger = std::thread::spawn(move || {
        let (mut stream, _) = port.accept().expect("a client");
        let mut line = String::new();
        BufReader::new(stream.try_clone().expect("a stream")).read_line(&mut line).expect("a line");
        stream.write_all(b"220 mail.example.org ESMTP\n").expect("a greeting");
    });
    let refused = connect(&address).err().expect("no scope");
    assert!(refused.contains("220 mail.example.org"), "{refused}");
    assert!(refused.contains("expected a Tektronix oscilloscope"), "{refused}");
    stranger.join().expect("no panic");
    let nobody = connect(&address).err().expect("nobody there");
    assert!(nobody.contains(&address), "{nobody}");
}

/// A server that answers its first message with `reply`, again and again, until the client leaves
/// or 4 MiB are sent.
fn hostile(reply: &'static [u8]) -> String {
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = port.local_addr().expect("an address").to_string();
    std::thread::spawn(move || {
        let (mut stream, _) = port.accept().expect("a client");
        let mut line = String::new();
        BufReader::new(stream.try_clone().expect("a stream")).read_line(&mut line).expect("a line");
        let flood = reply.repeat(4096usize.div_ceil(reply.len()));
        (0..1024).all(|_| stream.write_all(&flood).is_ok())
    });
    address
}

#[test]
fn a_hostile_scope_is_refused_in_one_short_line() {
    let replies: [&[u8]; 7] = [
        b"TEKTRONIX",
        b"\x1b]0;title\x07\x1b[2J evil\n",
        b"HP,\xe2\x80\xaeTDS 2014,0,x\n",
        b"\xff\xfe\xfd\n",
        b"0123456789\r",
        b"#9999999999",
        b"\n",
    ];
    for reply in replies {
        let refused = connect(&hostile(reply)).err().expect("no scope");
        assert!(refused.chars().count() < 250, "{} characters", refused.chars().count());
        assert!(!refused.chars().any(|c| c.is_control() || c == '\u{202e}'), "{refused:?}");
    }
}

/// Records in reply to a query: lengths that do not fit, records without end, text without end.
#[test]
fn hostile_records_end_the_connection_and_not_the_memory() {
    let replies: [(&[u8], &str); 6] = [
        (b":WFMP:X 1;:CURV #0\n", "a block without a length"),
        (b":WFMP:X 1;:CURV #9999999999", "a block without end"),
        (b":WFMP:X 1;:CURV #2x1", "a block without a length"),
        (b":WFMP:X 1;:CURV #11a;", "more records than a scope has"),
        (b":WFMP:X 1;:CURV #11ab", "a block that is longer than its header says"),
        (b"CURV 1;", "a reply without end"),
    ];
    for (reply, expected) in replies {
        let mut scope = Client::connect(&Address::Socket(hostile(reply)), TIMEOUT, &Arc::default())
            .expect("a connection");
        let refused = scope.ask_for_records("CURV?").expect_err("no records");
        assert!(refused.to_string().contains(expected), "{refused}");
    }
}

/// The traces on screen are held against a scene's as they come, and recorded; the scope on screen
/// is the measured side.
#[test]
fn what_is_shown_is_compared_with_a_scene_and_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("seen.mcap");
    let server = Server::at_rest();
    let address = server.address.to_string();
    let mut scope = connect(&address).expect("a scope");
    assert_eq!(scope.record(&file).expect("a recording"), file);
    let mut session = Session::with(scope, address.clone());
    session.model.compare_with("magnet-0.61g".to_owned());
    let mut seen = Vec::new();
    for number in 1..=2 {
        session.act(Action::Impact);
        session.wait_for(|model| model.shot().is_some_and(|shot| shot.number == number));
        seen.push(session.model.captures()[2].waveform.codes.clone());
    }
    session.wait_for(|model| model.jobs.comparison.done().is_some());
    // The scene states its uncertainty.
    session.wait_for(|model| model.jobs.bands.len() == 4);
    // Then the verdict goes by it, as in `compare`.
    session.wait_for(|model| {
        let found = model.jobs.comparison.done();
        found.is_some_and(|found| found.comparison.tolerance[0].contains("E_n"))
    });
    let comparison = session.model.jobs.comparison.done().expect("one").comparison.clone();
    assert_eq!((comparison.measured, comparison.channels.len()), (address, 4));
    assert_eq!((comparison.simulated.as_str(), comparison.verdict), ("magnet-0.61g", "pass"));
    draw(&session.model, 80, 24)
        .find("CH1 measured in colour, CH1 simulated in white, its 95 % band in grey");
    // The recording is complete when the screen is closed.
    drop(session);
    let set = read(&file).expect("a recording");
    assert_eq!(set.problems, [""; 0]);
    let recorded: Vec<_> =
        set.shots.iter().map(|shot| shot.captures[2].waveform.codes.clone()).collect();
    assert_eq!(recorded, seen);
    assert!(set.notes[&2].set_up.contains(":CH1:PROBE"));
}

/// The line fails in the middle of the first curve: the screen says so, connects again, and goes
/// on.
#[test]
fn a_screen_connects_again_after_its_line_failed() {
    let server = Server::at_rest();
    let pulls = vec![(1, 100), (0, 0)];
    let address = crate::client::lines::socket(
        server.address,
        pulls,
        crate::client::lines::Failure::Closed,
        || (),
    );
    let address = address.to_string();
    let scope = connect(&address).expect("a scope");
    let mut session = Session::with(scope, address);
    session.act(Action::Impact);
    session.wait_for(|model| draw(model, 80, 24).text().contains("Lost"));
    assert!(session.model.notice.as_deref().expect("a notice").contains("trying again"));
    session.act(Action::Impact);
    assert_eq!(session.model.notice.as_deref(), Some("the scope is not connected: trying again"));
    session.wait_for(|model| model.captures().len() == 4);
    session.wait_for(|model| !draw(model, 80, 24).text().contains("Lost"));
}

/// In scan mode no acquisition is counted, and the record changes all the time.
#[test]
fn a_scope_that_scans_is_shown() {
    let server = Server::at_rest();
    let mut lab = server.connect();
    assert_eq!(lab.ask("TRIG:MAI:MOD AUTO;:HOR:MAI:SCA 0.1;:ACQ:STATE RUN;STATE?"), "1\n");
    let mut session = Session::on(&server);
    session.wait_for(|model| model.captures().len() == 4);
    assert_eq!(lab.ask("ACQ:NUMAC?"), "0\n");
    // What it stopped with is a record, too.
    assert_eq!(lab.ask("ACQ:STATE STOP;STATE?"), "0\n");
    let mut session = Session::on(&server);
    session.wait_for(|model| model.captures().len() == 4);
}

/// How the screen asks for the scope's state.
const STATE: &str = ":ACQ:STATE?";

/// What went over a line: a question of the screen, or (a part of) the reply.
enum OnLine {
    Asked(Instant, String),
    Answered(Instant),
}

/// A served scope behind a line on which each reply takes `delay`, and what went over the line.
#[allow(clippy::large_stack_arrays, reason = "a buffer of a test")]
fn slow_line(server: &Server, delay: Duration) -> (String, Arc<Mutex<Vec<OnLine>>>) {
    let scope = server.address;
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = port.local_addr().expect("an address").to_string();
    let line = Arc::new(Mutex::new(Vec::new()));
    let (asked, answered) = (Arc::clone(&line), Arc::clone(&line));
    std::thread::spawn(move || {
        let (client, _) = port.accept().expect("a client");
        let mut scope = TcpStream::connect(scope).expect("a scope");
        let (mut from, mut to) =
            (scope.try_clone().expect("one"), client.try_clone().expect("one"));
        std::thread::spawn(move || {
            let mut bytes = [0; 1 << 16];
            while let Ok(count @ 1..) = from.read(&mut bytes) {
                std::thread::sleep(delay);
                answered.lock().expect("a list").push(OnLine::Answered(Instant::now()));
                if to.write_all(&bytes[..count]).is_err() {
                    return;
                }
            }
        });
        for line in BufReader::new(client).lines().map_while(Result::ok) {
            asked.lock().expect("a list").push(OnLine::Asked(Instant::now(), line.clone()));
            scope.write_all(format!("{line}\n").as_bytes()).expect("a scope");
        }
    });
    (address, line)
}

/// Over a slow line the screen leaves the line free for commands most of the time: before it asks
/// for the scope's state, the line was free for three times as long as the reply before had taken.
/// A busy machine makes the pause longer and not the reply, which begins and ends on the line.
#[test]
fn a_slow_line_is_mostly_free() {
    let server = Server::at_rest();
    let (address, line) = slow_line(&server, Duration::from_millis(40));
    let _session = Session::with(connect(&address).expect("a scope"), address);
    let is_state = |on: &OnLine| matches!(on, OnLine::Asked(_, text) if text.starts_with(STATE));
    while line.lock().expect("a list").iter().filter(|on| is_state(on)).count() < 12 {
        std::thread::sleep(Duration::from_millis(50));
    }
    let line = line.lock().expect("a list");
    let (mut asked, mut replied, mut last) = (None, None, None);
    let mut pauses = 0;
    for on in line.iter() {
        match on {
            OnLine::Asked(now, text) if text.starts_with(STATE) => {
                if let (Some(asked), Some(replied), Some(last)) = (asked, replied, last) {
                    let (reply, pause) = (replied - asked, *now - last);
                    assert!(pause >= 3 * reply, "{pause:?} after {reply:?}");
                    pauses += 1;
                }
                (asked, replied) = (Some(*now), None);
            }
            OnLine::Asked(..) => {}
            OnLine::Answered(now) => {
                replied = replied.or(Some(*now));
                last = Some(*now);
            }
        }
    }
    assert!(pauses >= 10, "{pauses}");
}
