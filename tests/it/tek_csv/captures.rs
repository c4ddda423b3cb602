//! Whole captures, where the environment variable `HERTZSCOPE_CAPTURES` names their folder.

use std::path::Path;

use hertzscope::recording::tek_csv::{read, write};

/// Files that instruments of the family saved themselves.
pub(crate) const NATIVE_CAPTURES: [&str; 12] = [
    "fft-tds1012c-edu-F0022MTH.CSV",
    "tbs1022-v26.02-F0000CH1.CSV",
    "tbs1062-v26.01-CH1.CSV",
    "tbs1072b-scan-F0000CH1.CSV",
    "tds1001b-v22.11-TEK0000.CSV",
    "tds1012b-clipped-F0001CH2.CSV",
    "tds2002b-v21.20-F0000CH1.CSV",
    "tds2002c-v24.17-TEK0001.CSV",
    "tds2004c-v24.26-F0001CH1.CSV",
    "tds2004c-v24.26-F0001CH3.CSV",
    "tds2022b-v22.01-F0000CH1.CSV",
    "tds2024c-v24.09-F0001CH1.CSV",
];

#[test]
#[ignore = "needs HERTZSCOPE_CAPTURES"]
fn native_captures_come_back_byte_for_byte() {
    let folder = std::env::var_os("HERTZSCOPE_CAPTURES").expect("the folder of captures");
    for name in NATIVE_CAPTURES {
        let path = Path::new(&folder).join(name);
        let bytes =
            std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let capture = read(&bytes, name).expect("a native file");
        // The file of a scan tells another trigger point than its times.
        assert!(capture.notes.iter().all(|note| note.starts_with("the file calls")), "{name}");
        let text = write(&capture).expect("what was read can be written");
        let stored = String::from_utf8(bytes).expect("text");
        for (number, (found, expected)) in text.lines().zip(stored.lines()).enumerate() {
            assert_eq!(found, expected, "{name}, row {}", number + 1);
        }
        assert_eq!(text, stored, "{name}");
    }
}
