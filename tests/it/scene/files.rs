//! Scenes that stand on other files: bases, instruments, what cannot be read.

use std::path::Path;

use hertzscope::scene::{Problem, Scene, SceneError};

use super::{BENCH, bench_with, load, load_in, problems};

fn folder_with(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        let file = folder.path().join(name);
        std::fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
        std::fs::write(file, text).expect("a temporary file");
    }
    folder
}

fn load_file(file: &Path) -> Result<Scene, SceneError> {
    Scene::load(file.to_str().expect("a path in UTF-8"))
}

fn told(result: Result<Scene, SceneError>) -> Vec<Problem> {
    match result {
        Err(SceneError::Problems(problems)) => problems,
        other => panic!("expected problems, found {other:?}"),
    }
}

#[test]
fn paths_are_relative_to_the_file_that_names_them() {
    let folder = folder_with(&[
        ("bench.toml", BENCH),
        ("mine/scene.toml", "base = \"../bench.toml\"\n[striker]\nmodel = \"my-striker.toml\"\n"),
        (
            "mine/my-striker.toml",
            "material = \"parts/brass.toml\"\nmass = \"3 g\"\nspeed = \"1 m/s\"\n",
        ),
        ("mine/parts/brass.toml", "youngs_modulus = \"100 GPa\"\npoissons_ratio = 0.3\n"),
    ]);
    let scene = load_file(&folder.path().join("mine/scene.toml")).expect("sound");
    let striker = scene.spec.striker.as_ref().expect("a striker");
    // What the scene itself names replaces what stands below, key by key: mass, speed and material
    // from the file.
    assert_eq!(striker.mass.to_bits(), 3e-3_f64.to_bits());
    assert_eq!(striker.elasticity.youngs_modulus.to_bits(), 100e9_f64.to_bits());
    assert_eq!(scene.initial_velocities[0].to_bits(), 1.0_f64.to_bits());
    assert_eq!(scene.chain.particles(), 39);
}

#[test]
fn a_scene_replaces_what_its_base_says_key_by_key() {
    let base = Scene::load("magnet-0.61g").expect("sound");
    let scene = load("base = \"magnet-0.61g\"\n[striker]\nspeed = \"1 m/s\"\n").expect("sound");
    assert_eq!(scene.initial_velocities[0].to_bits(), 1.0_f64.to_bits());
    assert_eq!(scene.spec.striker, base.spec.striker);
    assert_ne!(scene.texts.hash(), base.texts.hash(), "other text, other hash");
}

#[test]
fn problems_name_the_file_that_they_are_in() {
    let wrong_bench = bench_with("mass = \"0.61 g\"", "mass = \"0 g\"");
    let folder = folder_with(&[
        ("bench.toml", &wrong_bench),
        (
            "scene.toml",
            "base = \"bench.toml\"\n[sensors.p14]\nmodel = \"plate.toml\"\nparticle = 99\n",
        ),
        (
            "plate.toml",
            "ceramic = \"pzt-5a\"\nside = \"3 mm\"\nthickness = \"0.5 kg\"\ncable_capacitance = \"1 nF\"\ncolour = 1\n",
        ),
    ]);
    let told = told(load_file(&folder.path().join("scene.toml")));
    let found: Vec<(String, usize, usize, &str)> = told
        .iter()
        .map(|p| {
            let name = Path::new(&p.file).file_name().expect("a name");
            (name.to_string_lossy().into_owned(), p.line, p.column, p.key.as_str())
        })
        .collect();
    let row = |file: &str, line, column, key| (file.to_owned(), line, column, key);
    // The scene's model file lies on top of what the base typed.
    assert_eq!(
        found,
        [
            row("bench.toml", 34, 8, "striker.mass"),
            row("plate.toml", 3, 13, "sensors.p14.thickness"),
            row("plate.toml", 5, 1, "sensors.p14.colour"),
            row("scene.toml", 4, 12, "sensors.p14.particle"),
        ],
        "{told:#?}"
    );
}

#[test]
fn shipped_files_are_named_as_such() {
    let text = "base = \"magnet-0.61g\"\n[[chain.segments]]\nparticles = [\"ptfe_sphere\"]\n";
    let told = problems(text);
    let sensor = told.iter().find(|p| p.key == "sensors.p2.particle").expect("particle 2 of 1");
    assert_eq!(sensor.file, "instruments/scenes/magnet-0.61g.toml");
    let shipped = hertzscope::data::instrument("scenes", "magnet-0.61g").expect("it ships");
    let line = shipped.lines().nth(sensor.line - 1).expect("a line");
    assert_eq!(line.split('#').next().map(str::trim), Some("particle = 2"));
    assert_eq!(sensor.column, 12);
}

