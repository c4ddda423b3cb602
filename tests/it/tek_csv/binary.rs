//! Binary files of other programs and instruments, built here by their descriptions.

use std::path::Path;

use hertzscope::recording::format::open_with;
use hertzscope::recording::tek_csv::TableColumns;
use hertzscope::recording::{RecordingError, TraceSet};

/// First sample, and from one to the next (s).
const START: f64 = -1e-4;
const INTERVAL: f64 = 4e-7;
const POINTS: usize = 2500;

/// Levels of a pulse and of a saw.
fn levels() -> [Vec<i16>; 2] {
    let pulse = |i: usize| (100.0 * (-((i as f64 - 900.0) / 80.0).powi(2)).exp()) as i16;
    [(0..POINTS).map(pulse).collect(), (0..POINTS).map(|i| (i % 101) as i16 - 50).collect()]
}

fn volts(level: i16) -> f64 {
    f64::from(level) * 0.04
}

fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let mut header =
        format!("{{'descr': {descr}, 'fortran_order': False, 'shape': ({shape}), }}").into_bytes();
    while (header.len() + 11) % 64 != 0 {
        header.push(b' ');
    }
    header.push(b'\n');
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], &header, data].concat()
}

fn time(i: usize) -> f64 {
    START + INTERVAL * i as f64
}

/// A table of times and two channels, a row after the other.
fn npy_table() -> Vec<u8> {
    let [a, b] = levels();
    let row = |i: usize| [time(i), volts(a[i]), volts(b[i])].map(f64::to_le_bytes).concat();
    let data: Vec<u8> = (0..POINTS).flat_map(row).collect();
    npy("'<f8'", "2500, 3", &data)
}

/// The same as fields of three kinds, the most significant bytes first.
fn npy_fields() -> Vec<u8> {
    let [a, b] = levels();
    let row = |i: usize| {
        let (x, y) = (volts(a[i]) as f32, f64::from(volts(b[i]) as f32));
        [&time(i).to_be_bytes()[..], &x.to_be_bytes(), &y.to_be_bytes()].concat()
    };
    let data: Vec<u8> = (0..POINTS).flat_map(row).collect();
    npy("[('time', '>f8'), ('CH1', '>f4'), ('CH2', '>f8')]", "2500,", &data)
}

/// An archive of stored arrays.
fn npz() -> Vec<u8> {
    let [a, b] = levels();
    let column = |values: Vec<f64>| {
        let data: Vec<u8> = values.into_iter().flat_map(f64::to_le_bytes).collect();
        npy("'<f8'", "2500,", &data)
    };
    let arrays = [
        ("time.npy", column((0..POINTS).map(time).collect())),
        ("CH1.npy", column(a.into_iter().map(volts).collect())),
        ("CH2.npy", column(b.into_iter().map(volts).collect())),
    ];
    let (mut file, mut directory) = (Vec::new(), Vec::new());
    for (name, array) in &arrays {
        let start = file.len() as u32;
        let mut described = vec![0_u8; 6];
        described.extend([0; 6]);
        described.extend(crc32fast::hash(array).to_le_bytes());
        described.extend((array.len() as u32).to_le_bytes());
        described.extend((array.len() as u32).to_le_bytes());
        described.extend((name.len() as u16).to_le_bytes());
        described.extend([0; 2]);
        file.extend(b"PK\x03\x04");
        file.extend(&described[2..]);
        file.extend(name.bytes());
        file.extend(array);
        directory.extend(b"PK\x01\x02");
        directory.extend(&described);
        directory.extend([0; 10]);
        directory.extend(start.to_le_bytes());
        directory.extend(name.bytes());
    }
    let (start, length) = (file.len() as u32, directory.len() as u32);
    file.extend(&directory);
    file.extend(b"PK\x05\x06\0\0\0\0\x03\0\x03\0");
    file.extend(length.to_le_bytes());
    file.extend(start.to_le_bytes());
    file.extend([0; 2]);
    file
}

/// Two channels of 16 bits at 48 kHz, of which a level is 1/32768 of the full scale.
fn wav() -> Vec<u8> {
    let [a, b] = levels();
    let data: Vec<u8> =
        a.iter().zip(&b).flat_map(|(a, b)| [a.to_le_bytes(), b.to_le_bytes()].concat()).collect();
    let mut file = b"RIFF\0\0\0\0WAVEfmt \x10\0\0\0\x01\0\x02\0".to_vec();
    file.extend(48_000_u32.to_le_bytes());
    file.extend([0; 6]);
    file.extend(16_u16.to_le_bytes());
    file.extend(b"LIST\x03\0\0\0abc\0data");
    file.extend((data.len() as u32).to_le_bytes());
    file.extend(data);
    file
}

