//! `show` prints the same scene again; the annotated scene and the annotated plan have every key
//! that the program reads.

use std::collections::BTreeSet;
use std::path::Path;

use hertzscope::scene::help::annotated;
use hertzscope::scene::plan;
use hertzscope::scene::{Problem, Scene, SceneError};

use super::{BENCH, problems};

fn annotated_scene() -> String {
    annotated("scene").expect("a page")
}

fn annotated_plan() -> String {
    annotated("plan").expect("a page")
}

/// A key that no table has: the problem that it makes names all that the table has.
const UNKNOWN: &str = "zzz = 1";

fn same(name: &str) {
    let scene = Scene::load(name).unwrap_or_else(|error| panic!("{name}: {error}"));
    let text = Scene::resolved(name).unwrap_or_else(|error| panic!("{name}: {error}"));
    let again = Scene::from_text(&scene.name, "shown.toml", &text);
    let again = again.unwrap_or_else(|error| panic!("{name}: {error}\n{text}"));
    let as_if = Scene {
        text: scene.text.clone(),
        texts: scene.texts.clone(),
        uncertainty: scene.uncertainty.clone(),
        ..again.clone()
    };
    assert_eq!(as_if, scene, "{name}\n{text}");
    let paths = |scene: &Scene| -> BTreeSet<String> {
        scene
            .uncertainty
            .iter()
            .map(|input| format!("{} {:?}", input.path, input.distribution))
            .collect()
    };
    assert_eq!(paths(&again), paths(&scene), "{name}\n{text}");
}

#[test]
fn what_is_shown_is_the_same_scene() {
    for name in Scene::names() {
        same(name);
    }
    let folder = tempfile::tempdir().expect("a folder");
    let own = "base = \"magnet-0.61g\"\n[striker]\nspeed = \"0.6 m/s\"\n[effects]\nscope_noise = false\n[materials.ptfe]\nyoungs_modulus = \"1.5 GPa\"\n";
    for (name, text) in
        [("all.toml", annotated_scene().as_str()), ("bench.toml", BENCH), ("own.toml", own)]
    {
        let file = folder.path().join(name);
        std::fs::write(&file, text).expect("a file");
        same(file.to_str().expect("a path"));
    }
    let shown =
        Scene::resolved(folder.path().join("own.toml").to_str().expect("a path")).expect("a scene");
    // What stands where: typed, from a file, by default.
    let line =
        |key: &str| shown.lines().find(|line| line.starts_with(key)).expect("a line").to_owned();
    assert_eq!(line("speed = "), "speed = \"0.6 m/s\"");
    assert!(line("mass = ").contains("# instruments/"), "{}", line("mass = "));
    assert!(line("probe = ").ends_with("# default"), "{}", line("probe = "));
    assert!(shown.contains("scope_noise = false") && !shown.contains("\nbase ="), "{shown}");
}

/// `particles.bead.diameter` as `particles.*`, without the key.
fn table_of(path: &str) -> String {
    let is_item = |part: &&str| part.parse::<usize>().is_ok();
    let mut parts: Vec<String> =
        path.split('.').filter(|part| !is_item(part)).map(str::to_owned).collect();
    parts.pop();
    if let ["particles" | "materials" | "sensors", _, ..] =
        parts.iter().map(String::as_str).collect::<Vec<_>>()[..]
    {
        "*".clone_into(&mut parts[1]);
    }
    if parts.len() > 1 && parts[0] == "scope" && parts[1].starts_with("ch") {
        "ch1".clone_into(&mut parts[1]);
    }
    parts.join(".")
}

/// Keys of an annotated file as `table key`, those of lines that are commented out included.
fn documented(text: &str) -> BTreeSet<(String, String)> {
    let mut found = BTreeSet::new();
    let mut table = String::new();
    for line in text.lines() {
        let line = line.strip_prefix("# ").unwrap_or(line);
        if let Some((path, _)) = line.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            let path = path.trim_start_matches('[');
            table = table_of(&format!("{path}.key"));
            // The table is a key of the one above.
            if let Some((above, key)) = path.rsplit_once('.') {
                found.insert((table_of(&format!("{above}.key")), key.to_owned()));
            }
            let top = path.split('.').next().unwrap_or_default();
            found.insert((String::new(), top.to_owned()));
            continue;
        }
        let Some((key, rest)) = line.split_once(" = ") else { continue };
        if !key.contains(' ') {
            found.insert((table.clone(), key.to_owned()));
        }
        // Keys of a table on one line.
        if let Some((inner, _)) = rest.strip_prefix("{ ").and_then(|rest| rest.split_once(" }")) {
            for pair in inner.split(", ").filter_map(|pair| pair.split_once(" = ")) {
                let below = table_of(&format!(
                    "{}{key}.key",
                    if table.is_empty() { String::new() } else { format!("{table}.") }
                ));
                found.insert((below, pair.0.to_owned()));
            }
        }
    }
    found
}

