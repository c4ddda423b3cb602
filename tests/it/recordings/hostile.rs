//! Files made to do harm: lengths that lie, bombs, numbers that are none.

use hertzscope::recording::TraceSet;
use hertzscope::recording::mcap::message::{CaptureMessage, EnergyMessage, SeriesMessage};
use prost::Message as _;

use super::read;

const HEADER: u8 = 0x01;
const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;
const ATTACHMENT: u8 = 0x09;
const METADATA: u8 = 0x0C;
const DATA_END: u8 = 0x0F;
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    let mut bytes = vec![opcode];
    bytes.extend((body.len() as u64).to_le_bytes());
    bytes.extend(body);
    bytes
}

fn text(text: &str) -> Vec<u8> {
    let length = u32::try_from(text.len()).expect("a short text");
    [&length.to_le_bytes(), text.as_bytes()].concat()
}

fn schema(id: u16, name: &str) -> Vec<u8> {
    record(SCHEMA, &[id.to_le_bytes().to_vec(), text(name), text("protobuf"), text("")].concat())
}

fn channel(id: u16, schema: u16, topic: &str, encoding: &str) -> Vec<u8> {
    let ids = [id.to_le_bytes(), schema.to_le_bytes()].concat();
    record(CHANNEL, &[ids, text(topic), text(encoding), text("")].concat())
}

fn message(channel: u16, data: &[u8]) -> Vec<u8> {
    let mut body = channel.to_le_bytes().to_vec();
    body.extend([0; 4 + 8 + 8]);
    body.extend(data);
    record(MESSAGE, &body)
}

/// A chunk that claims `size` bytes and this checksum.
fn chunk(size: u64, checksum: u32, compression: &str, packed: &[u8]) -> Vec<u8> {
    let mut body = vec![0; 16];
    body.extend(size.to_le_bytes());
    body.extend(checksum.to_le_bytes());
    body.extend(text(compression));
    body.extend((packed.len() as u64).to_le_bytes());
    body.extend(packed);
    record(CHUNK, &body)
}

fn facts() -> Vec<u8> {
    let pairs = [text("key"), text("value")].concat();
    let length = u32::try_from(pairs.len()).expect("a short map");
    record(METADATA, &[text("facts"), length.to_le_bytes().to_vec(), pairs].concat())
}

/// A file of these records between one fact and a proper end.
fn file(records: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(record(HEADER, &[text("hertzscope"), text("a test")].concat()));
    bytes.extend(facts());
    bytes.extend(records.concat());
    bytes.extend(record(DATA_END, &[0; 4]));
    bytes.extend(MAGIC);
    bytes
}

/// The one problem of a file with these records.
fn problem_of(records: &[Vec<u8>]) -> String {
    let set = read(&file(records)).expect("a file with a fact");
    assert_eq!(set.metadata["facts"]["key"], "value");
    let [problem] = set.problems.as_slice() else {
        panic!("expected one problem, found {:?}", set.problems);
    };
    problem.clone()
}

fn says(records: &[Vec<u8>], words: &[&str]) {
    let problem = problem_of(records);
    for word in words {
        assert!(problem.contains(word), "expected `{word}` in `{problem}`");
    }
}

#[test]
fn the_harmless_file_of_these_tests_has_no_problem() {
    let set = read(&file(&[])).expect("a file with a fact");
    assert_eq!(set.problems, [""; 0]);
}

#[test]
fn lengths_that_lie() {
    let huge = u32::MAX.to_le_bytes();
    says(
        &[record(SCHEMA, &[&[1, 0], &huge[..], b"abc"].concat())],
        &["found 3 bytes", "4294967295"],
    );
    says(&[record(CHANNEL, &[&[1, 0, 1, 0], &huge[..]].concat())], &["found 0 bytes"]);
    says(&[record(METADATA, &[text("x"), huge.to_vec(), text("y")].concat())], &["found 5 bytes"]);
    says(
        &[record(METADATA, &[text("x"), vec![4, 0, 0, 0, 255, 255, 255, 255]].concat())],
        &["found 0 bytes"],
    );
    let attachment = [vec![0; 16], text("a"), text("b"), u64::MAX.to_le_bytes().to_vec()].concat();
    says(&[record(ATTACHMENT, &attachment)], &["found 0 bytes", "18446744073709551615"]);
    let chunk = [vec![0; 28], text(""), u64::MAX.to_le_bytes().to_vec()].concat();
    says(&[record(CHUNK, &chunk)], &["found 0 bytes"]);
    says(&[record(CHUNK, &[0; 3])], &["found 3 bytes", "expected 8"]);
    says(&[record(MESSAGE, &[0; 5])], &["expected 4"]);
    says(&[record(SCHEMA, &[[1, 0].to_vec(), vec![2, 0, 0, 0, 0xC3, 0x28]].concat())], &["UTF-8"]);
}