fn keysight() -> Vec<u8> {
    let mut file = b"AG10\0\0\0\0\x02\0\0\0".to_vec();
    for (label, values) in ["1", "2"].into_iter().zip(levels()) {
        for number in [140, 1, 1, POINTS as i32, 1, 0] {
            file.extend(number.to_le_bytes());
        }
        for number in [START, INTERVAL, START] {
            file.extend(number.to_le_bytes());
        }
        file.extend([2, 0, 0, 0, 1, 0, 0, 0]);
        let mut texts = [0; 72];
        texts[32..48].copy_from_slice(b"DSO-X 3024A:MY12");
        texts[56..57].copy_from_slice(label.as_bytes());
        file.extend(texts);
        file.extend([0; 12]);
        file.extend([12, 0, 0, 0, 1, 0, 4, 0]);
        file.extend((4 * POINTS as u32).to_le_bytes());
        file.extend(values.iter().flat_map(|level| (volts(*level) as f32).to_le_bytes()));
    }
    file
}

/// Words of `LeCroy`'s second channel, the most significant bytes first, an eighth of a volt above
/// zero.
fn lecroy() -> Vec<u8> {
    let [a, _] = levels();
    let mut block = vec![0; 346];
    let mut put = |at: usize, bytes: &[u8]| block[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"WAVEDESC");
    put(16, b"LECROY_2_3");
    put(32, &1_u16.to_be_bytes());
    put(36, &346_u32.to_be_bytes());
    put(40, &5_u32.to_be_bytes());
    put(60, &(2 * POINTS as u32).to_be_bytes());
    put(76, b"LECROYHDO4");
    put(92, &4321_u32.to_be_bytes());
    put(116, &(POINTS as u32).to_be_bytes());
    put(144, &1_u32.to_be_bytes());
    put(156, &0.04_f32.to_be_bytes());
    put(160, &(-0.125_f32).to_be_bytes());
    put(176, &(INTERVAL as f32).to_be_bytes());
    put(180, &START.to_be_bytes());
    put(196, b"V");
    put(344, &1_u16.to_be_bytes());
    block.extend(b"notes");
    block.extend(a.iter().flat_map(|level| level.to_be_bytes()));
    [format!("#9{:09}", block.len()).as_bytes(), &block].concat()
}

/// Two segments, the second without descriptions, of volts and of an acceleration.
fn tdms() -> Vec<u8> {
    let [a, b] = levels();
    let text = |text: &str| [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat();
    let mut meta = 3_u32.to_le_bytes().to_vec();
    meta.extend(text("/"));
    meta.extend([0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0]);
    for (name, unit, kind) in [("Voltage", "V", 10_u32), ("Accel", "g", 9)] {
        meta.extend(text(&format!("/'drop'/'{name}'")));
        meta.extend(20_u32.to_le_bytes());
        meta.extend(kind.to_le_bytes());
        meta.extend(1_u32.to_le_bytes());
        meta.extend((POINTS as u64 / 2).to_le_bytes());
        meta.extend(3_u32.to_le_bytes());
        for (key, value) in [("wf_increment", INTERVAL), ("wf_start_offset", START)] {
            meta.extend(text(key));
            meta.extend(10_u32.to_le_bytes());
            meta.extend(value.to_le_bytes());
        }
        meta.extend(text("unit_string"));
        meta.extend(0x20_u32.to_le_bytes());
        meta.extend(text(unit));
    }
    let mut file = Vec::new();
    for (half, meta) in [(0..POINTS / 2, meta), (POINTS / 2..POINTS, Vec::new())] {
        let first = a[half.clone()].iter().flat_map(|level| volts(*level).to_le_bytes());
        let second = b[half].iter().flat_map(|level| (volts(*level) as f32).to_le_bytes());
        let raw: Vec<u8> = first.chain(second).collect();
        file.extend(b"TDSm");
        file.extend(if meta.is_empty() { 8_u32 } else { 14 }.to_le_bytes());
        file.extend(4713_u32.to_le_bytes());
        file.extend(((meta.len() + raw.len()) as u64).to_le_bytes());
        file.extend((meta.len() as u64).to_le_bytes());
        file.extend(meta);
        file.extend(raw);
    }
    file
}

/// Version 3, with 16 points before and behind the record.
fn tek() -> Vec<u8> {
    let [a, _] = levels();
    let mut file = vec![0; 838];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"\x0f\x0f:WFM#003");
    put(16, &838_u32.to_le_bytes());
    put(168, &0.04_f64.to_le_bytes());
    put(188, b"V");
    put(488, &INTERVAL.to_le_bytes());
    put(496, &START.to_le_bytes());
    put(508, b"s");
    put(822, &32_u32.to_le_bytes());
    put(826, &(32 + 2 * POINTS as u32).to_le_bytes());
    file.extend([1; 32]);
    file.extend(a.iter().flat_map(|level| level.to_le_bytes()));
    file.extend([1; 32]);
    file
}

