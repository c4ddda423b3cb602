//! Scenes, calibration plans, laboratories and sweeps: text of any kind is read or refused, and a
//! refusal is short and holds no control characters.
//!
//! The first byte says what the text is.

#![cfg_attr(not(test), no_main)]

use std::path::PathBuf;

use hertzscope::scene::grid::Design;
use hertzscope::scene::{Scene, SceneError, plan};

/// Longest refusal: 101 problems (bytes).
const MAX_REFUSAL: usize = 1 << 20;

/// A file of this thread's own.
fn file() -> PathBuf {
    let (process, thread) = (std::process::id(), std::thread::current().id());
    std::env::temp_dir().join(format!("hertzscope-settings-{process}-{thread:?}.toml"))
}

/// One input.
pub fn run(input: &[u8]) {
    let Some((kind, text)) = input.split_first() else { return };
    let refused: Option<SceneError> = if let (b's', Ok(text)) = (kind, std::str::from_utf8(text)) {
        Scene::from_text("fuzz", "fuzz.toml", text).err()
    } else {
        let file = file();
        std::fs::write(&file, text).expect("a file");
        let found = match kind {
            b'p' => plan::load(&file).err(),
            b'l' => plan::lab::load(Some(&file)).err(),
            b'g' => Design::load(&file).err(),
            _ => Scene::load(&file).err(),
        };
        let _ = std::fs::remove_file(&file);
        found
    };
    if let Some(refused) = refused {
        let told = refused.to_string();
        assert!(told.len() < MAX_REFUSAL, "{} bytes", told.len());
        let is_control = |character: char| character.is_control() && character != '\n';
        assert!(!told.contains(is_control), "{told:?}");
    }
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
