//! Writes the seeds of the corpora with the program's own writers: `seeds FOLDER`.

use std::path::{Path, PathBuf};

use hertzscope::recording::isf::{self, Width};
use hertzscope::recording::{TraceSet, mcap, tek_csv};
use hertzscope::scope::PointFormat;

/// MCAP's first and last bytes.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Opcodes of records.
const CHUNK: u8 = 0x06;
const MESSAGE_INDEX: u8 = 0x07;
const DATA_END: u8 = 0x0F;

fn put(folder: &Path, target: &str, name: &str, bytes: &[u8]) {
    let folder = folder.join(target);
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join(name), bytes).expect("a file");
}

/// A recording as a file.
fn packed(set: &TraceSet) -> Vec<u8> {
    let file = std::env::temp_dir().join(format!("hertzscope-seed-{}.mcap", std::process::id()));
    mcap::write(&file, set).expect("a recording");
    let bytes = std::fs::read(&file).expect("the recording");
    let _ = std::fs::remove_file(&file);
    bytes
}

/// The same records without chunks, compression, checksums and summary, so that a changed byte
/// reaches the decoders.
fn plain(packed: &[u8]) -> Vec<u8> {
    let mut rest = &packed[MAGIC.len()..];
    let mut out = MAGIC.to_vec();
    let length = |bytes: &[u8]| {
        usize::try_from(u64::from_le_bytes(bytes[..8].try_into().expect("8 bytes"))).expect("short")
    };
    loop {
        let (head, body) = rest.split_at(9);
        let (body, tail) = body.split_at(length(&head[1..]));
        match head[0] {
            CHUNK => {
                let name = u32::from_le_bytes(body[28..32].try_into().expect("4 bytes")) as usize;
                let data = &body[32 + name + 8..];
                out.extend(zstd::decode_all(data).expect("a chunk"));
            }
            DATA_END => return out,
            MESSAGE_INDEX => {}
            _ => {
                out.extend_from_slice(head);
                out.extend_from_slice(body);
            }
        }
        rest = tail;
    }
}

fn main() {
    let folder = PathBuf::from(std::env::args().nth(1).expect("a folder"));
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../recordings/gravity-0.61g.mcap");
    let mut set = hertzscope::recording::format::open(&shipped).expect("the shipped recording");
    let capture = set.shots[0].captures[0].clone();
    let native = tek_csv::write(&capture).expect("a native file");
    put(&folder, "csv", "native", native.as_bytes());
    let pairs = |rows: usize, separator: &str, comma: bool| {
        let mut text = String::new();
        for index in 240..240 + rows {
            let (t, v) =
                (capture.waveform.time(index), capture.waveform.volts(index).unwrap_or(0.0));
            let row = format!("{t:e}{separator}{v:.4}\r\n");
            text.push_str(&if comma { row.replace('.', ",") } else { row });
        }
        text
    };
    put(&folder, "csv", "headerless", pairs(24, ",", false).as_bytes());
    put(&folder, "csv", "semicolons", pairs(24, ";", true).as_bytes());
    put(&folder, "csv", "named", format!("x,y\n{}", pairs(24, ",", false)).as_bytes());
    let newer = "Model,TBS1102C\nFirmware Version,v1.29.38\n\nPoint Format,Y,\nHorizontal Units,S,\nHorizontal Scale,4e-06,\n\
                 Sample Interval,1e-6,\nFilter Frequency,2e+08,\nRecord Length,24,\nGating,0.0% to 100.0%\n\
                 Probe Attenuation,1\nVertical Units,V\nVertical Offset,0\nVertical Scale,1\nLabel,,\nTIME,CH1\n";
    put(&folder, "csv", "newer", format!("{newer}{}", pairs(24, ",", false)).as_bytes());
    let header: Vec<&str> = native.lines().take(18).collect();
    let short: Vec<String> =
        header.iter().map(|row| row.trim_end_matches(',').replace(' ', "")).collect();
    put(&folder, "csv", "spreadsheet", (short.join("\n") + "\n").as_bytes());
    put(&folder, "csv", "hand", format!("a,b,c,x,y,d\r\n{}\r\n", header.join("\r\n")).as_bytes());

    let mut small = capture;
    small.waveform.codes.truncate(16);
    for (name, width) in [("one", Width::One), ("two", Width::Two)] {
        put(&folder, "isf", name, &isf::write(&small, width).expect("an ISF file"));
    }
    small.waveform.preamble.pt_fmt = PointFormat::Envelope;
    put(&folder, "isf", "envelope", &isf::write(&small, Width::One).expect("an ISF file"));
    let words = ":WFMP:NR_P 4;BYT_N 1;BIT_N 8;ENC ASC;BN_F RP;BYT_O LSB;WFI \"Ch2, AC coupling\";PT_F Y;XUN \"s\";XIN 1E-6;XZE 0;YUN \"V\";YMU 4E-2;YOF 1;YZE 0;VSCALE 1.0;VPOS 0;:CURV 1,2,3,4\n";
    put(&folder, "isf", "words", words.as_bytes());

    let text = hertzscope::scope::set_up::set_up_text(
        &hertzscope::scene::Scene::load("magnet-0.61g").expect("a scene").scope,
    );
    put(
        &folder,
        "set",
        "panel",
        format!("{text};:MATH:DEFINE \"FFT(CH1,HANNING)\";FFT:VERTICAL:SCALE 5.0E-1\n").as_bytes(),
    );

    set.shots.truncate(1);
    set.attachments.clear();
    for shot in &mut set.shots {
        shot.captures.truncate(1);
        shot.captures.iter_mut().for_each(|c| c.waveform.codes.truncate(16));
        shot.truth.truncate(1);
        shot.truth.iter_mut().for_each(|t| t.values.truncate(8));
    }
    let packed = packed(&set);
    put(&folder, "mcap", "plain", &plain(&packed));
    put(&folder, "mcap", "packed", &packed);
    put(&folder, "mcap", "magic", MAGIC);
}
