//! Finds scenes and instruments by name or path, and puts each on what it stands on.
//!
//! A name is looked up among the embedded files; a text with a path separator or ending in `.toml`
//! is a file, relative to the one that names it.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::document::{Entry, Node, SourceLocation, Value};
use super::files::Texts;
use super::files::{read_text, shipped};
use super::problem::{Problem, SceneError, did_you_mean};
use super::tree::{at, at_mut};
use crate::data;

/// A scene may stand on a scene that stands on a scene; deeper is a mistake or a circle.
const MAX_BASE_DEPTH: usize = 8;

/// Tables that may name an instrument file in `model`, and the folder it lies in.
const MODELS: [(&str, &str); 3] =
    [("striker", "strikers"), ("scope", ""), ("magnet_preload", "magnets")];

/// Keys that name a file of constants, and the folder it lies in.
const CONSTANTS: [(&str, &str); 3] =
    [("material", "materials"), ("wall", "materials"), ("ceramic", "piezoceramics")];

/// The ends of a chain.
const ENDS: [&str; 2] = ["top", "bottom"];

/// Where a file was found.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Origin {
    Embedded,
    File(PathBuf),
}

/// A scene's tree with everything it stands on, and the text as typed.
#[derive(Debug, Clone)]
pub struct LoadedScene {
    /// Short name: the embedded name or the file's stem.
    pub name: String,
    /// The scene's own text.
    pub text: String,
    /// Every text that went into the tree.
    pub texts: Texts,
    /// The merged tree.
    pub root: Node,
    /// Instrument files that are not there or no TOML; one that ships stands in for each, so that
    /// the rest can be checked.
    pub problems: Vec<Problem>,
}

/// Loads scene `name`, an embedded one or a path.
///
/// # Errors
/// [`SceneError`] when there is no such scene or its text is no TOML.
pub fn load(name: &str) -> Result<LoadedScene, SceneError> {
    let (text, file, origin) = find("scenes", name, &Origin::Embedded)?.ok_or_else(|| {
        if Path::new(name).exists() {
            return SceneError::NoScene { name: name.to_owned() };
        }
        SceneError::Unknown { name: name.to_owned(), shipped: data::instrument_names("scenes") }
    })?;
    let stem = Path::new(name).file_stem().and_then(|s| s.to_str()).unwrap_or(name);
    let short = if origin == Origin::Embedded { name } else { stem };
    assembled(short, text, &file, &origin)
}

/// Puts the scene `text`, which a recording carries as `file`, on what it stands on among the
/// embedded files.
///
/// # Errors
/// [`SceneError`] when the text is no TOML or stands on what is not there.
pub fn load_text(name: &str, file: &str, text: &str) -> Result<LoadedScene, SceneError> {
    assembled(name, text.to_owned(), file, &Origin::Embedded)
}

fn assembled(
    name: &str,
    text: String,
    file: &str,
    origin: &Origin,
) -> Result<LoadedScene, SceneError> {
    let mut library = Library { texts: Texts::default(), problems: Vec::new() };
    let root = library.assemble(&text, file, origin, 0)?;
    library.add_constants(&root);
    let Library { texts, problems } = library;
    Ok(LoadedScene { name: name.to_owned(), text, texts, root, problems })
}

/// The tree of the instrument file `kind/name`, which `place` names.
///
/// # Errors
/// Problems at `place` when there is no such file, or in the file when it is no TOML.
pub fn instrument(
    kind: &str,
    name: &str,
    place: &SourceLocation,
    key: &str,
) -> Result<Rc<Node>, Vec<Problem>> {
    if let Some(node) = shipped(kind, name) {
        return Ok(node);
    }
    let origin = origin_of(place);
    let missing = |found: String| {
        let names = data::instrument_names(kind);
        let meant = did_you_mean(name, &names);
        let expected = format!("one of {}, or the path of a .toml file{meant}", names.join(", "));
        vec![place.problem(key, found, expected)]
    };
    match find(kind, name, &origin) {
        Ok(Some((text, file, _))) => Node::parse(&file, &text).map(Rc::new),
        Ok(None) => Err(missing(format!("\"{name}\", which does not exist"))),
        Err(SceneError::Problems(problems)) => Err(problems),
        Err(error) => Err(missing(error.to_string())),
    }
}

/// The tree of an instrument file that a user names, by its name or path; none if there is no such
/// file.
///
/// # Errors
/// [`SceneError`] when it cannot be read or is no TOML.
pub fn open(kind: &str, name: &str) -> Result<Option<Node>, SceneError> {
    let found = find(kind, name, &Origin::Embedded)?;
    found.map(|(text, file, _)| Node::parse(&file, &text).map_err(SceneError::Problems)).transpose()
}

