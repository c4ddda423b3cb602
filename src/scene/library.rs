//! Finds scenes and instruments by name or path, and merges each scene with its base and its
//! instruments' files.
//!
//! A name is looked up among the included files; a text with a path separator or ending in `.toml`
//! is a file, relative to the one that names it; so is one ending in `.xml`, a sensor's digital
//! calibration certificate.

use std::cell::RefCell;
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::{Arc, OnceLock};

use sha2::{Digest, Sha256};

use super::dcc;
use super::document::{ANY, Entry, Node, SourceLocation, Value, at};
use super::drive::read_samples;
use super::problem::{Problem, SceneError, did_you_mean};
use crate::data;
use crate::quantity::{self, Dimension};

/// Largest depth of bases of bases: a greater one is a mistake or a circle.
const MAX_BASE_DEPTH: usize = 8;
/// Largest file that is read as a scene or an instrument: ten thousand times the included ones
/// (bytes).
const MAX_TEXT_BYTES: u64 = 16 * 1024 * 1024;

/// How a table that is not simply merged key by key is put over what is below it.
#[derive(Clone, Copy)]
enum MergeRule {
    /// Its key `model` names a file of this folder, whose keys come below its own. Another model in
    /// a scene removes what the base's model says: half of each would be neither.
    Model(&'static str),
    /// An included file of this folder that has the table's name comes below it.
    Shipped(&'static str),
    /// It replaces that of the base as a whole.
    Whole,
    /// Only one of these keys may be set: a scene that sets one drops the base's others.
    OneOf(&'static [&'static str]),
}

/// The exceptions from merging key by key, by path. The order decides the hash of a scene's texts.
const RULES: [(&[&str], MergeRule); 9] = [
    (&["striker"], MergeRule::Model("strikers")),
    (&["scope"], MergeRule::Model("")),
    (&["materials", ANY], MergeRule::Shipped("materials")),
    (&["effects", "magnet_preload"], MergeRule::Model("magnets")),
    (&["sensors", ANY], MergeRule::Model("sensors")),
    (&["chain", "top"], MergeRule::Whole),
    (&["chain", "bottom"], MergeRule::Whole),
    (&SIGNAL, MergeRule::Whole),
    (&["drive"], MergeRule::OneOf(&["displacement", "stack"])),
];

/// Keys that name a file of constants, and its folder.
const CONSTANTS: [(&str, &str); 5] = [
    ("material", "materials"),
    ("wall", "materials"),
    ("rod", "materials"),
    ("plate", "materials"),
    ("ceramic", "piezoceramics"),
];
/// File of the scope of a scene without one.
const NO_SCOPE: &str = "default";
/// The table of a generator's signal, whose key `file` names a file of samples.
const SIGNAL: [&str; 2] = ["drive", "signal"];

/// The merged tree of a scene, and the text as typed.
#[derive(Debug, Clone)]
pub struct LoadedScene {
    /// Short name: the included name or the file's stem.
    pub name: String,
    /// The scene's own text.
    pub text: String,
    /// Every text that went into the tree.
    pub texts: Texts,
    /// The merged tree.
    pub root: Node,
    /// Instrument files that do not exist or are no TOML; an included one takes the place of each,
    /// so that the rest can be checked.
    pub problems: Vec<Problem>,
}

/// Loads scene `name`, an included one or a path.
///
/// # Errors
/// [`SceneError`] if there is no such scene or its text is no TOML.
pub fn load(name: &Path) -> Result<LoadedScene, SceneError> {
    let file = find("scenes", name, None)?.ok_or_else(|| {
        let shown = name.display().to_string();
        if name.exists() {
            return SceneError::NoScene { name: shown };
        }
        SceneError::Unknown { name: shown, shipped: data::instrument_names("scenes") }
    })?;
    let short =
        if file.path.is_some() { name.file_stem().unwrap_or_default() } else { name.as_os_str() };
    assembled(&short.to_string_lossy(), file)
}

/// Merges the scene `text`, which a recording carries as `file`, with what it is based on among the
/// included files.
///
/// # Errors
/// [`SceneError`] if the text is no TOML or its base does not exist.
pub fn load_text(name: &str, file: &str, text: &str) -> Result<LoadedScene, SceneError> {
    assembled(name, FoundFile { text: text.to_owned(), name: file.to_owned(), path: None })
}

fn assembled(name: &str, file: FoundFile) -> Result<LoadedScene, SceneError> {
    let mut library = Library { texts: Texts::default(), problems: Vec::new() };
    let mut root = library.assemble(&file, 0)?;
    library.add_scope(&mut root);
    library.add_constants(&root);
    let Library { texts, problems } = library;
    Ok(LoadedScene { name: name.to_owned(), text: file.text, texts, root, problems })
}

/// The tree of the instrument file `kind/name`, which `place` names.
///
/// # Errors
/// Problems at `place` if there is no such file, or in the file if it is no TOML.
pub fn instrument(
    kind: &str,
    name: &str,
    place: &SourceLocation,
    key: &str,
) -> Result<Rc<Node>, Vec<Problem>> {
    if let Some(node) = shipped(kind, name) {
        return Ok(node);
    }
    let missing = |found: String| {
        let names = data::instrument_names(kind);
        let meant = did_you_mean(name, &names);
        let expected = format!("one of {}, or the path of a .toml file{meant}", names.join(", "));
        vec![place.problem(key, found, expected)]
    };
    match find(kind, Path::new(name), place.folder()) {
        Ok(Some(file)) => file.parse().map(Rc::new),
        Ok(None) => Err(missing(format!("\"{name}\", which does not exist"))),
        Err(SceneError::Problems(problems)) => Err(problems),
        Err(error) => Err(missing(error.to_string())),
    }
}

/// The tree of an instrument file that a user names, by its name or path; `None` if there is no
/// such file.
///
/// # Errors
/// [`SceneError`] if it cannot be read or is no TOML.
pub fn open(kind: &str, name: &Path) -> Result<Option<Node>, SceneError> {
    let found = find(kind, name, None)?;
    found.map(|file| file.parse().map_err(SceneError::Problems)).transpose()
}

/// The tree of the file at `path`, which the command line names; `what` it is, with an example.
///
/// # Errors
/// [`SceneError`] if it does not exist, cannot be read or is no TOML.
pub fn open_file(path: &Path, what: &'static str) -> Result<Node, SceneError> {
    let name = path.display().to_string();
    if !path.is_file() {
        return Err(SceneError::NoFile { name, what });
    }
    let text = read_text(path, &name)?;
    FoundFile { text, name, path: Some(path.to_owned()) }.parse().map_err(SceneError::Problems)
}

/// Refuses a name typed at the command line that is neither an included instrument of this `kind`
/// nor a file.
///
/// # Errors
/// [`SceneError::NoInstrument`], or as reading a file.
pub fn require(kind: &'static str, name: &str) -> Result<(), SceneError> {
    if find(kind, Path::new(name), None)?.is_some() {
        return Ok(());
    }
    Err(no_instrument(kind, name))
}

/// Error for a name that is neither an included instrument nor a file.
pub(super) fn no_instrument(kind: &'static str, name: &str) -> SceneError {
    let listed = if kind.is_empty() { "scopes" } else { kind };
    let known = data::instrument_names(kind);
    SceneError::NoInstrument { listed, name: name.to_owned(), known }
}

struct Library {
    texts: Texts,
    problems: Vec<Problem>,
}

impl Library {
    /// The tree of a scene, merged with its models and its base.
    fn assemble(&mut self, file: &FoundFile, depth: usize) -> Result<Node, SceneError> {
        let mut root = file.parse().map_err(SceneError::Problems)?;
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
            return Err(wrong(format!("more than {MAX_BASE_DEPTH} scenes based on one another")));
        }
        let folder = file.path.as_ref().and_then(|path| path.parent());
        let found = find("scenes", Path::new(&base), folder).map_err(|error| match error {
            SceneError::Problems(problems) => SceneError::Problems(problems),
            error => wrong(error.to_string()),
        })?;
        let found = found.ok_or_else(|| wrong(format!("\"{base}\", which does not exist")))?;
        let mut below = self.assemble(&found, depth + 1)?;
        self.insert_models(&mut root);
        merge(&mut root, &mut below);
        Ok(root)
    }

