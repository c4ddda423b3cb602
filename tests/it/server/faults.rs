//! Faults on demand, as a client sees them.

use std::io::Read as _;
use std::time::{Duration, Instant};

use hertzscope::instrument::Fault;
use hertzscope::server::ServerOptions;

use super::{Client, IDENTITY, Server};

fn with(faults: &[&str]) -> (Server, Client) {
    let faults = faults.iter().map(|fault| fault.parse().expect("a fault")).collect();
    let server = Server::with(ServerOptions { faults, ..ServerOptions::default() });
    let client = server.connect();
    (server, client)
}

/// Levels of a channel after an impact.
fn levels(client: &mut Client, channel: u8) -> Vec<f64> {
    client.send(b"CH1:SCA 2;POS 0;:CH2:SCA 2;POS 0;:ACQ:STOPA SEQ;STATE ON;:BENC:IMP\n");
    assert_eq!(client.ask("*OPC?"), "1\n");
    let reply = client.ask(&format!("DATA:SOU CH{channel};ENC ASCI;:CURVE?"));
    reply.trim_end().split(',').map(|level| level.parse().expect("a level")).collect()
}

#[test]
fn faults_are_read_or_refused() {
    for text in ["late=500ms", "noisy@CH2=50 mV*3", "dead", "identity=A,B=C", "drifting=-2 V/s"] {
        assert!(text.parse::<Fault>().is_ok(), "{text}");
    }
    for (text, why) in [
        ("later=1s", "expected one of late=TIME, cut=BYTES"),
        ("late", "expected late=TIME"),
        ("late=5", "expected late=TIME"),
        ("late=-1s", "above zero"),
        ("dead=1", "expected dead"),
        ("dead@CH5", "@CH1 to @CH4"),
        ("cut@CH1=3", "only a sensor's fault"),
        ("missing*0", "count above zero"),
        ("cut=x", "expected cut=BYTES"),
    ] {
        let error = text.parse::<Fault>().expect_err(text).to_string();
        assert!(error.contains(why), "{text}: {error}");
    }
}

#[test]
fn replies_are_disturbed_as_often_as_asked() {
    let (_server, mut client) = with(&["missing*1"]);
    client.send(b"*IDN?\n");
    assert_eq!(client.ask("*OPC?"), "1\n", "the first reply does not come");
    client.send(b"BENC:FAU \"late=50ms*1\"\n");
    assert_eq!(client.ask("BENC:FAU?"), "\"late=50ms*1\"\n", "the bench's own replies are sound");
    let asked = Instant::now();
    client.send(b"*OPC?\n*IDN?\n");
    assert_eq!((client.line(), client.line()), ("1\n".to_owned(), IDENTITY.to_owned()), "in order");
    assert!(asked.elapsed() >= Duration::from_millis(50));
    client.send(b"BENC:FAU \"cut=9*1\"\n");
    assert_eq!(client.ask("*IDN?;\n*OPC?"), "TEKTRONIX1\n");
    client.send(b"BENC:FAU \"garbled=1 %*1\"\n");
    client.send(b"*IDN?\n");
    let mut line = vec![0; IDENTITY.len()];
    client.stream.read_exact(&mut line).expect("as many bytes");
    let wrong = line.iter().zip(IDENTITY.bytes()).filter(|(a, b)| **a != *b).count();
    assert!((1..10).contains(&wrong) && line.ends_with(b"\n"), "{line:?}");
    assert_eq!(client.ask("*IDN?"), IDENTITY);
    client.send(b"BENC:FAU \"identity=ACME,SCOPE\";:BENC:FAU \"nonsense\"\n");
    assert_eq!(client.ask("*IDN?"), "ACME,SCOPE\n");
    assert_eq!(client.ask("*ESR?;EVENT?"), "144;401\n", "an error, and power on");
    client.send(b"BENC:FAU NONE\n");
    assert_eq!(client.ask("*OPC?;:BENC:FAU?"), "1;\"\"\n");
    assert_eq!(client.ask("*IDN?"), IDENTITY);
}

#[test]
fn a_connection_drops_in_mid_curve() {
    let (server, mut client) = with(&["dropped=1000*1"]);
    assert_eq!(client.ask("*IDN?"), IDENTITY, "shorter");
    client.send(b"TRIG:MAI:MOD AUTO;:ACQ:STOPA SEQ;STATE ON;*OPC?\n");
    assert_eq!(client.line(), "1\n");
    client.send(b"DATA INIT;:CURVE?\n");
    let mut read = Vec::new();
    client.stream.read_to_end(&mut read).expect("an end");
    assert!(read.starts_with(b"#42500") && read.len() == 1000, "{}", read.len());
    let mut again = server.connect();
    again.send(b"CURVE?\n");
    again.stream.read_exact(&mut [0; 2507]).expect("a curve");
}