fn read(folder: &Path, name: &str, bytes: &[u8]) -> Result<TraceSet, RecordingError> {
    let file = folder.join(name);
    std::fs::write(&file, bytes).expect("a file");
    open_with(&file, &TableColumns::default())
}

/// A file's name, its bytes, and per channel its name, unit, volts a level and offset.
type Case = (&'static str, Vec<u8>, Vec<(&'static str, &'static str, f64, f64)>);

fn cases() -> Vec<Case> {
    let both = || vec![("CH1", "V", 0.04, 0.0), ("CH2", "V", 0.04, 0.0)];
    let full = 1.0 / 32_768.0;
    vec![
        ("table.npy", npy_table(), both()),
        ("fields.npy", npy_fields(), both()),
        ("arrays.npz", npz(), both()),
        ("sound.wav", wav(), vec![("CH1", "V", full, 0.0), ("CH2", "V", full, 0.0)]),
        ("keysight.bin", keysight(), both()),
        ("lecroy.trc", lecroy(), vec![("CH2", "V", 0.04, 0.125)]),
        ("drop.tdms", tdms(), vec![("CH1", "V", 0.04, 0.0), ("CH2", "g", 0.04, 0.0)]),
        ("tek.wfm", tek(), vec![("CH1", "V", 0.04, 0.0)]),
    ]
}

/// Every value and time comes back, whatever the file is called.
#[test]
fn binary_files_are_read_by_their_contents() {
    let folder = tempfile::tempdir().expect("a folder");
    for (case, bytes, channels) in cases() {
        for name in [case, "renamed.csv"] {
            let set = read(folder.path(), name, &bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
            let captures = &set.shots[0].captures;
            assert_eq!(captures.len(), channels.len(), "{name}");
            for ((source, unit, level, offset), capture) in channels.iter().zip(captures) {
                let waveform = &capture.waveform;
                assert_eq!(waveform.source.to_string(), *source, "{name}");
                assert_eq!(waveform.preamble.y_unit, *unit, "{name}");
                let truth = &levels()[usize::from(channels.len() == 2 && *source == "CH2")];
                assert_eq!(waveform.codes.len(), POINTS, "{name}");
                let (start, interval) =
                    if name.ends_with("wav") { (0.0, 1.0 / 48e3) } else { (START, INTERVAL) };
                for (i, expected) in truth.iter().enumerate() {
                    let expected = f64::from(*expected) * level + offset;
                    // A double that holds a number of 32 bits has that number's value.
                    let is_narrow = case == "fields.npy" && *source == "CH2";
                    let expected = if is_narrow { f64::from(expected as f32) } else { expected };
                    let found = waveform.volts(i).expect("a value");
                    assert!(
                        (found - expected).abs() < 1e-6 * level,
                        "{name} {source} {i}: {found}"
                    );
                    if name != "renamed.csv" {
                        let time = start + interval * i as f64;
                        assert!((waveform.time(i) - time).abs() < 1e-6 * interval, "{name} {i}");
                    }
                }
            }
        }
    }
}

/// Files that are cut or changed anywhere are read or refused by name; nothing else happens.
#[test]
fn damaged_binary_files_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut refused = 0;
    for (name, bytes, _) in cases() {
        for cut in (0..600).step_by(7).chain([bytes.len() / 2, bytes.len() - 1]) {
            refused += usize::from(read(folder.path(), name, &bytes[..cut]).is_err());
        }
        for place in 0..bytes.len().min(900) {
            for value in [0, 0x7F, 0xFF] {
                let mut changed = bytes.clone();
                changed[place] = value;
                let end = changed.len().min(4_000);
                refused += usize::from(read(folder.path(), name, &changed[..end]).is_err());
            }
        }
    }
    assert!(refused > 10_000, "{refused}");
}