/// Refuses a name typed at the command line that is neither an included instrument of this `kind`
/// nor a file.
///
/// # Errors
/// [`SceneError::NoInstrument`], or as reading a file.
pub fn require(kind: &'static str, name: &str) -> Result<(), SceneError> {
    if find(kind, name, &Origin::Embedded)?.is_some() {
        return Ok(());
    }
    let listed = if kind.is_empty() { "scopes" } else { kind };
    let known = data::instrument_names(kind);
    Err(SceneError::NoInstrument { listed, name: name.to_owned(), known })
}

struct Library {
    texts: Texts,
    problems: Vec<Problem>,
}

impl Library {
    fn assemble(
        &mut self,
        text: &str,
        file: &str,
        origin: &Origin,
        depth: usize,
    ) -> Result<Node, SceneError> {
        let mut root = Node::parse(file, text).map_err(SceneError::Problems)?;
        self.texts.add(root.place.text());
        let Some((base, place)) = root.text("base").map(|(b, p)| (b.to_owned(), p.clone())) else {
            self.insert_models(&mut root);
            return Ok(root);
        };
        let wrong = |found: String| {
            let expected = format!(
                "one of {}, or the path of a scene",
                data::instrument_names("scenes").join(", ")
            );
            SceneError::Problems(vec![place.problem("base", found, expected)])
        };
        if depth >= MAX_BASE_DEPTH {
            return Err(wrong(format!(
                "more than {MAX_BASE_DEPTH} scenes standing on one another"
            )));
        }
        let found = find("scenes", &base, origin).map_err(|error| match error {
            SceneError::Problems(problems) => SceneError::Problems(problems),
            error => wrong(error.to_string()),
        })?;
        let (base_text, base_file, base_origin) =
            found.ok_or_else(|| wrong(format!("\"{base}\", which does not exist")))?;
        let below = self.assemble(&base_text, &base_file, &base_origin, depth + 1)?;
        // Models go in before merging, so that naming another model replaces all the first one
        // said.
        self.insert_models(&mut root);
        let mut below = below;
        remove_replaced_models(&root, &mut below);
        remove_replaced_ends(&root, &mut below);
        root.put_over(&below);
        Ok(root)
    }

    /// Adds the texts of materials and ceramics. They are looked up again where their numbers are
    /// read.
    fn add_constants(&mut self, node: &Node) {
        let table = match &node.value {
            Value::Table(table) => table,
            Value::List(items) => return items.iter().for_each(|item| self.add_constants(item)),
            _ => return,
        };
        for (key, kind) in CONSTANTS {
            let Some((name, place)) = node.text(key) else { continue };
            // The reader of the numbers reports files that cannot be read.
            if let Ok(file) = instrument(kind, name, place, key) {
                self.texts.add(file.place.text());
            }
        }
        for entry in table.values() {
            self.add_constants(&entry.node);
        }
    }

    /// Puts each table that names an instrument file on top of that file.
    fn insert_models(&mut self, root: &mut Node) {
        let Some(top) = root.entries_mut() else { return };
        for (key, kind) in MODELS {
            if let Some(entry) = top.get_mut(key) {
                self.insert_model(entry, kind, key);
            }
        }
        // A scene's own material changes what it says of one that ships under the same name.
        if let Some(materials) = top.get_mut("materials").and_then(|e| e.node.entries_mut()) {
            for (name, entry) in materials.iter_mut() {
                if let Some(below) = shipped("materials", name) {
                    self.texts.add(below.place.text());
                    entry.node.put_over(&below);
                }
            }
        }
        if let Some(effects) = top.get_mut("effects").and_then(|e| e.node.entries_mut()) {
            for (key, kind) in MODELS {
                if let Some(entry) = effects.get_mut(key) {
                    self.insert_model(entry, kind, &format!("effects.{key}"));
                }
            }
        }
        if let Some(sensors) = top.get_mut("sensors").and_then(|e| e.node.entries_mut()) {
            for (name, entry) in sensors.iter_mut() {
                self.insert_model(entry, "sensors", &format!("sensors.{name}"));
            }
        }
    }

    fn insert_model(&mut self, entry: &mut Entry, kind: &str, path: &str) {
        let Some((name, place)) = entry.node.text("model") else {
            return;
        };
        let place = place.clone();
        match instrument(kind, name, &place, &format!("{path}.model")) {
            Ok(below) => {
                self.texts.add(below.place.text());
                entry.node.put_over(&below);
            }
            Err(found) => {
                self.problems.extend(found);
                if let Some(below) = stand_in(kind) {
                    entry.node.put_over(&below);
                }
            }
        }
    }
}

