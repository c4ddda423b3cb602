//! Headers, paths, terminators, and what is wrong with a message.

use super::bench::Bench;
use hertzscope::scpi::{Reply, input};

/// Any length between the short form and the whole word; pylablib sends `COUPL`.
#[test]
fn every_length_of_a_header_is_taken() {
    let mut bench = Bench::new();
    for header in ["CH1:COUP", "ch1:coupl", "Ch1:Coupli", ":CH1:COUPLIN", "CH1:COUPLING"] {
        assert_eq!(bench.ask(&format!("{header}?")), "DC");
    }
    for header in ["CH1:COU", "CH1:COUPLINGS", "CH5:COUP", "CH0:COUP", "CH:COUP", "COUP"] {
        bench.tell(&format!("{header}?"));
    }
}

#[test]
fn a_header_without_colon_follows_the_one_before() {
    let mut bench = Bench::with_headers();
    assert_eq!(
        bench.ask("CH1:COUPling DC;BANdwidth ON;:CH1:COUP?;BAN?"),
        ":CH1:COUPLING DC;:CH1:BANDWIDTH ON"
    );
    assert_eq!(
        bench.ask(":measu:immed:source1 ch1;type pk2pk;type?"),
        ":MEASUREMENT:IMMED:TYPE PK2PK"
    );
    // Common commands leave the path as it is.
    assert_eq!(bench.ask("CH1:COUP?;*OPC?;BAN?"), ":CH1:COUPLING DC;1;:CH1:BANDWIDTH ON");
    // From the root there is no such thing.
    bench.tell("CH1:COUP DC;:BAN?");
}

#[test]
fn several_queries_have_one_reply() {
    let mut bench = Bench::new();
    assert_eq!(bench.ask("CH1:SCALE?;:HEADER?;:HOR:RECO?"), "1.0E0;0;2500");
}

#[test]
fn common_commands_take_no_colon() {
    let mut bench = Bench::new();
    bench.tell(":*IDN?");
    assert_eq!(bench.ask("*ESR?"), "32");
}

#[test]
fn words_are_short_without_verbose() {
    let mut bench = Bench::new();
    bench.transcript(&[
        ("ACQ:MODE?", "SAMPLE"),
        ("VERBOSE OFF;:ACQ:MODE?", "SAM"),
        ("HEADER ON;:ACQ:MODE?", ":ACQ:MOD SAM"),
        ("VERBOSE ON;:ACQ:MODE?", ":ACQUIRE:MODE SAMPLE"),
        ("HDR 0;HDR?", "0"),
    ]);
}

/// Carriage return, line feed, and both in either order end a message; the second of a pair ends an
/// empty one.
#[test]
fn every_line_end_ends_a_message() {
    for end in ["\r", "\n", "\r\n", "\n\r"] {
        let mut bench = Bench::new();
        let bytes = format!("CH1:COUP?{end}CH1:COUP?{end}");
        let reply = bench.session.receive(&mut bench.instrument, bytes.as_bytes());
        assert_eq!(reply, Reply::Now(b"DC\nDC\n".to_vec()), "{end:?}");
        assert_eq!(bench.ask("*ESR?"), "0");
    }
}

#[test]
fn bytes_may_come_one_by_one() {
    let mut bench = Bench::new();
    for byte in b"CH1:COUP?" {
        assert_eq!(bench.session.receive(&mut bench.instrument, &[*byte]), Reply::None);
    }
    assert_eq!(bench.session.end_of_message(&mut bench.instrument), Reply::Now(b"DC\n".to_vec()));
    assert_eq!(bench.session.end_of_message(&mut bench.instrument), Reply::None);
}

#[test]
fn replies_end_as_asked_for() {
    let mut bench = Bench::new();
    for (name, end) in [("CR", "\r"), ("CRLF", "\r\n"), ("LFCR", "\n\r"), ("LF", "\n")] {
        bench.tell(&format!("RS232:TRANSMIT:TERMINATOR {name}"));
        let reply = format!("{name}{end}");
        assert_eq!(bench.bytes("RS232:TRAN:TERM?"), reply.as_bytes());
    }
}

/// A query that does not exist has no reply at all; pylablib finds the number of channels that way.
#[test]
fn an_unknown_query_is_met_with_silence() {
    let mut bench = Bench::new();
    bench.tell("*CLS");
    bench.tell(":CH5:POSITION?");
    bench.transcript(&[("*ESR?", "32"), ("ALLEV?", "113,\"Undefined header; \""), ("*ESR?", "0")]);
}