/// Against the sound record of the same impact number of a server without faults.
#[test]
fn sensors_fail_as_asked() {
    let sound = levels(&mut with(&[]).1, 1);
    let highest = |levels: &[f64]| levels.iter().copied().fold(f64::MIN, f64::max);
    // A level is 2 V / 25 = 80 mV.
    let clipped = levels(&mut with(&["clipped=0.8V"]).1, 1);
    assert!(highest(&sound) > 15.0 && (9.0..=11.0).contains(&highest(&clipped)), "{clipped:?}");
    // Channel 1 triggers.
    let (_server, mut client) = with(&["dead@CH2*1"]);
    assert!(highest(&levels(&mut client, 2)) < 3.0, "noise alone");
    assert!(highest(&levels(&mut client, 2)) > 15.0, "for one impact");
    let second = levels(&mut with(&["second=300us"]).1, 1);
    let late: f64 = second.iter().zip(&sound).map(|(a, b)| (a - b).max(0.0)).fold(0.0, f64::max);
    assert!(late > 10.0, "another pulse, {late}");
    let spread = |levels: &[f64]| {
        let changes = levels.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        (changes.sum::<f64>() / levels.len() as f64).sqrt()
    };
    let noisy = levels(&mut with(&["noisy=0.4V"]).1, 1);
    // Five levels of noise change a sample by sqrt(2) of that.
    assert!((5.0..9.0).contains(&spread(&noisy)), "{}", spread(&noisy));
    let drifting = levels(&mut with(&["drifting=400V/s"]).1, 1);
    // Over the 2.5 ms of the record 1 V, which is 12.5 levels.
    let drift = (drifting[2490] - sound[2490]) - (drifting[5] - sound[5]);
    assert!((drift - 12.5).abs() < 4.0, "{drift}");
}

/// The impact counts, the scope waits on; the next one triggers it.
#[test]
fn a_trigger_that_does_not_come() {
    let (_server, mut client) = with(&["no-trigger*1"]);
    client.send(b"ACQ:STOPA SEQ;STATE ON;:BENC:IMP\n");
    while client.ask("BENC:IMP?") == "0\n" {}
    assert_eq!(client.ask("BUSY?"), "1\n");
    client.send(b"BENC:IMP\n");
    assert_eq!(client.ask("*OPC?"), "1\n");
}

/// True forces of the last impact against those of a run of the same scene.
#[test]
fn true_forces_can_be_asked_for() {
    let (_server, mut client) = with(&[]);
    assert_eq!(client.ask("*CLS;:BENC:CH1:FORC?"), "#10\n", "none yet");
    assert_eq!(client.ask("*ESR?"), "0\n", "which is no error");
    let volts = levels(&mut client, 1);
    let times = client.ask("BENC:CH1:FORC:TIM?");
    let (start, interval) = times.trim_end().split_once(',').expect("two numbers");
    let (start, interval): (f64, f64) =
        (start.parse().expect("a time"), interval.parse().expect("a time"));
    client.send(b"BENC:CH1:FORC?\n");
    let mut head = [0; 2];
    client.stream.read_exact(&mut head).expect("a block");
    let mut length = vec![0; usize::from(head[1] - b'0')];
    client.stream.read_exact(&mut length).expect("a length");
    let length = String::from_utf8(length).expect("digits").parse().expect("a length");
    let mut bytes = vec![0; length];
    client.stream.read_exact(&mut bytes).expect("numbers");
    assert_eq!(client.line(), "\n");
    let number = |eight: &[u8]| f64::from_le_bytes(eight.try_into().expect("eight"));
    let forces: Vec<f64> = bytes.chunks(8).map(number).collect();
    let scene = super::scene();
    let outcome =
        super::run(&scene, super::Integration::Accuracy(1e-3), 1, &mut |_| ()).expect("a run");
    let input = scene.scope.channels[0].as_ref().and_then(|c| c.input.clone()).expect("a sensor");
    let truth = outcome.shot.truth.iter().find(|t| t.name.contains(&input)).expect("its force");
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    // The same forces on another grid: sampled 1 us apart, a pulse of 60 us has its peak within 0.1
    // % of the largest sample.
    let (found, expected) = (largest(&forces), largest(&truth.values));
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} N, {expected} N");
    // In time with the record: force and voltage rise together, the trigger at time 0.
    let rise = |values: &[f64]| {
        let half = 0.5 * (values[0] + largest(values));
        values.iter().position(|value| *value > half).expect("a rise") as f64
    };
    let of_force = start + interval * rise(&forces);
    let zero: f64 = client.ask("WFMP:XZE?").trim_end().parse().expect("a time");
    let step: f64 = client.ask("WFMP:XIN?").trim_end().parse().expect("a time");
    let of_volts = zero + step * rise(&volts);
    assert!((of_force - of_volts).abs() < 20e-6, "{of_force} s, {of_volts} s");
}