/// What stands in a base fits the base: what it no longer fits stands above.
#[test]
fn a_problem_in_a_base_names_the_scene_that_stands_on_it() {
    let text = "base = \"magnet-0.61g\"\nduration = \"1e9 s\"\n";
    let Err(SceneError::Problems(told)) = load(text) else { panic!("sound") };
    let [problem] = &told[..] else { panic!("{told:#?}") };
    assert!(problem.file.ends_with("magnet-0.61g.toml") && problem.key == "scope.time_base");
    assert!(problem.found.contains("1.00 Gs"), "{problem}");
    let names = problem.expected.contains("whose changes may not fit here");
    assert!(names, "{problem}");
    let text = "base = \"magnet-0.61g\"\n[striker]\nspeed = \"0 m/s\"\n";
    let Err(SceneError::Problems(told)) = load(text) else { panic!("sound") };
    assert!(!told[0].expected.contains("stands on"), "{}", told[0]);
}

/// A force instead of a wall, and the other way round: what is left to tell is that the one does
/// not carry the chain, and that the other has no contact.
#[test]
fn an_end_of_the_chain_replaces_its_bases() {
    for (base, bottom, told) in [
        ("magnet-0.61g", "{ force = \"2.493 N\" }", "left at the bottom"),
        ("nonlinear-300-cells", "{ wall = \"alumina\" }", "on the bottom wall"),
        ("nonlinear-300-cells", "\"free\"", "left at the bottom"),
    ] {
        let text = format!("base = \"{base}\"\n[chain]\nbottom = {bottom}\n");
        let Err(SceneError::Problems(problems)) = load(&text) else { panic!("sound: {text}") };
        let is_told = problems.iter().any(|problem| problem.found.contains(told));
        assert!(is_told, "{problems:#?}");
        let as_an_end = problems.iter().any(|problem| problem.expected.contains("<material>"));
        assert!(!as_an_end, "{problems:#?}");
    }
}

#[test]
fn bases_that_are_not_there_or_go_in_circles() {
    let missing = problems("base = \"magnet-0.62g\"\n");
    assert_eq!(missing.len(), 1);
    assert_eq!((missing[0].line, missing[0].column, missing[0].key.as_str()), (1, 8, "base"));
    assert!(missing[0].found.contains("magnet-0.62g"), "{}", missing[0]);
    assert!(missing[0].expected.contains("magnet-0.61g"), "{}", missing[0]);
    let no_file = problems("base = \"nowhere/scene.toml\"\n");
    assert!(no_file[0].found.contains("scene.toml"), "{}", no_file[0]);
    let itself = problems("base = \"scene.toml\"\n");
    assert_eq!(itself.len(), 1);
    assert!(itself[0].found.contains("more than 8 scenes based on one another"), "{}", itself[0]);
    let folder =
        folder_with(&[("a.toml", "base = \"b.toml\"\n"), ("b.toml", "base = \"a.toml\"\n")]);
    let circle = told(load_file(&folder.path().join("a.toml")));
    assert!(circle[0].found.contains("more than 8 scenes"), "{}", circle[0]);
    let wrong_kind = problems("base = 4\n");
    assert!(
        wrong_kind.iter().any(|p| p.key == "base" && p.expected == "text in quotes"),
        "{wrong_kind:#?}"
    );
}

/// A missing model is told with everything else, and nothing is told that only follows from it.
#[test]
fn models_that_are_not_there() {
    let text = BENCH
        .replacen("model = \"pzt-5a-710pf\"", "model = \"quartz\"", 1)
        .replacen("model = \"tds2014\"", "model = \"tds9999\"", 1)
        .replacen("[striker]\n", "[striker]\nmodel = \"missing/anvil.toml\"\n", 1)
        .replacen("seed = 7", "seed = -7", 1);
    let told = problems(&text);
    let keys: Vec<&str> = told.iter().map(|p| p.key.as_str()).collect();
    assert_eq!(keys, ["seed", "striker.model", "sensors.p3.model", "scope.model"], "{told:#?}");
    assert!(told[1].found.contains("anvil.toml"), "{}", told[1]);
    assert!(told[2].expected.contains("pzt-5a-710pf"), "{}", told[2]);
    assert!(told[3].expected.contains("tds2014"), "{}", told[3]);
}

/// Everything that is missing in a scope's file is told at once; nothing in the scene becomes
/// unknown by it.
#[test]
fn an_oscilloscope_file_with_gaps() {
    let shipped = hertzscope::data::instrument("", "tds2014").expect("it ships");
    let gone = ["name", "record_length", "bandwidth", "time_bases", "probes", "trigger_range"];
    let kept = |line: &&str| !gone.iter().any(|key| line.starts_with(&format!("{key} = ")));
    let mut text = shipped.lines().filter(kept).collect::<Vec<_>>().join("\n");
    // The list of time bases goes on over several lines.
    let list = text.find("  \"5 ns/div\"").expect("the list");
    let end = list + text[list..].find("]\n").expect("its end") + 2;
    text.replace_range(list..end, "");
    let folder = folder_with(&[("mine.toml", &text)]);
    let scene = bench_with("model = \"tds2014\"", "model = \"mine.toml\"");
    let told = told(load_in(folder.path(), &scene));
    let mut keys: Vec<&str> = told.iter().map(|p| p.key.as_str()).collect();
    let mut expected: Vec<String> = gone.iter().map(|key| format!("scope.{key}")).collect();
    keys.sort_unstable();
    expected.sort_unstable();
    assert_eq!(keys, expected, "{told:#?}");
    assert!(told.iter().all(|p| p.found == "no such key"), "{told:#?}");
}

