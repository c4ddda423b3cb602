//! An instrument with one connection.

use hertzscope::instrument::{Accepted, Instrument, Signals};
use hertzscope::scene::Scene;
use hertzscope::scope::Model;
use hertzscope::scpi::{Preferences, Reply, Session};

/// The model of the data file.
pub fn model() -> Model {
    Scene::load("magnet-0.61g").expect("the default scene").scope.model
}

pub struct Bench {
    pub instrument: Instrument,
    pub session: Session,
    pub now: f64,
}

impl Bench {
    /// Just switched on, the power-on event read, headers off.
    pub fn new() -> Self {
        let mut bench = Self::switched_on();
        bench.instrument.status.clear();
        bench
    }

    /// The same of a model with so many channels.
    pub fn with_channels(channels: u8) -> Self {
        let model = Model { channels, ..model() };
        let mut bench = Self { instrument: Instrument::new(model, 0.0, 1), ..Self::new() };
        bench.instrument.status.clear();
        bench
    }

    pub fn switched_on() -> Self {
        Self {
            instrument: Instrument::new(model(), 0.0, 1),
            session: Session::new(Preferences::new(false)),
            now: 0.0,
        }
    }

    /// With headers, as the original answers on RS-232.
    pub fn with_headers() -> Self {
        let mut bench = Self::new();
        bench.session = Session::new(Preferences::new(true));
        bench
    }

    /// The bytes of a reply to one line; none are empty.
    pub fn bytes(&mut self, line: &str) -> Vec<u8> {
        let line = format!("{line}\n");
        match self.session.receive(&mut self.instrument, line.as_bytes()) {
            Reply::None => Vec::new(),
            Reply::Now(bytes) => bytes,
            Reply::WhenIdle(bytes) => panic!("{line} waits, after {bytes:?}"),
        }
    }

    /// The reply to one line, without its line feed.
    #[track_caller]
    pub fn ask(&mut self, line: &str) -> String {
        let text = String::from_utf8(self.bytes(line)).expect("text");
        text.strip_suffix('\n').unwrap_or_else(|| panic!("{line}: no reply, {text:?}")).to_owned()
    }

    /// Sends a line that has no reply.
    #[track_caller]
    pub fn tell(&mut self, line: &str) {
        assert_eq!(String::from_utf8_lossy(&self.bytes(line)), "", "{line}");
    }

    /// Each query with the reply that belongs to it.
    #[track_caller]
    pub fn transcript(&mut self, lines: &[(&str, &str)]) {
        for (line, reply) in lines {
            assert_eq!(self.ask(line), *reply, "{line}");
        }
    }

    /// Time passes.
    pub fn wait(&mut self, seconds: f64) {
        self.now += seconds;
        self.instrument.advance(self.now);
    }

    /// Sets, takes one record without signal, and stops.
    pub fn quiet_record(&mut self, settings: &str) {
        self.tell(settings);
        self.tell(":TRIG:MAI:MOD AUTO;:ACQ:STOPA SEQ;STATE RUN");
        self.wait(1000.0);
        assert_eq!(self.instrument.state(), hertzscope::instrument::acquisition::State::Save);
    }

    /// Sets, takes one record of `volts` at channel 1 (from the trigger on), and stops.
    pub fn record(&mut self, settings: &str, volts: impl Fn(f64) -> f64) {
        self.tell(settings);
        self.tell(":TRIG:MAI:MOD AUTO;:ACQ:STOPA SEQ;STATE RUN");
        let wanted = self.instrument.sample_window();
        self.wait(wanted.before + 1e-9);
        let before = (wanted.before / wanted.interval).round() as usize;
        let after = (wanted.after / wanted.interval).round() as usize;
        let time = |n: usize| (n as f64 - before as f64) * wanted.interval;
        let volts = vec![(0..=before + after).map(|n| volts(time(n))).collect()];
        let signals = Signals {
            interval: wanted.interval,
            automatic: before,
            volts,
            shot: 1,
            ..Signals::default()
        };
        let accepted = self.instrument.accept_signals(&signals);
        assert!(matches!(accepted, Accepted::Triggered { .. }), "{accepted:?}");
        self.wait(wanted.after + 1e-9);
        assert_eq!(self.ask("*ESR?"), "0", "the record was taken without an event");
    }
}
