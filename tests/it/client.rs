//! Shots taken from a scope over each kind of line, sample by sample against the server's own
//! recording; and lines that fail.

mod addresses;
mod command;
mod lies;
pub mod lines;
mod prologix;
mod pulled;
mod stopped;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use hertzscope::client::{AcquisitionEvent, Address, ClientTiming, ShotAcquisition};
use hertzscope::experiment::{Integration, facts};
use hertzscope::recording::mcap::{RecordingWriter, read};
use hertzscope::recording::{Capture, Shot};
use hertzscope::scene::Scene;
use hertzscope::server::ServerOptions;
use lines::{ByteTime, serial_port, usb_device};
use rustix::termios::{ControlModes, tcgetattr};

use crate::server::{Server, scene};

/// Short waits; the reply's time limit only ends tests that have failed.
const TIMING: ClientTiming = ClientTiming {
    reply_timeout: Duration::from_secs(120),
    poll_interval: Duration::from_millis(2),
    retry_interval: Duration::from_millis(5),
};

/// A server that is struck again and again, and writes its own recording into `file`.
fn struck(file: &Path) -> Server {
    struck_scene(scene(), file)
}

fn struck_scene(scene: Scene, file: &Path) -> Server {
    let accuracy = Integration::Accuracy(scene.accuracy);
    let known = facts::facts(&scene, accuracy).expect("stable");
    let writer = RecordingWriter::create_live(file, &known, &[]).expect("writable");
    let impact_every = Some(Duration::from_millis(20));
    Server::serving(scene, ServerOptions { impact_every, ..ServerOptions::default() }, Some(writer))
}

/// Takes `count` shots; also what happened on the way.
fn shots(
    address: &Address,
    timing: ClientTiming,
    count: u32,
) -> (Vec<Shot>, Vec<AcquisitionEvent>) {
    let mut scope = ShotAcquisition::begin(address, timing, &Arc::default()).expect("a scope");
    let mut events = Vec::new();
    let taken = (1..=count).map(|number| {
        let taken = scope.shot(&mut |event| events.push(event)).expect("a line");
        taken.expect("a shot").numbered(number, address).0
    });
    let taken = taken.collect();
    scope.end().expect("a scope as it was");
    (taken, events)
}

fn is_same(one: &Capture, other: &Capture) -> bool {
    let (one, other) = (&one.waveform, &other.waveform);
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
    let (p, q) = (&one.preamble, &other.preamble);
    let numbers =
        [(p.x_incr, q.x_incr), (p.y_mult, q.y_mult), (p.y_off, q.y_off), (p.y_zero, q.y_zero)];
    one.source == other.source
        && one.codes == other.codes
        && numbers.into_iter().all(|(a, b)| near(a, b))
        // Printed as a multiple of the sample interval.
        && (p.x_zero - q.x_zero).abs() < 1e-3 * q.x_incr
        && one.vertical == other.vertical
}

/// Each shot is one of the server's own recording, in the same order, with every sample.
fn assert_recorded(taken: &[Shot], file: &Path) {
    let own = read(file).expect("the server's recording");
    let mut own = own.shots.iter();
    for shot in taken {
        assert_eq!(shot.captures.len(), 4, "shot {}", shot.number);
        let is_this = |other: &&Shot| {
            let pairs = shot.captures.iter().zip(&other.captures);
            shot.captures.len() == other.captures.len()
                && pairs.into_iter().all(|(a, b)| is_same(a, b))
        };
        assert!(own.any(|other| is_this(&other)), "shot {} is none of the scope's", shot.number);
    }
}

#[test]
fn a_serial_line_brings_every_sample() {
    for baud in [9600, 19200] {
        let folder = tempfile::tempdir().expect("a folder");
        let own = folder.path().join("own.mcap");
        let server = struck(&own);
        let port = serial_port(server.address, folder.path(), ByteTime::at(baud), Vec::new());
        let address = Address::Serial { device: port.clone(), baud };
        let mut scope = ShotAcquisition::begin(&address, TIMING, &Arc::default()).expect("a scope");
        let settings = tcgetattr(std::fs::File::open(&port).expect("a port")).expect("settings");
        assert_eq!((settings.input_speed(), settings.output_speed()), (baud, baud));
        let modes = settings.control_modes;
        assert!(modes.contains(ControlModes::CRTSCTS | ControlModes::CS8), "{modes:?}");
        assert!(!modes.intersects(ControlModes::PARENB | ControlModes::CSTOPB), "{modes:?}");
        let taken = scope.shot(&mut |_| ()).expect("a line").expect("a shot");
        scope.end().expect("a scope as it was");
        drop(server);
        assert_recorded(&[taken.numbered(1, &address).0], &own);
    }
}