    /// Puts a scope with nothing at its inputs into a scene without scope and sensors: a chain
    /// alone.
    fn add_scope(&mut self, root: &mut Node) {
        let sensors = ["sensors", "vibrometers", "accelerometers", "strain_gauges"];
        if sensors.iter().any(|key| at(root, &[key]).is_some()) {
            return;
        }
        let duration =
            root.text("duration").map(|(text, _)| quantity::parse(text, Dimension::TIME));
        let Some(Ok(duration)) = duration else { return };
        let text = default_scope(duration);
        let Ok(mut scope) = Node::parse(NO_SCOPE, &text) else { return };
        self.insert_models(&mut scope);
        let scope = scope.entries_mut().and_then(|entries| entries.remove("scope"));
        if let (Some(entries), Some(scope)) = (root.entries_mut(), scope) {
            entries.entry(Rc::from("scope")).or_insert(scope);
        }
    }

    /// Puts each table that names an instrument file over that file.
    fn insert_models(&mut self, root: &mut Node) {
        for (path, rule) in RULES {
            for_each(root, path, &mut Vec::new(), &mut |entry, path| match rule {
                MergeRule::Model(kind) => self.insert_model(entry, kind, path),
                MergeRule::Shipped(kind) => {
                    let name = path.last().map_or("", String::as_str);
                    if let Some(below) = shipped(kind, name) {
                        self.texts.add(below.place.text());
                        entry.node.put_over(&below);
                    }
                }
                MergeRule::Whole | MergeRule::OneOf(_) => {}
            });
        }
        for_each(root, &SIGNAL, &mut Vec::new(), &mut |entry, _| self.insert_samples(entry));
    }