/// A record that claims more than the file has: nothing is allocated, what came before is kept.
#[test]
fn a_record_longer_than_the_file() {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(facts());
    bytes.push(MESSAGE);
    bytes.extend(u64::MAX.to_le_bytes());
    bytes.extend([0; 100]);
    let set = read(&bytes).expect("a fact before");
    assert!(set.problems.iter().any(|p| p.contains("breaks off")), "{:?}", set.problems);
    assert_eq!(set.metadata.len(), 1);
}

#[test]
fn chunks_that_are_bombs() {
    let zeros = vec![0_u8; 32 * 1024 * 1024];
    let packed = zstd::bulk::compress(&zeros, 1).expect("zeros pack");
    assert!(packed.len() < 20_000, "{} bytes", packed.len());
    // It says less than it holds: it is not unpacked further than it says.
    says(&[chunk(100, 0, "zstd", &packed)], &["does not unpack"]);
    // It says more than anyone may.
    says(&[chunk(u64::MAX, 0, "zstd", &packed)], &["found a chunk of 18446744073709551615 bytes"]);
    says(&[chunk(1 << 40, 0, "", b"abc")], &["found a chunk of 1099511627776 bytes"]);
    // It says more than it holds.
    says(&[chunk(33 * 1024 * 1024, 0, "zstd", &packed)], &["found a chunk of 33554432 bytes"]);
    says(&[chunk(4, 0, "", b"abc")], &["found a chunk of 3 bytes", "expected 4"]);
    says(&[chunk(3, 7, "", b"abc")], &["checksum"]);
    says(&[chunk(3, 0, "lz5", b"abc")], &["compression `lz5`", "zstd"]);
    says(&[chunk(1000, 0, "zstd", b"no frame at all")], &["does not unpack"]);
}

/// Each chunk keeps within its limit, but there are many: 256 MiB from 8 kB each.
#[test]
fn many_chunks_that_are_a_bomb_together() {
    let size = 256 * 1024 * 1024_usize;
    let one = message(7, &vec![0; size - 9 - 22]);
    assert_eq!(one.len(), size);
    let packed = zstd::bulk::compress(&one, 1).expect("zeros pack");
    drop(one);
    let bomb = chunk(size as u64, 0, "zstd", &packed);
    let set = read(&file(&vec![bomb; 40])).expect("a fact");
    let last = set.problems.last().expect("problems");
    assert!(last.contains("unpack to more than"), "{last}");
    // 256 MiB are let through: one chunk, whose message belongs to no channel; the second ends it.
    assert_eq!(set.problems.len(), 2, "{:?}", set.problems);
}

#[test]
fn a_chunk_in_a_chunk() {
    let inner = chunk(3, 0, "", b"abc");
    says(&[chunk(inner.len() as u64, 0, "", &inner)], &["a chunk inside a chunk"]);
    // However deep.
    let mut deep = inner;
    for _ in 0..1000 {
        deep = chunk(deep.len() as u64, 0, "", &deep);
    }
    says(&[deep], &["a chunk inside a chunk"]);
}

#[test]
fn attachments_without_their_checksum_or_with_another() {
    let whole =
        [vec![0; 16], text("a.toml"), text("b"), 3_u64.to_le_bytes().to_vec(), b"abc".to_vec()]
            .concat();
    says(&[record(ATTACHMENT, &whole)], &["found 0 bytes", "expected 4"]);
    let wrong = [whole.clone(), vec![1, 2, 3, 4]].concat();
    says(&[record(ATTACHMENT, &wrong)], &["checksum", "a.toml"]);
    let right = [whole.clone(), crc32fast::hash(&whole).to_le_bytes().to_vec()].concat();
    let set = read(&file(&[record(ATTACHMENT, &right)])).expect("sound");
    assert_eq!(set.problems, [""; 0]);
    assert_eq!(set.attachments[0].data, b"abc");
}