/// Takes away what the model of a sensor or magnet said below where another model is named above:
/// half of each would be neither.
fn remove_replaced_models(above: &Node, below: &mut Node) {
    let child = |node: &Node, key: &str| match &node.value {
        Value::Table(table) => table.get(key).map(|entry| entry.node.clone()),
        _ => None,
    };
    for (folder, kind, only) in
        [("sensors", "sensors", None), ("effects", "magnets", Some("magnet_preload"))]
    {
        let Some(above) = child(above, folder) else { continue };
        let Some(below) = below.entries_mut().and_then(|b| b.get_mut(folder)) else { continue };
        let Some(below) = below.node.entries_mut() else { continue };
        for (name, entry) in below.iter_mut().filter(|(name, _)| only.is_none_or(|o| o == &***name))
        {
            if child(&above, name).and_then(|node| node.text("model").map(|_| ())).is_some() {
                remove_model(&mut entry.node, kind);
            }
        }
    }
}

/// Takes away the ends of the chain below that are others above: half of each would be neither.
fn remove_replaced_ends(above: &Node, below: &mut Node) {
    let (Some(above), Some(below)) = (at(above, &["chain"]), at_mut(below, &["chain"])) else {
        return;
    };
    if let Some(ends) = below.entries_mut() {
        ends.retain(|key, _| !ENDS.contains(&&**key) || at(above, &[key]).is_none());
    }
}

/// Takes away what the model said that this table names, so that another's can take its place; what
/// the scene says itself stays.
pub fn remove_model(table: &mut Node, kind: &str) {
    let Some((model, place)) = table.text("model") else { return };
    let Ok(file) = instrument(kind, model, place, "") else { return };
    if let Some(keys) = table.entries_mut() {
        keys.retain(|_, entry| entry.node.place.file() != file.place.file());
    }
}

/// Whether the file `kind/name` ships with the program.
pub fn is_shipped(kind: &str, name: &str) -> bool {
    data::instrument(kind, name).is_some()
}

/// Takes away the names of models that do not ship with the program; their numbers stay.
pub fn remove_other_models(root: &mut Node) {
    let remove = |table: Option<&mut Node>, kind: &str| {
        let Some(table) = table else { return };
        let is_other = table.text("model").is_some_and(|(name, _)| !is_shipped(kind, name));
        if let Some(entries) = table.entries_mut().filter(|_| is_other) {
            entries.remove("model");
        }
    };
    for (key, kind) in MODELS {
        remove(at_mut(root, &[key]), kind);
        remove(at_mut(root, &["effects", key]), kind);
    }
    if let Some(sensors) = at_mut(root, &["sensors"]).and_then(Node::entries_mut) {
        for entry in sensors.values_mut() {
            remove(Some(&mut entry.node), "sensors");
        }
    }
}

/// An instrument of this kind that ships: without one, every key of a missing file would be missing
/// as well.
fn stand_in(kind: &str) -> Option<Node> {
    let name = *data::instrument_names(kind).first()?;
    Node::parse(name, data::instrument(kind, name)?).ok()
}

/// Where the file of `place` lies, so that paths in it can be relative.
fn origin_of(place: &SourceLocation) -> Origin {
    let path = Path::new(place.file());
    if path.exists() { Origin::File(path.to_owned()) } else { Origin::Embedded }
}

/// Text, display name and origin of `name` in folder `kind`; `None` if there is none.
fn find(
    kind: &str,
    name: &str,
    from: &Origin,
) -> Result<Option<(String, String, Origin)>, SceneError> {
    let looks_like_path =
        name.contains(['/', '\\']) || Path::new(name).extension().is_some_and(|e| e == "toml");
    if !looks_like_path {
        let text = data::instrument(kind, name);
        let shown =
            if kind.is_empty() { format!("{name}.toml") } else { format!("{kind}/{name}.toml") };
        return Ok(
            text.map(|text| (text.to_owned(), format!("instruments/{shown}"), Origin::Embedded))
        );
    }
    let path = match from {
        Origin::File(file) => file.parent().unwrap_or(Path::new("")).join(name),
        Origin::Embedded => PathBuf::from(name),
    };
    let file = path.display().to_string();
    let text = read_text(&path, &file)?;
    Ok(Some((text, file, Origin::File(path))))
}