/// Every key that `problems` name as known, as `table key`.
fn known(problems: &[Problem]) -> BTreeSet<(String, String)> {
    let unknown = problems.iter().filter(|problem| problem.found.contains("unknown key `zzz`"));
    let keys = |problem: &Problem| {
        let table = table_of(&problem.key);
        let keys = problem.expected.strip_prefix("one of ").unwrap_or_default().to_owned();
        keys.split(", ").map(|key| (table.clone(), key.to_owned())).collect::<Vec<_>>()
    };
    unknown.flat_map(keys).filter(|(_, key)| !key.is_empty()).collect()
}

/// The text with an unknown key at its top and in every table.
fn with_unknown(text: &str) -> String {
    let line = |line: &str| {
        if line.starts_with('[') { format!("{line}\n{UNKNOWN}\n") } else { format!("{line}\n") }
    };
    let inner = text.replace("force = \"1.2 N\" }", "force = \"1.2 N\", zzz = 1 }");
    let inner = inner.replace("to = \"5 mm\" }", "to = \"5 mm\", zzz = 1 }");
    let lines: String = inner.lines().map(line).collect();
    format!("{UNKNOWN}\n{lines}")
}

/// Keys of files of instruments, which a scene may replace: `list scopes` and `list magnets` show
/// them.
fn of_instruments(table: &str, key: &str) -> bool {
    let folder = match table.split('.').collect::<Vec<_>>()[..] {
        ["scope", ..] => "",
        ["effects", "magnet_preload", ..] => "magnets",
        _ => return false,
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("instruments").join(folder);
    let files = std::fs::read_dir(root).expect("a folder");
    let texts = files.filter_map(|file| std::fs::read_to_string(file.expect("a file").path()).ok());
    let begins = |text: String| {
        let is_key = |line: &str| {
            line.starts_with(&format!("{key} =")) || line.starts_with(&format!("[{key}]"))
        };
        text.lines().any(is_key)
    };
    texts.into_iter().any(begins) || key == "measured"
}

#[test]
fn the_annotated_scene_has_every_key() {
    let all = documented(&annotated_scene());
    let per_effect = |key: &str| all.contains(&("effects.NAME".to_owned(), key.to_owned()));
    let others = [
        (
            "[effects.magnet_preload]",
            "model = \"ring-15-6-6\"\nparticle = 1\ndistance = \"0.4 mm\"\n[effects.magnet_law]\n",
        ),
        (
            "[effects.kuwabara_kono]",
            "eta = \"0.1 us\"\nend_of_contact = \"zero_overlap\"\n[[effects.kuwabara_kono.contacts]]\nbetween = [\"bead\", \"light\"]\neta = \"0.1 us\"\n",
        ),
        (
            "[effects.power_law_loss]",
            "force_at_1_m_per_s = \"1 N\"\nexponent = 1.5\nend_of_contact = \"zero_overlap\"\n",
        ),
        ("[effects]", ""),
        ("[effects.linearised_contacts]", ""),
        ("[scope.external]", "input = \"first\"\n"),
        ("[[initial_velocities]]", "particle = 1\nvelocity = \"0.1 m/s\"\n"),
    ];
    let more: Vec<String> = others.iter().map(|(head, body)| format!("{head}\n{body}")).collect();
    let more = more.concat();
    let text = format!(
        "{}\n{more}",
        annotated_scene().replace(
            "\ntop = { force = \"1.2 N\" }",
            "\ntop = { wall = \"steel_52100\", preload = \"1 N\", zzz = 1 }"
        )
    );
    let mut known = known(&problems(&with_unknown(&annotated_scene())));
    known.extend(self::known(&problems(&with_unknown(&text))));
    let tables: BTreeSet<&str> = known.iter().map(|(table, _)| table.as_str()).collect();
    for table in [
        "",
        "particles.*",
        "materials.*",
        "chain",
        "chain.segments",
        "chain.segments.diameter",
        "chain.top",
        "striker",
        "initial_velocities",
        "sensors.*",
        "scope",
        "scope.trigger",
        "scope.ch1",
        "scope.external",
        "effects",
        "effects.dashpot",
        "effects.kuwabara_kono",
        "effects.kuwabara_kono.contacts",
        "effects.power_law_loss",
        "effects.magnet_preload",
        "effects.sensor_tolerance",
    ] {
        assert!(tables.contains(table), "`{table}` was not looked at: {tables:?}");
    }
    let channels = ["ch1", "ch2", "ch3", "ch4"];
    let missing: Vec<_> = known
        .iter()
        .filter(|(table, key)| {
            let is_same = channels.contains(&key.as_str()) || key == "source";
            let table = if table == "effects.kuwabara_kono.contacts" {
                "effects.dashpot.contacts"
            } else {
                table
            };
            let key =
                if table == "effects.dashpot.contacts" && key == "eta" { "gamma" } else { key };
            let is_effect = table.starts_with("effects.") && per_effect(key);
            !is_same
                && !is_effect
                && !of_instruments(table, key)
                && !all.contains(&(table.to_owned(), key.to_owned()))
        })
        .collect();
    assert!(missing.is_empty(), "`help scene` lacks {missing:?}");
}

#[test]
fn the_annotated_plan_has_every_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("plan.toml");
    let read = |text: &str| {
        std::fs::write(&file, text).expect("a plan");
        match plan::load(&file) {
            Err(SceneError::InFile { problems, .. }) => problems,
            other => panic!("expected problems, found {other:?}"),
        }
    };
    // Nothing is wrong with it but that the recordings are not there.
    let found = read(&annotated_plan());
    assert!(found.iter().all(|problem| problem.found.contains("does not exist")), "{found:?}");
    let speeds = "\n[speeds]\nscale_u = \"0.1 %\"\n";
    let known = known(&read(&with_unknown(&format!("{}{speeds}", annotated_plan()))));
    let all: BTreeSet<(String, String)> = documented(&annotated_plan())
        .into_iter()
        .map(|(table, key)| {
            if table.starts_with("strikers") {
                ("strikers.ball".to_owned(), key)
            } else {
                (table, key)
            }
        })
        .collect();
    let missing: Vec<_> = known.iter().filter(|key| !all.contains(*key)).collect();
    assert!(
        missing.is_empty() && known.len() > 40,
        "`help plan` lacks {missing:?} of {}",
        known.len()
    );
}