    /// Puts the samples of the file that a generator's signal names in the place of its name.
    fn insert_samples(&mut self, entry: &mut Entry) {
        let Some((name, place)) = entry.node.text("file") else { return };
        let (path, place) = (place.folder().unwrap_or(Path::new("")).join(name), place.clone());
        let shown = path.display().to_string();
        let mut wrong = |found: String| {
            let expected = "a text file with a value, or time and value, in each line";
            self.problems.push(place.problem("drive.signal.file", found, expected.to_owned()));
        };
        let text = match read_text(&path, &shown) {
            Ok(text) => text,
            Err(SceneError::Problems(problems)) => return self.problems.extend(problems),
            Err(error) => return wrong(error.to_string()),
        };
        let (values, interval) = match read_samples(&text) {
            Ok(samples) => samples,
            Err(found) => return wrong(format!("{shown}, {found}")),
        };
        self.texts.add(&Arc::from(text));
        let Some(keys) = entry.node.entries_mut() else { return };
        keys.remove("file");
        let node = |value| Node { place: place.clone(), value };
        let number = |value: &f64| {
            node(Value::Number { typed: format!("{value:e}").into(), value: *value, whole: false })
        };
        let items = Value::List(Rc::new(values.iter().map(number).collect()));
        let interval = interval.map(|interval| Value::Text(format!("{interval:e} s").into()));
        for (key, value) in [("samples", Some(items)), ("interval", interval)] {
            if let Some(value) = value {
                let entry = Entry { key_place: place.clone(), node: node(value) };
                keys.insert(Rc::from(key), entry);
            }
        }
    }