#[test]
fn messages_that_belong_nowhere() {
    says(&[message(9, b"")], &["undeclared channel 9"]);
    says(&[channel(1, 5, "/x", "protobuf")], &["/x", "messages of the kind ``"]);
    says(
        &[schema(5, "other.Thing"), channel(1, 5, "/x", "protobuf"), message(1, b"abc")],
        &["/x", "`other.Thing`"],
    );
    says(&[schema(5, "hertzscope.Capture"), channel(1, 5, "/x", "json")], &["encoding `json`"]);
    says(
        &[
            schema(5, "hertzscope.Capture"),
            channel(1, 5, "/scope/ch1", "protobuf"),
            message(1, &[0xFF; 20]),
        ],
        &["/scope/ch1", "no hertzscope.Capture"],
    );
}

#[test]
fn a_file_of_someone_else_is_refused_with_the_reason() {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(schema(1, "sensor_msgs/Imu"));
    bytes.extend(channel(1, 1, "/imu", "cdr"));
    bytes.extend(message(1, b"abc"));
    bytes.extend(record(DATA_END, &[0; 4]));
    bytes.extend(MAGIC);
    let error = read(&bytes).expect_err("not ours").to_string();
    assert!(error.contains("without a single readable") && error.contains("cdr"), "{error}");
}

fn good_capture() -> CaptureMessage {
    CaptureMessage {
        shot: 1,
        source: "CH1".to_owned(),
        dt_s: 1e-6,
        y_mult: 0.04,
        codes: vec![1, 2, 3],
        volts: vec![0.0; 3],
        probe: 1.0,
        ..CaptureMessage::default()
    }
}

fn with_capture(capture: &CaptureMessage) -> Vec<Vec<u8>> {
    vec![
        schema(1, "hertzscope.Capture"),
        channel(1, 1, "/scope/ch1", "protobuf"),
        message(1, &capture.encode_to_vec()),
    ]
}

/// Changes one number of a message.
type Change<T> = fn(&mut T, f64);

#[test]
fn captures_with_numbers_that_are_none() {
    let sound: TraceSet = read(&file(&with_capture(&good_capture()))).expect("sound");
    assert_eq!(sound.shots[0].captures[0].waveform.codes, [1, 2, 3]);
    let changes: [(&str, Change<CaptureMessage>); 11] = [
        ("t0_s", |c, x| c.t0_s = Some(x)),
        ("dt_s", |c, x| c.dt_s = x),
        ("y_mult", |c, x| c.y_mult = x),
        ("y_off", |c, x| c.y_off = Some(x)),
        ("y_zero", |c, x| c.y_zero = Some(x)),
        ("trigger_point", |c, x| c.trigger_point = Some(x)),
        ("vertical_scale", |c, x| c.vertical_scale = x),
        ("horizontal_scale", |c, x| c.horizontal_scale = x),
        ("position_div", |c, x| c.position_div = Some(x)),
        ("probe", |c, x| c.probe = x),
        ("trigger_time_s", |c, x| c.trigger_time_s = Some(x)),
    ];
    for (name, change) in changes {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut capture = good_capture();
            change(&mut capture, value);
            says(&with_capture(&capture), &["/scope/ch1", name, "a finite number"]);
        }
    }
    // Finite numbers whose products and quotients are not.
    for (name, change) in [
        ("value", (|c| c.y_mult = 1e38) as fn(&mut CaptureMessage)),
        ("y_off", |c| (c.y_mult, c.y_off) = (1e30, Some(1e290))),
        ("y_off", |c| c.y_off = Some(1e13)),
        ("x_incr", |c| c.dt_s = 1e-310),
        ("sample intervals", |c| c.t0_s = Some(-9e12)),
        ("y_mult", |c| c.y_mult = 4e-322),
    ] {
        let mut capture = good_capture();
        capture.codes = vec![1, 2, 100];
        change(&mut capture);
        says(&with_capture(&capture), &["/scope/ch1", name, "expected"]);
    }
    for dt_s in [0.0, -1e-6] {
        says(&with_capture(&CaptureMessage { dt_s, ..good_capture() }), &["dt_s", "above zero"]);
    }
}

