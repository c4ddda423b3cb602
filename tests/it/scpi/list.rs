//! The table of commands, and the document made from it.

use hertzscope::scpi::list::markdown;
use hertzscope::scpi::table::Support;
use hertzscope::scpi::tree;

/// A change detector: the document is made from the table. `HERTZSCOPE_WRITE=1` writes it instead
/// of comparing.
#[test]
fn the_document_is_the_table() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/scpi-commands.md");
    if std::env::var_os("HERTZSCOPE_WRITE").is_some() {
        std::fs::write(&path, markdown()).expect("the document is written");
    }
    let document = std::fs::read_to_string(&path).expect("docs/scpi-commands.md");
    assert_eq!(document, markdown(), "docs/scpi-commands.md lags behind the table");
}

/// Every row is reached by its full header and by its short one.
#[test]
fn every_row_is_found_by_its_own_header() {
    for row in tree::rows() {
        let header =
            row.header.replace("<wfm>", "MATH").replace("REF<x>", "REFB").replace("<x>", "2");
        let short = |word: &str| word.trim_end_matches(|c: char| c.is_ascii_lowercase()).to_owned();
        let full: Vec<String> = header.split(':').map(str::to_ascii_uppercase).collect();
        let shortened: Vec<String> = header.split(':').map(short).collect();
        let expected = match row.support {
            Support::Alias(of) => of,
            _ => row.header,
        };
        for words in [full, shortened] {
            let found = tree::find(&words, 4).unwrap_or_else(|| panic!("{words:?} is not found"));
            assert_eq!(found.row.header, expected, "{words:?}");
        }
    }
}

#[test]
fn a_model_with_two_channels_has_two() {
    let words = |text: &str| text.split(':').map(str::to_owned).collect::<Vec<String>>();
    assert!(tree::find(&words("CH2:SCA"), 2).is_some());
    assert!(tree::find(&words("CH3:SCA"), 2).is_none());
    assert!(tree::find(&words("WFMP:CH3:YOF"), 2).is_none());
}
