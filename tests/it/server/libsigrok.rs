//! The command sequence of libsigrok's driver for this family, `tektronix-ocp2k5` (in the fork
//! `byteit101/libsigrok`, branch `tek_ocp2k5`, commit `10eb7e97`), read off its source: a scan, the
//! settings that it reads when it opens the scope, and one frame of two channels. What it demands
//! of each reply is checked: numbers without a header, 16 fields before the block of `WAVF?`, an
//! offset of 0 points, 2500 points, and one channel after the other from the same trigger.

use std::io::Read as _;
use std::time::Duration;

use hertzscope::server::ServerOptions;

use super::{Client, IDENTITY, Server};

/// Channels of the model.
const CHANNELS: [u8; 4] = [1, 2, 3, 4];
/// Points of a record, which the driver takes as given.
const POINTS: usize = 2500;
/// Fields before the block.
const FIELDS: usize = 16;

fn number(client: &mut Client, query: &str) -> f64 {
    let reply = client.ask(query);
    reply.trim_end().parse().unwrap_or_else(|_| panic!("{query}: {reply} is no number"))
}

fn one_of(client: &mut Client, query: &str, words: &[&str]) {
    let reply = client.ask(query);
    assert!(words.contains(&reply.trim_end()), "{query}: {reply}, expected one of {words:?}");
}

/// What it reads when it opens a device.
fn open(client: &mut Client) -> f64 {
    for channel in CHANNELS {
        one_of(client, &format!("SELECT:CH{channel}?"), &["0", "1"]);
    }
    for channel in CHANNELS {
        assert!(number(client, &format!("CH{channel}:PROBE?")) >= 1.0);
    }
    for channel in CHANNELS {
        assert!(number(client, &format!("CH{channel}:SCA?")) > 0.0);
    }
    for channel in CHANNELS {
        assert!(number(client, &format!("CH{channel}:POS?")).abs() <= 50.0);
    }
    let time_base = horizontal(client);
    for channel in CHANNELS {
        one_of(client, &format!("CH{channel}:COUP?"), &["AC", "DC", "GND"]);
    }
    one_of(client, "TRIG:MAI:edge:sou?", &["CH1", "CH2", "CH3", "CH4", "EXT", "EXT5", "LINE"]);
    number(client, "hor:pos?");
    one_of(client, "trig:mai:edge:slope?", &["RISE", "FALL"]);
    number(client, "trig:mai:lev?");
    one_of(client, "acq:mod?", &["SAMPLE", "PEAKDETECT", "AVERAGE"]);
    assert!(number(client, "acq:numav?") >= 4.0);
    time_base
}

fn horizontal(client: &mut Client) -> f64 {
    let time_base = number(client, "hor:sca?");
    assert_eq!(number(client, "hor:reco?"), POINTS as f64);
    time_base
}

/// Numbers of a record's preamble, as the driver turns levels into volts, and the levels.
struct Frame {
    interval: f64,
    first: f64,
    y_mult: f64,
    y_zero: f64,
    y_off: f64,
    levels: Vec<i8>,
}

/// `WAVF?`, read as the driver does: a hundred bytes, then a few more at a time up to the 16th
/// semicolon, the block's head, and 2500 bytes.
fn frame(client: &mut Client) -> Frame {
    client.send(b"WAVF?\n");
    let mut header = Vec::new();
    let mut wanted = 100;
    loop {
        let mut more = vec![0; wanted];
        client.stream.read_exact(&mut more).expect("a header");
        header.extend(more);
        let found = header.split(|byte| *byte == b';').count() - 1;
        if found >= FIELDS {
            break;
        }
        wanted = (FIELDS - found) * if FIELDS - found > 1 { 2 } else { 1 };
    }
    let mut head = [0; 6];
    client.stream.read_exact(&mut head).expect("a block's head");
    assert_eq!(&head, b"#42500");
    let mut block = vec![0; POINTS + 1];
    client.stream.read_exact(&mut block).expect("a block");
    assert_eq!(block.pop(), Some(b'\n'));
    let header = String::from_utf8(header).expect("text");
    let fields: Vec<&str> = header.split(';').collect();
    assert_eq!((fields.len(), fields[FIELDS]), (FIELDS + 1, ""), "{header}");
    assert_eq!(fields[..6], ["1", "8", "BIN", "RI", "MSB", "2500"], "{header}");
    assert_eq!((fields[7], fields[9], fields[11], fields[15]), ("Y", "0", "\"s\"", "\"Volts\""));
    let number = |place: usize| fields[place].parse().expect("a number");
    Frame {
        interval: number(8),
        first: number(10),
        y_mult: number(12),
        y_zero: number(13),
        y_off: number(14),
        levels: block.iter().map(|byte| i8::from_be_bytes([*byte])).collect(),
    }
}

#[test]
fn libsigroks_driver_opens_the_scope_and_reads_a_frame() {
    let impact_every = Some(Duration::from_millis(20));
    let server = Server::with(ServerOptions { impact_every, ..ServerOptions::default() });
    let mut client = server.connect();
    assert_eq!(client.ask("*IDN?"), IDENTITY);
    let time_base = open(&mut client);
    // The scene has all channels on; it reads two of them.
    client.send(b"SEL:CH3 OFF\nSEL:CH4 OFF\nhor:view mai\n");
    horizontal(&mut client);
    assert_eq!(client.ask("acq:state?"), "1\n");
    one_of(&mut client, "acq:stopa?", &["RUNSTOP"]);
    client.send(b"dat:enc RIB\ndat:wid 1\nACQ:STATE STOP\nACQ:stopa seq\nACQ:STATE RUN\n");
    client.send(b"DAT:SOU CH1\n*WAI\n");
    let mut frames = vec![frame(&mut client)];
    client.send(b"DAT:SOU CH2\n");
    frames.push(frame(&mut client));
    // Power on, and no error.
    assert_eq!(client.ask("*ESR?"), "128\n");
    // The same records by another encoding and separate queries.
    for (channel, frame) in (1..).zip(&frames) {
        let levels = client.ask(&format!("DATA:SOU CH{channel};ENC ASCI;:CURVE?"));
        let levels: Vec<i8> =
            levels.trim_end().split(',').map(|level| level.parse().expect("a level")).collect();
        assert_eq!(frame.levels, levels);
        assert_eq!(number(&mut client, &format!("CH{channel}:SCA?")) / 25.0, frame.y_mult);
        assert!((frame.interval - time_base / 250.0).abs() < 1e-6 * frame.interval);
        assert!(frame.first <= 0.0 && frame.y_zero == 0.0 && frame.y_off.abs() <= 125.0);
    }
    assert_ne!(frames[0].levels, frames[1].levels);
    // A later frame of a scope that is in single sequences already.
    client.send(b"dat:enc RIB\nACQ:STATE RUN\nDAT:SOU CH1\n*WAI\n");
    assert_eq!(frame(&mut client).levels.len(), POINTS);
    assert_eq!(client.ask("acq:state?"), "0\n");
}