/// What cannot be read is told as everywhere.
#[test]
fn what_is_wrong_is_not_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("x.toml");
    std::fs::write(&file, "base = \"magnet-0.61g\"\nseeed = 1\n").expect("a file");
    assert!(matches!(
        Scene::resolved(file.to_str().expect("a path")),
        Err(SceneError::Problems(_))
    ));
}

/// Every `# key = value` line of the annotated scene, uncommented alone: what is refused is that it
/// is an alternative to something that is there, never the value.
#[test]
fn commented_lines_of_the_annotated_scene_have_right_values() {
    let page = annotated_scene();
    let lines: Vec<&str> = page.lines().collect();
    let mut tried = 0;
    for (number, line) in lines.iter().enumerate() {
        let Some(bare) = line.strip_prefix("# ") else { continue };
        let Some((key, _)) = bare.split_once(" = ") else { continue };
        if key.contains(' ') {
            continue;
        }
        // The table of a line whose header is a comment as well is uncommented with it, and with
        // all that it needs.
        let block = lines[..number].iter().rposition(|line| line.is_empty()).map_or(0, |at| at + 1);
        let head = (block..number).rev().find(|at| {
            let line = lines[*at];
            line.starts_with('[') || line.starts_with("# [")
        });
        if head.is_some_and(|at| lines[at].starts_with("# [")) {
            continue;
        }
        tried += 1;
        let mut text = lines.clone();
        text[number] = bare;
        let Err(error) = super::load(&text.join("\n")) else { continue };
        let told = error.to_string();
        let place = format!("scene.toml:{}:", number + 1);
        for words in ["unknown unit", "unknown key", "no number", "; a", "expected a "] {
            let wrong = told.lines().find(|said| said.contains(&place) && said.contains(words));
            assert!(wrong.is_none(), "{line}\n{told}");
        }
    }
    assert!(tried > 20, "{tried} lines");
}