#[test]
fn captures_that_contradict_themselves() {
    let short = CaptureMessage { codes: vec![1, 2, 3, 4], ..good_capture() };
    says(&with_capture(&short), &["4 bytes of levels", "3 points"]);
    says(
        &with_capture(&CaptureMessage { codes: vec![], ..good_capture() }),
        &["0 bytes of levels"],
    );
    for source in ["CH0", "CH9", "REFE", "", "CH1x"] {
        let capture = CaptureMessage { source: source.to_owned(), ..good_capture() };
        says(&with_capture(&capture), &["source", "CH1 to CH8"]);
    }
    let mut twice = with_capture(&good_capture());
    twice.push(message(1, &good_capture().encode_to_vec()));
    says(&twice, &["a second capture of CH1 in shot 1"]);
}

#[test]
fn series_and_energies_with_numbers_that_are_none() {
    let good = SeriesMessage {
        shot: 1,
        name: "x".to_owned(),
        dt_s: 1e-6,
        values: vec![1.0, 2.0],
        ..SeriesMessage::default()
    };
    let with = |series: &SeriesMessage| {
        vec![
            schema(1, "hertzscope.Series"),
            channel(1, 1, "/truth/x", "protobuf"),
            message(1, &series.encode_to_vec()),
        ]
    };
    assert_eq!(read(&file(&with(&good))).expect("sound").shots[0].truth[0].values, [1.0, 2.0]);
    for dt_s in [0.0, -1.0] {
        says(&with(&SeriesMessage { dt_s, ..good.clone() }), &["/truth/x", "increasing"]);
    }
    for dt_s in [f64::NAN, f64::INFINITY] {
        says(&with(&SeriesMessage { dt_s, ..good.clone() }), &["/truth/x", "dt_s", "finite"]);
    }
    says(&with(&SeriesMessage { t0_s: f64::NAN, ..good.clone() }), &["finite"]);
    says(&with(&SeriesMessage { values: vec![0.0, f64::NAN], ..good.clone() }), &["value 1"]);
    // Every number of the ledger, also one that is added later: all are 8 bytes behind a key.
    let ledger = EnergyMessage {
        initial_j: 1.0,
        final_j: 1.0,
        dissipated_j: 1.0,
        drift: 1.0,
        kinetic_j: 1.0,
        elastic_j: 1.0,
        gravity_j: 1.0,
        magnet_j: 1.0,
        end_forces_j: 1.0,
        dashpot_j: 1.0,
        kuwabara_kono_j: 1.0,
        power_law_loss_j: 1.0,
        left_in_contacts_j: 1.0,
        plasticity_j: 1.0,
        top_wall_j: 1.0,
        bottom_wall_j: 1.0,
        work_of_drive_j: 1.0,
        ..EnergyMessage::default()
    };
    let sound = ledger.encode_to_vec();
    let places: Vec<usize> =
        (1..=sound.len() - 8).filter(|at| sound[*at..at + 8] == 1_f64.to_le_bytes()).collect();
    assert_eq!(places.len(), 17);
    for place in places {
        let mut changed = sound.clone();
        changed[place..place + 8].copy_from_slice(&f64::NAN.to_le_bytes());
        let records = [
            schema(1, "hertzscope.Energy"),
            channel(1, 1, "/energy", "protobuf"),
            message(1, &changed),
        ];
        says(&records, &["/energy", " = NaN", "a finite number"]);
    }
}

/// A hundred are told, the rest is counted.
#[test]
fn a_flood_of_problems_is_counted() {
    let set = read(&file(&vec![message(9, b""); 5000])).expect("a fact");
    assert_eq!(set.problems.len(), 101);
    assert!(set.problems[100].contains("4900 more"), "{}", set.problems[100]);
}

/// A small file of very many small things: what is kept has a bound that counts things, too.
#[test]
fn many_small_messages_have_a_bound() {
    let log = message(1, &[]).repeat(3_000_000);
    let packed = zstd::bulk::compress(&log, 1).expect("compressed");
    let size = log.len() as u64;
    let bytes = file(&[
        schema(1, "foxglove.Log"),
        channel(1, 1, "/log", "protobuf"),
        chunk(size, 0, "zstd", &packed),
    ]);
    assert!(bytes.len() < 100_000, "{} bytes", bytes.len());
    let set = read(&bytes).expect("a file with a fact");
    assert!(set.log.len() < 1_500_000, "{} lines", set.log.len());
    assert!(set.problems.iter().any(|p| p.contains("passed over")), "{:?}", set.problems);
}
