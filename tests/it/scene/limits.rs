//! Limits: of numbers, of the list of problems, of what a name may be.

use std::fmt::Write as _;

use hertzscope::scene::adjust::Adjustable;
use hertzscope::scene::random_inputs::RandomInputs;
use hertzscope::scene::{Scene, SceneError};
use rustix::time::{ClockId, clock_gettime};

use super::{BENCH, bench_with, load, problems};

/// Most problems that are listed, and one line on the rest.
const LISTED: usize = 100;
/// Bound on the processor's time for a file of 16 MiB; quadratic time would take minutes.
const PATIENCE: f64 = 40.0;

/// Processor's time of this thread, which other programs do not change (s).
fn cpu_time() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

fn lines(text: impl Fn(usize) -> String, bytes: usize) -> String {
    let mut all = String::with_capacity(bytes + 100);
    let mut number = 0;
    while all.len() < bytes {
        all.push_str(&text(number));
        number += 1;
    }
    all
}

#[test]
fn a_hundred_problems_are_listed_and_the_rest_is_counted() {
    let told = |unknown: usize| {
        let keys: String = (0..unknown).fold(String::new(), |mut text, number| {
            let _ = writeln!(text, "unknown_{number} = 1");
            text
        });
        problems(&format!("{keys}{BENCH}"))
    };
    assert_eq!(told(LISTED).len(), LISTED);
    assert_eq!(told(LISTED + 1)[LISTED].found, "1 more problem, which is not listed");
    let told = told(250);
    assert_eq!(told.len(), LISTED + 1);
    assert!(told[..LISTED].iter().all(|problem| problem.found.contains("unknown key")));
    assert_eq!(told[LISTED].found, "150 more problems, which are not listed");
    let said = SceneError::Problems(told).to_string();
    assert!(said.ends_with("100 problems in the scene"), "{said}");
}

#[test]
fn time_is_linear_in_the_number_of_problems() {
    const BYTES: usize = 15 << 20;
    let material = |n: usize| {
        format!("[materials.m{n}]\nyoungs_modulus = \"1 GPa\"\npoissons_ratio = 0.3\ndensty = 1\n")
    };
    let particle =
        |n: usize| format!("[particles.p{n}]\nmaterial = \"none{n}\"\ndiameter = \"5 mm\"\n");
    let texts = [
        ("keys", lines(|n| format!("k{n} = 1\n"), BYTES)),
        ("tables", lines(|n| format!("[a{n}]\n"), BYTES)),
        ("materials", lines(material, BYTES)),
        ("particles", lines(particle, BYTES / 8)),
        (
            "uncertainty",
            format!("[uncertainty]\n{}", lines(|n| format!("\"particles.*.k{n}\" = 1\n"), BYTES)),
        ),
    ];
    for (kind, text) in texts {
        let start = cpu_time();
        let error = load(&format!("base = \"magnet-0.61g\"\n{text}")).expect_err(kind);
        assert!(cpu_time() - start < PATIENCE, "{kind}: {:?}", cpu_time() - start);
        let SceneError::Problems(told) = error else { panic!("{kind}: {error}") };
        assert!(told.len() <= LISTED + 1, "{kind}: {}", told.len());
        assert!(told.iter().map(|p| p.expected.len()).sum::<usize>() < 1 << 20, "{kind}");
    }
}

#[test]
fn names_that_do_not_exist_take_linear_time() {
    let names = (0..300_000).fold(String::new(), |mut names, n| {
        let _ = write!(names, "\"no{n}\",");
        names
    });
    let kinds = lines(
        |n| format!("[particles.kind{n}]\nmaterial = \"ptfe\"\ndiameter = \"5 mm\"\n"),
        4 << 20,
    );
    let text = bench_with("particles = [\"ball\"]", &format!("particles = [{names}]"));
    let start = cpu_time();
    let told = problems(&format!("{text}\n{kinds}"));
    assert!(cpu_time() - start < PATIENCE, "{:?}", cpu_time() - start);
    assert!(told.len() <= LISTED + 1);
    assert!(told.iter().all(|problem| problem.expected.len() < 4000));
}

/// Forces have a limit as speeds have: a hundred tonnes.
#[test]
fn forces_beyond_a_bench_are_refused() {
    let force = |force: &str| {
        format!("base = \"magnet-0.61g\"\n[effects.magnet_preload]\nforce = \"{force}\"\n")
    };
    let told = problems(&force("1e30 N"));
    assert_eq!(told.len(), 1, "{told:?}");
    assert_eq!(told[0].expected, "a force (N) from 0 to 1e6");
    load(&force("1e3 N")).expect("a force of a press");
    let chain = |top: &str| {
        format!(
            "base = \"magnet-0.61g\"\n[effects]\nmagnet_preload = false\n[chain]\ntop = {top}\n"
        )
    };
    for top in ["{ force = \"1e30 N\" }", "{ wall = \"alumina\", preload = \"1e7 N\" }"] {
        let text = chain(top);
        let told = problems(&text);
        assert!(told.iter().any(|p| p.expected == "a force (N) from 0 to 1e6"), "{told:?}");
    }
}