/// Whole tables of the annotated scene that are commented out, each in place of what it excludes.
#[test]
fn commented_tables_of_the_annotated_scene_are_right() {
    let page = annotated_scene();
    let dashpot = page.find("[effects.dashpot]").expect("a table");
    let (start, rest) = page.split_at(dashpot);
    let uncertainty = rest.find("# What is not known").expect("a comment");
    for table in ["[effects.kuwabara_kono]", "[effects.power_law_loss]", "[effects.magnet_preload]"]
    {
        let lines: Vec<&str> = rest[..uncertainty].lines().collect();
        let head = lines.iter().position(|line| line.contains(table)).expect("a header");
        let keys = lines[head + 1..].iter().take_while(|line| line.contains(" = "));
        let keys =
            keys.filter(|line| !line.contains("force = ") && !line.contains("distance_unloaded"));
        let body: Vec<&str> =
            [&lines[head]].into_iter().chain(keys).map(|l| l.trim_start_matches("# ")).collect();
        let text = format!("{start}\n{}\n", body.join("\n"));
        super::load(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    }
}

/// A key that is absent has the default that the page documents.
#[test]
fn an_absent_key_has_the_documented_default() {
    let page = annotated_scene();
    let lines: Vec<&str> = page.lines().collect();
    let mut compared = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let Some((setting, comment)) = line.split_once(" # default") else { continue };
        // `default: none` has no value to type.
        if comment.starts_with(':') {
            continue;
        }
        let Some((key, value)) = setting.split_once(" = ").filter(|(key, _)| !key.contains('#'))
        else {
            continue;
        };
        let stated = comment.split([';', ':']).next().unwrap_or_default().trim();
        let value = if stated.is_empty() { value } else { stated };
        // Without it that sensor has no place.
        if key == "wall" {
            continue;
        }
        let with = |line: String| {
            let mut text: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
            text[number] = line;
            super::load(&text.join("\n"))
                .unwrap_or_else(|error| panic!("{line}: {error}", line = lines[number]))
        };
        let (absent, typed) = (with(String::new()), with(format!("{key} = {value}")));
        let absent = Scene {
            text: typed.text.clone(),
            texts: typed.texts.clone(),
            // Its inputs have the names of two temporary files.
            uncertainty: typed.uncertainty.clone(),
            ..absent
        };
        assert_eq!(absent, typed, "{line}");
        compared.push(key);
    }
    for key in ["frames", "seed", "repeat", "offset", "plates", "wiring", "mode", "slope", "probe"]
    {
        assert!(compared.contains(&key), "{key}: {compared:?}");
    }
}

/// Defaults of a scene's front panel are the instrument's own: programmer manual of the TDS 2014,
/// appendix "factory initialisation settings" (edge trigger on the rising slope, automatic, DC, no
/// bandwidth limit, not inverted, sample mode, 16 averages, positions 0).
#[test]
fn a_panel_without_settings_is_the_factory_panel() {
    use hertzscope::scope::{AcquireMode, Coupling, EdgeCoupling, Slope, TriggerMode};
    let text = BENCH.split("[scope]").next().expect("a bench").to_owned()
        + "[scope]\nmodel = \"tds2014\"\ntime_base = \"250 us/div\"\n[scope.ch1]\nscale = \"1 V/div\"\n[scope.trigger]\nsource = \"CH1\"\nlevel = \"0 V\"\n";
    let scene = super::load(&text).expect("a scene");
    let trigger = scene.scope.trigger;
    assert_eq!(trigger.mode, TriggerMode::Auto);
    assert_eq!(trigger.slope, Slope::Rise);
    assert_eq!(trigger.coupling, EdgeCoupling::Dc);
    assert!((trigger.holdoff - 500e-9).abs() < 1e-20);
    let channel = scene.scope.channels[0].as_ref().expect("channel 1").vertical;
    assert_eq!(channel.coupling, Some(Coupling::Dc));
    assert_eq!((channel.bandwidth_limited, channel.inverted), (Some(false), Some(false)));
    assert_eq!((channel.position, channel.probe), (0.0, 1.0));
    assert_eq!(scene.scope.acquisition.mode, AcquireMode::Sample);
    assert_eq!(scene.scope.acquisition.averages, 16);
    assert_eq!(scene.scope.horizontal_position, 0.0);
    assert_eq!(scene.frames, 200);
}
