//! Binary files of other programs and instruments, turned into the text of a table.
//!
//! A decoder for each format turns the bytes into columns; the reader of tables (`tek_csv`) then
//! finds channels, units and sample times in them and notes what it assumed. A file's first bytes
//! decide on its format, not its name.
//!
//! Values pass as their shortest digits that read back to the same number. Sources of the layouts:
//! `NumPy`'s NEP 1; Microsoft, Multimedia Programming Interface (1991), for WAV; National
//! Instruments, TDMS File Format Internal Structure; Keysight, Programmer's Guide of the
//! `InfiniiVision` 3000 (binary data); Teledyne `LeCroy`, template `LECROY_2_3`; Tektronix
//! 077-0220, Reference Waveform File Format. Each was compared with another program's reader or
//! writer (`NumPy`, `SciPy`, `nptdms`, `lecroyparser`, `tm_data_types`).

mod bytes;
mod keysight;
mod lecroy;
mod numpy;
mod table;
mod tdms;
mod tek_wfm;
mod wav;

use table::BinaryTable;

use super::error::RecordingError;

/// Makes a table of a file's bytes; the file's name is for errors.
type Decode = fn(&[u8], &str) -> Result<BinaryTable, RecordingError>;

/// How files begin, and what reads them.
const KINDS: [(&[u8], Decode); 8] = [
    (b"\x93NUMPY", numpy::array),
    (b"PK\x03\x04", numpy::archive),
    (b"RIFF", wav::read),
    (b"TDSm", tdms::read),
    (b"AG10", keysight::read),
    (b"AG03", keysight::read),
    (b"\x0f\x0f:WFM#00", tek_wfm::read),
    (b"\xf0\xf0:WFM#00", tek_wfm::read),
];

/// What reads a file that begins so; none for files of other kinds.
fn decoder(bytes: &[u8]) -> Option<Decode> {
    let known = KINDS.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, decode)| *decode);
    // LeCroy's block stands behind the length that the remote interface sends.
    known.or_else(|| lecroy::start(bytes).map(|_| lecroy::read as Decode))
}

/// Whether a file is one of these.
pub fn recognises(bytes: &[u8]) -> bool {
    decoder(bytes).is_some()
}

/// The text of the table that a binary file holds; none for files of other kinds.
pub fn as_text(bytes: &[u8], file: &str) -> Option<Result<String, RecordingError>> {
    Some(decoder(bytes)?(bytes, file).map(|table| table.text()))
}
