//! The texts that a scene is made of.

use std::fmt::Write as _;
use std::sync::{Arc, OnceLock};

use sha2::{Digest, Sha256};

/// The scene's own text, those of the scenes and instruments it stands on, and the constants it names.
#[derive(Debug, Clone, Default)]
pub struct Texts {
    all: Vec<Arc<str>>,
    /// Their hash, computed on first use.
    hash: OnceLock<String>,
}

impl PartialEq for Texts {
    fn eq(&self, other: &Self) -> bool {
        self.all == other.all
    }
}

impl Texts {
    /// Adds one.
    pub(super) fn add(&mut self, text: &Arc<str>) {
        self.all.push(Arc::clone(text));
        self.hash = OnceLock::new();
    }

    /// SHA-256 over all of them, in hexadecimal. Computed when first asked for: a run that keeps no record needs none.
    pub fn hash(&self) -> &str {
        self.hash.get_or_init(|| {
            let mut hash = Sha256::new();
            self.all.iter().for_each(|text| hash.update(text.as_bytes()));
            hexadecimal(&hash.finalize())
        })
    }
}

/// Bytes such as those of a hash, two hexadecimal digits each.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a text does not fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}
