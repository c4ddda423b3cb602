//! The texts that a scene is made of.

use std::fmt::Write as _;
use std::sync::Arc;

use sha2::{Digest, Sha256};

/// The scene's own text, those of the scenes and instruments it stands on, and the constants it names.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Texts(Vec<Arc<str>>);

impl Texts {
    /// Adds one.
    pub(super) fn add(&mut self, text: &Arc<str>) {
        self.0.push(Arc::clone(text));
    }

    /// SHA-256 over all of them, in hexadecimal. Computed when asked for: a run that keeps no record needs none.
    #[must_use]
    pub fn hash(&self) -> String {
        let mut hash = Sha256::new();
        for text in &self.0 {
            hash.update(text.as_bytes());
        }
        hexadecimal(&hash.finalize())
    }
}

/// Bytes such as those of a hash, two hexadecimal digits each.
#[must_use]
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a text does not fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}