#[test]
fn what_is_wrong_is_reported() {
    for (line, code) in [
        ("CH1:SCALE", "109"),
        ("CH1:SCALE 1,2", "108"),
        ("CH1:SCALE LARGE", "104"),
        ("CH1:COUP XY", "224"),
        ("CH1:COUP \"DC\"", "104"),
        ("CH1:COUP? 1", "108"),
        ("CH1::COUP?", "102"),
        ("CH1:COUP@", "101"),
        ("MATH:DEFINE \"CH1", "151"),
        ("MATH:DEFINE \"CH1*CH2\"", "2235"),
        ("CURVE #9", "161"),
        ("DATA:DEST CH1", "2241"),
        ("*RCL 11", "222"),
        ("HARDC START", "241"),
        ("BUSY 1", "113"),
        ("*WAI?", "113"),
    ] {
        let mut bench = Bench::new();
        bench.tell(line);
        bench.ask("*ESR?");
        assert_eq!(bench.ask("EVENT?"), code, "{line}");
    }
}

#[test]
fn the_rest_of_a_message_goes_on_after_an_error() {
    let mut bench = Bench::new();
    assert_eq!(bench.ask("CH1:WRONG 1;:CH1:COUP AC;COUP?"), "AC");
}

#[test]
fn a_message_that_is_too_long_is_lost_and_the_next_is_not() {
    let mut bench = Bench::new();
    let long = "X".repeat(input::MAXIMUM_BYTES + 1);
    bench.tell(&long);
    bench.transcript(&[("*ESR?", "8"), ("EVENT?", "363"), ("CH1:COUP?", "DC")]);
}

/// Output that outgrows its buffer is lost together with the rest of the message, as IEEE 488.2
/// says of a deadlock.
#[test]
fn replies_are_limited() {
    let mut bench = Bench::new();
    bench.quiet_record("DATA:WIDTH 2");
    let most = hertzscope::scpi::MAXIMUM_REPLY / 5006;
    bench.tell(&"CURVE?;".repeat(most + 2));
    bench.transcript(&[("*ESR?", "4"), ("EVENT?", "430")]);
    assert!(bench.bytes(&"CURVE?;".repeat(most)).len() > 5006 * most);
}

#[test]
fn nothing_follows_the_identity() {
    let mut bench = Bench::new();
    let identity = "TEKTRONIX,TDS 2014,0,CF:91.1CT FV:v4.12 TDS2CM:CMV:v1.04";
    bench.transcript(&[("*IDN?", identity), ("*IDN?;CH1:COUP?", identity)]);
    bench.transcript(&[
        ("*ESR?", "4"),
        ("EVENT?", "440"),
        ("CH1:COUP?;*IDN?", &format!("DC;{identity}")),
    ]);
}

#[test]
fn device_clear_forgets_what_was_begun() {
    let mut bench = Bench::new();
    let reply = bench.session.receive(&mut bench.instrument, b"CH1:COUP AC;CURVE #45000xyz");
    assert_eq!(reply, Reply::None);
    bench.session.clear();
    assert_eq!(bench.ask("CH1:COUP?"), "DC");
}

/// What waits for an acquisition is forgotten, and so are the messages behind it.
#[test]
fn device_clear_forgets_what_waits() {
    let mut bench = Bench::new();
    for message in ["ACQ:STOPA SEQ;STATE ON;*WAI;:CH1:COUP GND\n", "CH1:INV ON\n"] {
        let reply = bench.session.receive(&mut bench.instrument, message.as_bytes());
        assert_eq!(reply, Reply::WhenIdle(Vec::new()), "{message}");
    }
    bench.session.clear();
    bench.tell("ACQ:STATE OFF");
    assert_eq!(bench.session.resume(&mut bench.instrument), Reply::None);
    assert_eq!(bench.ask("CH1:COUP?;INV?"), "DC;OFF");
}

/// `#0` begins a block that ends with its message; the family has none: the line ends it.
#[test]
fn a_block_without_a_length_ends_with_its_line() {
    let mut bench = Bench::new();
    bench.tell("CURVE #05");
    assert_ne!(bench.ask("*ESR?"), "0");
}

/// A message that waits after its only query owes the reply, which is known and not yet sent.
#[test]
fn a_reply_that_is_known_is_owed() {
    let mut bench = Bench::new();
    let message = b"ACQ:STOPA SEQ;STATE ON;:CH1:COUP?;*WAI;:CH1:COUP GND\n";
    let reply = bench.session.receive(&mut bench.instrument, message);
    assert_eq!(reply, Reply::WhenIdle(Vec::new()));
    assert!(bench.session.owes_reply());
    bench.session.interrupt(&mut bench.instrument);
    assert!(!bench.session.is_waiting());
    assert_eq!(bench.ask("CH1:COUP?"), "DC");
}

/// A text has 1000 characters at most; a longer one is invalid (event 151), whatever it is for.
#[test]
fn a_text_is_limited() {
    let mut bench = Bench::new();
    for (length, is_invalid) in [(1000, false), (1001, true)] {
        bench.tell(&format!("BENC:FAU \"{}\"", "x".repeat(length)));
        bench.ask("*ESR?");
        assert_eq!(bench.ask("EVENT?") == "151", is_invalid, "{length}");
    }
}
