//! Texts and trees of the files that scenes stand on.

use std::cell::RefCell;
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::Path;
use std::rc::Rc;
use std::sync::{Arc, OnceLock};

use sha2::{Digest, Sha256};

use super::document::Node;
use super::problem::{Problem, SceneError};
use crate::data;

/// Largest file that is read as a scene or an instrument: ten thousand times what ships (bytes).
const MAX_TEXT_BYTES: u64 = 16 * 1024 * 1024;

thread_local! {
    /// The instruments that ship and have been read: a sweep reads the same few thousands of times,
    /// and parsing them costs more than anything else about a scene.
    static SHIPPED: RefCell<Vec<Shipped>> = const { RefCell::new(Vec::new()) };
}

/// An instrument's folder, name and tree.
struct Shipped {
    kind: String,
    name: String,
    node: Rc<Node>,
}

/// The tree of the instrument `kind/name` that ships with the program; none if there is no such
/// one, or if `name` is a path.
pub(super) fn shipped(kind: &str, name: &str) -> Option<Rc<Node>> {
    if name.contains(['/', '\\']) {
        return None;
    }
    let is_it = |known: &&Shipped| known.name == name && known.kind == kind;
    let node_of = |known: &Shipped| Rc::clone(&known.node);
    if let Some(node) = SHIPPED.with_borrow(|known| known.iter().find(is_it).map(node_of)) {
        return Some(node);
    }
    let text = data::instrument(kind, name)?;
    let folder = if kind.is_empty() { "" } else { "/" };
    let file = ["instruments/", kind, folder, name, ".toml"].concat();
    let node = Rc::new(Node::parse(&file, text).ok()?);
    let (kind, name) = (kind.to_owned(), name.to_owned());
    let shipped = Shipped { kind, name, node: Rc::clone(&node) };
    SHIPPED.with_borrow_mut(|known| known.push(shipped));
    Some(node)
}

/// The file's text; what is no UTF-8 is a problem at its place.
pub(super) fn read_text(path: &Path, file: &str) -> Result<String, SceneError> {
    let failed = |source| SceneError::Read { file: file.to_owned(), source };
    let mut bytes = Vec::new();
    let opened = std::fs::File::open(path).map_err(failed)?;
    opened.take(MAX_TEXT_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MAX_TEXT_BYTES {
        return Err(SceneError::TooLarge { file: file.to_owned(), limit: MAX_TEXT_BYTES });
    }
    String::from_utf8(bytes).map_err(|error| {
        let sound = error.utf8_error().valid_up_to();
        let before = String::from_utf8_lossy(error.as_bytes().get(..sound).unwrap_or_default());
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        SceneError::Problems(vec![Problem {
            file: file.to_owned(),
            line: before.matches('\n').count() + 1,
            column,
            key: String::new(),
            found: format!("byte 0x{:02x}", error.as_bytes().get(sound).copied().unwrap_or(0)),
            expected: "text in UTF-8".to_owned(),
        }])
    })
}

/// Texts of the scene, of the scenes and instruments that it is based on, and of the constants that
/// it names.
#[derive(Debug, Clone, Default)]
pub struct Texts {
    all: Vec<Arc<str>>,
    /// Their hash, computed on first use.
    hash: OnceLock<String>,
    /// All of them merged, as one scene.
    merged: Option<Arc<str>>,
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

    /// All of them merged, as a scene that is based on no other file; none of a scene whose values
    /// were changed after it was read.
    pub fn merged(&self) -> Option<&str> {
        self.merged.as_deref()
    }

    /// Sets the merged scene.
    pub(super) fn set_merged(&mut self, merged: Option<&str>) {
        self.merged = merged.map(Into::into);
    }

    /// SHA-256 over all of them, in hexadecimal. Computed when first asked for: a run that keeps no
    /// record needs none.
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