/// The Curie temperature of `Nd2Fe14B` is 585 K, 312 °C (Sagawa et al. 1984).
#[test]
fn a_magnet_above_its_curie_temperature_is_refused() {
    let at = |temperature: &str| {
        format!(
            "base = \"magnet-0.61g\"\n[effects.magnet_preload]\nmodel = \"ring-15-6-6\"\ndistance = \"0.4 mm\"\ntemperature = \"{temperature}\"\n"
        )
    };
    let told = problems(&at("500 degC"));
    assert!(
        told.iter().any(|problem| problem.key == "effects.magnet_preload.temperature"),
        "{told:?}"
    );
    assert!(told.iter().any(|problem| problem.expected.contains("585.1 K")), "{told:?}");
}

#[test]
fn uncertainties_in_a_wrong_unit_or_above_the_value_are_refused() {
    let with = |line: &str| format!("base = \"magnet-0.61g\"\n[uncertainty]\n{line}\n");
    for (line, found, expected) in [
        ("striker.speed = \"1 mm\"", "`1 mm` is a length (m)", "a speed (m/s) or a share"),
        ("striker.speed = \"300 %\"", "\"300 %\"", "at most 100 %"),
        ("striker.speed = 0.1", "`0.1` is a plain number", "a speed (m/s)"),
        ("\"sensors.*.offset\" = \"1 mm\"", "is a length (m)", "a plain number"),
        ("\"sensors.*.sensitivity\" = \"1 V\"", "is a voltage (V)", "a sensitivity (V/N)"),
        ("materials.ptfe.youngs_modulus = \"1 N\"", "is a force (N)", "a pressure (Pa)"),
        ("striker.speed = { half_width = \"1 s\" }", "is a time (s)", "a speed (m/s)"),
        ("striker.speed = { between = [\"1 s\", \"2 s\"] }", "is a time (s)", "a speed (m/s)"),
        ("striker.speed = { between = [\"1 m/s\", \"2 m\"] }", "[1 m/s, 2 m]", "of one unit"),
        (
            "striker.speed = { between = [\"2 m/s\", \"1 m/s\"] }",
            "[2 m/s, 1 m/s]",
            "the lower first",
        ),
    ] {
        let told = problems(&with(line));
        assert_eq!(told.len(), 1, "{line}: {told:?}");
        assert!(told[0].found.contains(found), "{line}: {}", told[0]);
        assert!(told[0].expected.contains(expected), "{line}: {}", told[0]);
        assert_eq!(told[0].line, 3, "{line}");
    }
    for line in [
        "striker.speed = \"100 %\"",
        "striker.speed = \"1 cm/s\"",
        "\"sensors.*.sensitivity\" = \"1 mV/N\"",
    ] {
        load(&with(line)).unwrap_or_else(|error| panic!("{line}: {error}"));
    }
}

/// Paths in an included file, and in a text of a recording, are not relative to a folder of the
/// same name on this machine. Tests run in the repository, which has such a folder.
#[test]
fn an_included_scene_is_not_the_file_of_its_name() {
    let text = "base = \"magnet-0.61g\"\n[striker]\nmodel = \"nowhere.toml\"\n";
    let error =
        Scene::from_text("x", "instruments/scenes/magnet-0.61g.toml", text).expect_err("no file");
    let told = error.to_string();
    assert!(told.contains("found nowhere.toml,"), "{told}");
    assert!(!told.contains("instruments/scenes/nowhere.toml"), "{told}");
}

/// A name in Latin-1, as on an old Windows share.
#[cfg(unix)]
#[test]
fn a_scenes_path_need_not_be_unicode() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().expect("a folder");
    let inner = folder.path().join(OsStr::from_bytes(b"lab\xff"));
    std::fs::create_dir(&inner).expect("a folder");
    let file = inner.join("s.toml");
    std::fs::write(&file, "base = \"magnet-0.61g\"\n").expect("a file");
    assert_eq!(Scene::load(&file).expect("a scene").name, "s");
    for command in ["show", "bands"] {
        let mut program = assert_cmd::Command::cargo_bin("hertzscope").expect("the program");
        program.arg(command).arg(&file).assert().success();
    }
}

/// The data sheet states gain and zero by the range at the input: 20 mV/div through a probe of ten
/// times is 2 mV/div there, where the gain is known to 4 %, not 3 %.
#[test]
fn a_probe_does_not_change_the_range_of_the_data_sheet() {
    let errors = |probe: u32, scale: &str| {
        let text = format!(
            "base = \"magnet-0.61g\"\n[effects]\nscope_errors = {{}}\n\
             [scope.ch1]\nprobe = {probe}\nscale = \"{scale}\"\nposition = \"0 div\"\n[scope.trigger]\nlevel = \"0 V\"\n"
        );
        let adjustable = Adjustable::from_text("probe", "probe.toml", &text);
        let mut adjustable = adjustable.unwrap_or_else(|error| panic!("{error}"));
        let inputs = RandomInputs::of(&mut adjustable).expect("inputs");
        let of = |name: &str| inputs.list().iter().find(|input| input.name == name).map(|i| i.u);
        [of("gain of CH1"), of("zero of CH1")].map(|u| u.expect("an input"))
    };
    let direct = errors(1, "2 mV/div");
    assert!((direct[0] - 0.04 / 3f64.sqrt()).abs() < 1e-12, "{direct:?}");
    assert_eq!(errors(10, "20 mV/div"), direct);
}
