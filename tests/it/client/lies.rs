//! Scopes that contradict themselves. A stand-in between client and served scope changes one
//! number of a reply, once or always; nothing is recorded that contradicts itself without a note.

use std::io::{BufRead as _, BufReader, Read, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread;

use hertzscope::client::{AcquiredShot, AcquisitionEvent, Address, ShotAcquisition};

use super::{TIMING, shots, struck};

/// In which reply a lie stands.
#[derive(Clone, Copy, PartialEq)]
enum Reply {
    /// To `WAVFrm?` of the second trace.
    Record,
    /// To `SET?`.
    SetUp,
}

/// A number of a reply, what takes its place, and how often.
struct Lie {
    reply: Reply,
    from: &'static str,
    to: &'static str,
    times: usize,
    /// How many records stand in the reply, one after the other.
    copies: usize,
}

impl Lie {
    fn tell(&mut self, message: &str, reply: Vec<u8>) -> Vec<u8> {
        let is_meant = match self.reply {
            Reply::Record => message.contains(":DAT:SOU CH2;:WAVF?"),
            Reply::SetUp => message == "SET?",
        };
        if !is_meant || self.times == 0 {
            return reply;
        }
        self.times -= 1;
        let (from, to) = (self.from.as_bytes(), self.to.as_bytes());
        let at = reply.windows(from.len()).position(|part| part == from);
        let at = at.unwrap_or_else(|| panic!("found no {} in the reply to {message}", self.from));
        let changed = [&reply[..at], to, &reply[at + from.len()..]].concat();
        let line = changed.strip_suffix(b"\n").expect("a line");
        [vec![line; self.copies].join(&b';'), b"\n".to_vec()].concat()
    }
}

/// All bytes of one reply; a line feed in a block is not its end.
fn reply(scope: &mut impl Read) -> std::io::Result<Vec<u8>> {
    let (mut reply, mut byte) = (Vec::new(), [0]);
    loop {
        scope.read_exact(&mut byte)?;
        reply.push(byte[0]);
        if byte[0] == b'\n' {
            return Ok(reply);
        }
        if reply.ends_with(b"#42500") {
            let mut block = vec![0; 2500];
            scope.read_exact(&mut block)?;
            reply.extend(block);
        }
    }
}

/// A liar before the scope at `server`, for one client after the other: it changes each reply by
/// `tell`, or closes the connection in its place.
fn liar(
    server: SocketAddr,
    mut tell: impl FnMut(&str, Vec<u8>) -> Option<Vec<u8>> + Send + 'static,
) -> Address {
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = port.local_addr().expect("an address").to_string();
    thread::spawn(move || {
        for client in port.incoming().map_while(Result::ok) {
            let mut scope = BufReader::new(TcpStream::connect(server).expect("a scope"));
            let mut to = client.try_clone().expect("a socket");
            for message in BufReader::new(client).lines().map_while(Result::ok) {
                let sent = scope.get_mut().write_all(format!("{message}\n").as_bytes());
                if sent.is_err() || !message.contains('?') {
                    continue;
                }
                let Ok(reply) = reply(&mut scope) else { break };
                let Some(told) = tell(&message, reply) else { break };
                if to.write_all(&told).is_err() {
                    break;
                }
            }
        }
    });
    Address::Socket(address)
}

/// One shot through a liar, the contradictions that were reported, and what was gone when it was
/// read again; or the error.
fn told(mut lie: Lie) -> Result<(AcquiredShot, Vec<String>, Vec<String>), String> {
    let folder = tempfile::tempdir().expect("a folder");
    let server = struck(&folder.path().join("own.mcap"));
    let address = liar(server.address, move |message, reply| Some(lie.tell(message, reply)));
    let begun = ShotAcquisition::begin(&address, TIMING, &Arc::default());
    let mut scope = begun.map_err(|error| error.to_string())?;
    let (mut contradictions, mut again) = (Vec::new(), Vec::new());
    let taken = scope.shot(&mut |event| match event {
        AcquisitionEvent::Contradiction(note) => contradictions.push(note),
        AcquisitionEvent::ReadAgain(note) => again.push(note),
        _ => {}
    });
    let taken = taken.map_err(|error| {
        use std::error::Error as _;
        error.source().map(ToString::to_string).unwrap_or_default()
    });
    let _ = scope.end();
    let taken = taken?.expect("a shot");
    Ok((taken, contradictions, again))
}

fn lie(reply: Reply, from: &'static str, to: &'static str) -> Lie {
    Lie { reply, from, to, times: usize::MAX, copies: 1 }
}

/// The served scope says 1 V/div of CH2 (`YMULT 4.0E-2`), 100 µs/div (`XINCR 1.0E-6`).
#[test]
fn what_a_scope_says_twice_and_differently_is_recorded_with_a_note() {
    for (reply, from, to, words) in [
        (Reply::Record, "YMULT 4.0E-2", "YMULT 4.0E-1", "YMULT means 10.00 V/div"),
        (Reply::Record, "YMULT 4.0E-2", "YMULT 1E38", "YMULT means"),
        (Reply::Record, "YMULT 4.0E-2", "YMULT 4.2E-2", "YMULT means 1.050 V/div"),
        (Reply::Record, "XINCR 1.0E-6", "XINCR 1.0E-5", "XINCR means 2.500 ms/div"),
        (Reply::Record, "XINCR 1.0E-6", "XINCR 1E38", "XINCR means"),
        (Reply::Record, "XINCR 1.0E-6", "XINCR 1E-300", "XINCR means"),
        (Reply::Record, "PT_OFF 0", "PT_OFF 1E38", "PT_OFF"),
        (Reply::Record, "PT_OFF 0", "PT_OFF 7", "found PT_OFF 7, expected 0"),
        (Reply::Record, "BN_FMT RI", "BN_FMT RP", "found BN_FMT RP, expected RI"),
        (Reply::Record, "YZERO 0.0E0", "YZERO 1.0E0", "found YZERO 1, expected 0"),
        (Reply::Record, "XZERO -", "XZERO ", "trigger point"),
        (Reply::Record, "DC coupling", "AC coupling", "WFID says AC coupling, SET? says DC"),
        (Reply::Record, "1.0E0 V/div", "5.0E0 V/div", "WFID says 5.000 V/div"),
        (Reply::Record, "2.5E-4 s/div", "2.5E-3 s/div", "WFID says 2.500 ms/div"),
        (Reply::Record, "2500 points", "1000 points", "WFID says 1000"),
        (Reply::SetUp, ":CH2:PROBE 1;SCALE 1.0E0", ":CH2:PROBE 1;SCALE 5.0E0", "vertical scale"),
        (
            Reply::SetUp,
            ":CH2:PROBE 1;SCALE 1.0E0",
            ":CH2:PROBE 1;SCALE 1E999",
            "expected a finite number",
        ),
        (Reply::SetUp, "MAIN:SCALE 2.5E-4", "MAIN:SCALE 5.0E-4", "time base"),
    ] {
        let (shot, contradictions, _) = match told(lie(reply, from, to)) {
            Ok(taken) => taken,
            // Volts or seconds beyond any number are not recorded at all.
            Err(error) if to.contains("1E38") || to.contains("1E-300") => {
                let words = ["expected a finite number", "the times cannot be told apart"];
                assert!(words.iter().any(|word| error.contains(word)), "{to}: {error}");
                continue;
            }
            Err(error) => panic!("{to}: {error}"),
        };
        let notes = shot.captures.iter().flat_map(|capture| &capture.notes);
        assert!(
            notes.clone().any(|note| note.contains(words)),
            "{to}: {:?}",
            notes.collect::<Vec<_>>()
        );
        assert!(contradictions.iter().any(|note| note.contains(words)), "{to}: {contradictions:?}");
    }
}

#[test]
fn a_lie_that_is_told_once_is_not_recorded() {
    let once = Lie { times: 1, ..lie(Reply::Record, "YMULT 4.0E-2", "YMULT 4.0E-1") };
    let (shot, contradictions, again) = told(once).expect("a shot");
    assert!(again[0].starts_with("CH2: YMULT means 10.00 V/div"), "{again:?}");
    assert_eq!(contradictions, [""; 0]);
    assert!(shot.captures.iter().all(|capture| capture.notes.is_empty()));
    assert!((shot.captures[1].waveform.preamble.y_mult - 0.04).abs() < 1e-12);
}

#[test]
fn a_scope_that_is_true_is_recorded_without_a_note() {
    let (shot, contradictions, again) =
        told(Lie { times: 0, ..lie(Reply::SetUp, "", "") }).expect("a shot");
    assert_eq!((contradictions, again), (Vec::new(), Vec::new()));
    assert!(shot.captures.iter().all(|capture| capture.notes.is_empty()));
}

/// Invalid records: they are asked for twenty times, and not recorded.
#[test]
fn an_invalid_record_is_not_recorded() {
    for (from, to, words) in [
        ("NR_PT 2500", "NR_PT 2499", "found 2500 points in a record whose NR_PT says otherwise"),
        ("NR_PT 2500", "NR_PT 25E2x", "NR_PT"),
        ("\"Ch2,", "\"Ch9,", "found the record of Ch9, expected that of CH2"),
        ("\"Ch2,", "\"Ch1,", "found the record of Ch1, expected that of CH2"),
        ("\"Ch2,", "\"Xy2,", "found the record of Xy2, expected that of CH2"),
        ("#42500", "#41500", "a block that is longer than its header says"),
    ] {
        let refused = told(lie(Reply::Record, from, to)).expect_err(to);
        assert!(refused.contains(words), "{to}: {refused}");
    }
}

/// More records than were asked for: which of them is the trace's cannot be known.
#[test]
fn several_records_in_a_reply_are_not_recorded() {
    for (copies, words) in [(2, "no record, or several"), (12, "more records than a scope has")] {
        let several = Lie { copies, ..lie(Reply::Record, "Ch2", "Ch2") };
        let refused = told(several).expect_err(words);
        assert!(refused.contains(words), "{copies}: {refused}");
    }
}

/// The line is cut behind the second trace; when it is back, that trace has the same samples and
/// another scale. Which of both is true cannot be known.
#[test]
fn a_record_whose_preamble_has_changed_is_dropped() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = struck(&folder.path().join("own.mcap"));
    let mut is_cut = false;
    let mut changed = lie(Reply::Record, "YMULT 4.0E-2", "YMULT 4.2E-2");
    let address = liar(server.address, move |message, reply| {
        if !is_cut && message.contains(":DAT:SOU CH3;:WAVF?") {
            is_cut = true;
            return None;
        }
        Some(if is_cut { changed.tell(message, reply) } else { reply })
    });
    let (_, events) = shots(&address, TIMING, 1);
    let dropped =
        AcquisitionEvent::Dropped("the scope took another record while its line was down");
    assert!(events.contains(&dropped), "{events:?}");
}