    fn insert_model(&mut self, entry: &mut Entry, kind: &str, path: &[String]) {
        let Some((name, place)) = entry.node.text("model") else {
            return;
        };
        let place = place.clone();
        match instrument(kind, name, &place, &format!("{}.model", path.join("."))) {
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

    /// Adds the texts of materials and ceramics. They are looked up again by the readers of their
    /// numbers, which report files that cannot be read.
    fn add_constants(&mut self, root: &Node) {
        each_constant(root, &mut |_, _, file| self.texts.add(file.place.text()));
    }
}

/// The first included scope, for a scene without one that lasts `duration` (s): ten divisions of
/// the sequence 1, 2.5, 5 that show all of it.
fn default_scope(duration: f64) -> String {
    let bases = (-9..=0).flat_map(|decade| [1.0, 2.5, 5.0].map(|step| step * 10f64.powi(decade)));
    let base = bases.into_iter().find(|base| 10.0 * base >= duration).unwrap_or(5.0);
    let model = data::instrument_names("").first().copied().unwrap_or_default();
    format!(
        "[scope]\nmodel = \"{model}\"\ntime_base = \"{base:e} s/div\"\nposition = \"{:e} s\"\n[scope.trigger]\nsource = \"CH1\"\nlevel = \"1 V\"\nmode = \"normal\"\n[scope.ch1]\nscale = \"1 V/div\"\n",
        5.0 * base
    )
}

/// Calls `found` with folder, name and tree of each file of constants that a tree names.
pub(super) fn each_constant(node: &Node, found: &mut impl FnMut(&str, &str, &Node)) {
    let table = match &node.value {
        Value::Table(table) => table,
        Value::List(items) => return items.iter().for_each(|item| each_constant(item, found)),
        _ => return,
    };
    for (key, kind) in CONSTANTS {
        let Some((name, place)) = node.text(key) else { continue };
        // Without the problems that `instrument` finds, which take long.
        let read = || {
            let file = find(kind, Path::new(name), place.folder()).ok()??;
            file.parse().ok().map(Rc::new)
        };
        if let Some(file) = shipped(kind, name).or_else(read) {
            found(kind, name, &file);
        }
    }
    for entry in table.values() {
        each_constant(&entry.node, found);
    }
}

/// Calls `change` for every value at `path`, below `node`, with the names on the way.
fn for_each(
    node: &mut Node,
    path: &[&str],
    names: &mut Vec<String>,
    change: &mut impl FnMut(&mut Entry, &[String]),
) {
    let (Some((first, rest)), Some(entries)) = (path.split_first(), node.entries_mut()) else {
        return;
    };
    for (name, entry) in entries.iter_mut() {
        if *first == ANY || *first == &**name {
            names.push(name.to_string());
            if rest.is_empty() {
                change(entry, names);
            } else {
                for_each(&mut entry.node, rest, names, change);
            }
            names.pop();
        }
    }
}

/// Puts a scene over its base, key by key but for the [`RULES`].
fn merge(over: &mut Node, base: &mut Node) {
    for (path, rule) in RULES {
        remove_replaced(over, base, path, rule);
    }
    over.put_over(base);
}

/// Removes from `base` what a table at `path` in `over` replaces.
fn remove_replaced(over: &Node, base: &mut Node, path: &[&str], rule: MergeRule) {
    let Some((first, rest)) = path.split_first() else { return };
    let (Value::Table(over), Some(base)) = (&over.value, base.entries_mut()) else { return };
    for (name, above) in over.iter().filter(|(name, _)| *first == ANY || *first == &***name) {
        let Some(below) = base.get_mut(name) else { continue };
        match rule {
            _ if !rest.is_empty() => remove_replaced(&above.node, &mut below.node, rest, rule),
            MergeRule::Model(kind) if above.node.text("model").is_some() => {
                remove_model(&mut below.node, kind);
            }
            MergeRule::Whole => _ = base.remove(name),
            MergeRule::OneOf(keys) => remove_others(&above.node, &mut below.node, keys),
            MergeRule::Model(_) | MergeRule::Shipped(_) => {}
        }
    }
}

/// Removes from `below` those of `keys` that `above` does not set, if it sets one of them.
fn remove_others(above: &Node, below: &mut Node, keys: &[&str]) {
    let (Value::Table(above), Some(below)) = (&above.value, below.entries_mut()) else { return };
    if keys.iter().any(|key| above.contains_key(*key)) {
        below.retain(|name, _| !keys.contains(&&**name) || above.contains_key(name));
    }
}

/// Removes what the file of the table's model says; what the scene says itself stays.
fn remove_model(table: &mut Node, kind: &str) {
    let Some((model, place)) = table.text("model") else { return };
    let Ok(file) = instrument(kind, model, place, "") else { return };
    if let Some(keys) = table.entries_mut() {
        keys.retain(|_, entry| entry.node.place.file() != file.place.file());
    }
}

/// Whether the file `kind/name` is included in the program.
pub fn is_shipped(kind: &str, name: &str) -> bool {
    data::instrument(kind, name).is_some()
}

/// Removes the names of models that are not included in the program; their numbers stay.
pub fn remove_other_models(root: &mut Node) {
    for (path, rule) in RULES {
        let MergeRule::Model(kind) = rule else { continue };
        for_each(root, path, &mut Vec::new(), &mut |entry, _| {
            let is_other =
                entry.node.text("model").is_some_and(|(name, _)| !is_shipped(kind, name));
            if let Some(entries) = entry.node.entries_mut().filter(|_| is_other) {
                entries.remove("model");
            }
        });
    }
}

/// Replaces the model of the table that `keys` without the last lead to, if they lead to the
/// `model` of one; the scene's own keys stay.
///
/// # Errors
/// As [`instrument`].
pub(super) fn replace_model(
    root: &mut Node,
    keys: &[&str],
    model: &Node,
) -> Result<(), Vec<Problem>> {
    let (Some(("model", table)), Value::Text(name)) =
        (keys.split_last().map(|(last, table)| (*last, table)), &model.value)
    else {
        return Ok(());
    };
    let is_at = |path: &[&str]| {
        path.len() == table.len() && path.iter().zip(table).all(|(p, key)| *p == ANY || p == key)
    };
    let rule = RULES.iter().find(|(path, _)| is_at(path)).map(|(_, rule)| *rule);
    let Some(MergeRule::Model(kind)) = rule else { return Ok(()) };
    let file = instrument(kind, name, &model.place, &keys.join("."))?;
    if let Some(table) = super::document::at_mut(root, table) {
        remove_model(table, kind);
        table.put_over(&file);
    }
    Ok(())
}

/// An included instrument of this kind: without one, every key of a missing file would be missing
/// as well.
fn stand_in(kind: &str) -> Option<Rc<Node>> {
    shipped(kind, data::instrument_names(kind).first()?)
}

/// A file that was found.
struct FoundFile {
    text: String,
    /// Its name in problems.
    name: String,
    /// None of an included one.
    path: Option<PathBuf>,
}

impl FoundFile {
    fn parse(&self) -> Result<Node, Vec<Problem>> {
        Node::parse_file(&self.name, self.path.clone(), &self.text)
    }
}

/// The file `name` of folder `kind`, or at a path relative to `folder`; `None` if there is none.
fn find(kind: &str, name: &Path, folder: Option<&Path>) -> Result<Option<FoundFile>, SceneError> {
    let plain = name.to_str().filter(|name| {
        let extension = Path::new(name).extension();
        !name.contains(['/', '\\']) && extension.is_none_or(|e| e != "toml" && e != "xml")
    });
    if let Some(name) = plain {
        return Ok(data::instrument(kind, name).map(|text| FoundFile {
            text: text.to_owned(),
            name: shipped_file(kind, name),
            path: None,
        }));
    }
    let path = folder.map_or_else(|| name.to_owned(), |folder| folder.join(name));
    let shown = path.display().to_string();
    let mut text = read_text(&path, &shown)?;
    if kind == "sensors" && path.extension().is_some_and(|extension| extension == "xml") {
        text = dcc::sensor_text(&text).map_err(
            |dcc::Unusable { line, column, found, expected }| {
                let (file, expected) = (shown.clone(), expected.to_owned());
                let key = String::new();
                SceneError::Problems(vec![Problem { file, line, column, key, found, expected }])
            },
        )?;
    }
    Ok(Some(FoundFile { text, name: shown, path: Some(path) }))
}

/// Name of an included file in problems.
fn shipped_file(kind: &str, name: &str) -> String {
    let folder = if kind.is_empty() { "" } else { "/" };
    ["instruments/", kind, folder, name, ".toml"].concat()
}

thread_local! {
    /// The included instruments that have been read: a sweep reads the same few thousands of times,
    /// and parsing them costs more than anything else about a scene.
    static SHIPPED: RefCell<Vec<Shipped>> = const { RefCell::new(Vec::new()) };
}

/// An instrument's folder, name and tree.
struct Shipped {
    kind: String,
    name: String,
    node: Rc<Node>,
}

/// The tree of the included instrument `kind/name`; `None` if there is no such one, or if `name` is
/// a path.
fn shipped(kind: &str, name: &str) -> Option<Rc<Node>> {
    if name.contains(['/', '\\']) {
        return None;
    }
    let is_it = |known: &&Shipped| known.name == name && known.kind == kind;
    let node_of = |known: &Shipped| Rc::clone(&known.node);
    if let Some(node) = SHIPPED.with_borrow(|known| known.iter().find(is_it).map(node_of)) {
        return Some(node);
    }
    let text = data::instrument(kind, name)?;
    let node = Rc::new(Node::parse(&shipped_file(kind, name), text).ok()?);
    let (kind, name) = (kind.to_owned(), name.to_owned());
    let shipped = Shipped { kind, name, node: Rc::clone(&node) };
    SHIPPED.with_borrow_mut(|known| known.push(shipped));
    Some(node)
}

/// The file's text; bytes that are no UTF-8 are a problem at their place.
fn read_text(path: &Path, file: &str) -> Result<String, SceneError> {
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

/// The texts of a scene, of its bases and instruments, and of the constants it names.
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
    fn add(&mut self, text: &Arc<str>) {
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

    /// SHA-256 over all of them, in hexadecimal; computed on first use, since a run that keeps no
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