#[test]
fn texts_that_are_no_toml() {
    let cases = [
        ("a = \n", 1),
        ("title = \"x\"\n[striker\n", 2),
        ("title = \"x\"\ntitle = \"y\"\n", 2),
        ("[striker]\nmass = \"1 g\"\n[striker]\n", 3),
        ("title = \"x\n", 1),
    ];
    for (text, line) in cases {
        let told = problems(text);
        assert_eq!(told[0].line, line, "{text:?}: {told:#?}");
        assert!(
            told.iter().all(|p| p.column >= 1 && p.found.starts_with("not valid TOML: ")),
            "{told:#?}"
        );
        assert!(told.iter().all(|p| !p.found.is_empty()), "{told:#?}");
    }
    // Nesting that would exhaust the stack of a careless reader.
    let deep = format!("a = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert_eq!(problems(&deep)[0].line, 1);
    let dotted = format!("{} = 1\n", vec!["a"; 100_000].join("."));
    assert_eq!(problems(&dotted)[0].line, 1);
}

#[test]
fn files_that_cannot_be_read() {
    let folder = folder_with(&[("ok.toml", "")]);
    let missing = load_file(&folder.path().join("missing.toml")).expect_err("no file");
    assert!(matches!(missing, SceneError::Read { .. }), "{missing:?}");
    assert!(missing.to_string().contains("missing.toml"), "{missing}");
    let directory = folder.path().join("folder.toml");
    std::fs::create_dir(&directory).expect("a folder");
    let error = load_file(&directory).expect_err("a folder");
    assert!(matches!(error, SceneError::Read { .. }), "{error:?}");
    let unknown = Scene::load("magnet-0.62g").expect_err("no such scene");
    assert!(unknown.to_string().contains("`magnet-0.62g`"), "{unknown}");
    assert!(unknown.to_string().contains("magnet-0.61g"), "{unknown}");
    assert!(matches!(Scene::load(""), Err(SceneError::Unknown { .. })));
}

#[test]
fn bytes_that_are_no_text_have_a_place() {
    let folder = folder_with(&[]);
    let file = folder.path().join("latin1.toml");
    std::fs::write(&file, b"title = \"x\"\n# 20 \xb0C\n").expect("a temporary file");
    let told = told(load_file(&file));
    assert_eq!((told[0].line, told[0].column), (2, 6), "{}", told[0]);
    assert!(told[0].found.contains("0xb0"), "{}", told[0]);
    assert!(told[0].expected.contains("UTF-8"), "{}", told[0]);
}

#[test]
fn windows_line_ends_and_a_byte_order_mark_are_text_too() {
    let scene = load(&BENCH.replace('\n', "\r\n")).expect("sound");
    assert_eq!(scene.chain.particles(), 39);
    let marked = format!("\u{feff}{BENCH}");
    assert_eq!(load(&marked).expect("sound").chain.particles(), 39);
    let told = problems(&bench_with("seed = 7", "seed = -7").replace('\n', "\r\n"));
    assert_eq!((told[0].line, told[0].column), (4, 8));
}

#[test]
fn numbers_may_be_written_in_any_way_of_toml() {
    let scene = load(&bench_with("repeat = 19", "repeat = 0x13")).expect("sound");
    assert_eq!(scene.chain.particles(), 39);
    let scene = load(&bench_with("accuracy = 1e-6", "accuracy = 0.000_001")).expect("sound");
    assert_eq!(scene.accuracy, 1e-6);
}

/// Every text that goes into a scene goes into its hash: material and ceramic files too.
#[test]
fn the_hash_covers_materials_and_ceramics() {
    let brass = "youngs_modulus = \"100 GPa\"\npoissons_ratio = 0.3\n";
    let clay = "relative_permittivity = 1800\nd33 = \"400 pC/N\"\n";
    let text = bench_with("material = \"alumina\"", "material = \"brass.toml\"").replacen(
        "\"pzt-5a\"",
        "\"clay.toml\"",
        1,
    );
    let hash = |brass: &str, clay: &str| {
        let folder = folder_with(&[("brass.toml", brass), ("clay.toml", clay)]);
        load_in(folder.path(), &text).expect("sound").texts.hash().to_owned()
    };
    assert_eq!(hash(brass, clay), hash(brass, clay));
    assert_ne!(hash(brass, clay), hash(&brass.replace("100", "101"), clay));
    assert_ne!(hash(brass, clay), hash(brass, &clay.replace("400", "401")));
}