#[test]
fn vxi_11_hislip_and_usb_bring_every_sample() {
    let folder = tempfile::tempdir().expect("a folder");
    for (number, line) in ["vxi11", "hislip", "usb"].into_iter().enumerate() {
        let own = folder.path().join(format!("own-{number}.mcap"));
        let server = struck(&own);
        let address = match line {
            "vxi11" => format!("TCPIP::127.0.0.1,{}::inst0::INSTR", server.vxi11.port()),
            "hislip" => format!("TCPIP::127.0.0.1::hislip0,{}::INSTR", server.hislip.port()),
            _ => {
                let device = usb_device(server.address, folder.path(), Vec::new());
                format!("usbtmc:{}", device.display())
            }
        };
        let (taken, events) = shots(&address.parse().expect("an address"), TIMING, 3);
        drop(server);
        assert_recorded(&taken, &own);
        let failed = events.iter().any(|event| matches!(event, AcquisitionEvent::Line(_)));
        assert!(!failed, "{line}: {events:?}");
    }
}

/// A scope of 12 bits is read in two bytes a point, for as long as it takes; one of 8 bits in one,
/// once a record has shown that the lower bytes are empty.
#[test]
fn twelve_bits_come_over_the_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.mcap");
    let mut scene = scene();
    scene.scope.model.bits = 12;
    let server = struck_scene(scene, &own);
    let (taken, _) = shots(&Address::Socket(server.address.to_string()), TIMING, 3);
    drop(server);
    assert_recorded(&taken, &own);
    let captures: Vec<&Capture> = taken.iter().flat_map(|shot| &shot.captures).collect();
    assert!(captures.iter().all(|capture| capture.waveform.bits() == Some(12)));
    assert!(captures.iter().all(|capture| capture.notes.is_empty()), "{captures:?}");
}

/// The trigger's time is known to the last question before it, however long the scope waited.
#[test]
fn the_triggers_time_is_known_to_the_last_question() {
    let server = Server::at_rest();
    let address = Address::Socket(server.address.to_string());
    let mut lab = server.connect();
    let mut scope = ShotAcquisition::begin(&address, TIMING, &Arc::default()).expect("a scope");
    let struck = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_secs(2));
        lab.send(b"BENC:IMP\n");
        lab
    });
    let taken = scope.shot(&mut |_| ()).expect("a line").expect("a shot");
    struck.join().expect("a strike");
    // 2 ms between questions; one second for a busy machine.
    assert!(taken.late < Duration::from_secs(1), "{:?}", taken.late);
}

/// The time limits of the program are those of docs/acquire.md.
#[test]
fn time_limits_are_the_documented_ones() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/acquire.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let timing = ClientTiming::default();
    let [reply, retry] = [timing.reply_timeout, timing.retry_interval].map(|time| time.as_secs());
    for words in [format!("no byte within {reply} s"), format!("reconnects every {retry} s")] {
        assert!(page.contains(&words), "{words}");
    }
}

#[test]
fn a_prologix_adapter_brings_every_sample() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("own.mcap");
    let server = struck(&own);
    let adapter = prologix::Adapter::before(server.address);
    let address = format!("prologix://{}?gpib=7", adapter.address);
    let (taken, events) = shots(&address.parse().expect("an address"), TIMING, 3);
    let told = adapter.commands();
    drop(server);
    assert_recorded(&taken, &own);
    assert!(!events.iter().any(|event| matches!(event, AcquisitionEvent::Line(_))));
    for needed in ["++mode 1", "++addr 7", "++auto 0", "++eoi 1", "++savecfg 0", "++read eoi"] {
        assert!(told.iter().any(|command| command == needed), "{needed} in {told:?}");
    }
}
