//! Rows of a chain whose repetitions differ in size.

use hertzscope::scene::Scene;

use super::{load, problems};

/// A chain of spheres of 10 mm with a mass of 8 g in a segment with `keys`.
fn scene(keys: &str) -> String {
    format!(
        "duration = \"1 ms\"\n[particles.ball]\nmaterial = \"steel_440c\"\ndiameter = \"10 mm\"\nmass = \"8 g\"\n\
         [particles.rod]\nmaterial = \"brass\"\ndiameter = \"10 mm\"\nheight = \"4 mm\"\n\
         [chain]\ntop = \"free\"\nbottom = \"free\"\n[[chain.segments]]\n{keys}\n\
         [striker]\nmaterial = \"steel_440c\"\ndiameter = \"10 mm\"\nspeed = \"1 m/s\"\n\
         [scope]\nmodel = \"tds2014\"\ntime_base = \"100 us/div\"\n[scope.trigger]\nsource = \"CH1\"\nlevel = \"0 V\"\n[scope.ch1]\nscale = \"1 V/div\"\n"
    )
}

fn particles(keys: &str) -> Vec<[f64; 3]> {
    let scene: Scene = load(&scene(keys)).unwrap_or_else(|error| panic!("{keys}: {error}"));
    let bodies = scene.spec.particles.iter();
    bodies.map(|body| [body.length * 1e3, body.mass * 1e3, 2e3 / body.curvature]).collect()
}

fn near(found: &[[f64; 3]], expected: &[[f64; 3]]) {
    let close = |(a, b): (&f64, &f64)| a == b || (a / b - 1.0).abs() < 1e-12;
    let all = found.iter().flatten().zip(expected.iter().flatten()).all(close);
    assert!(all && found.len() == expected.len(), "{found:?}, not {expected:?}");
}

/// Diameters in even steps, masses with their cubes.
#[test]
fn a_taper_goes_from_one_diameter_to_another() {
    let keys = "particles = [\"ball\"]\nrepeat = 3\ndiameter = { from = \"10 mm\", to = \"5 mm\" }";
    near(&particles(keys), &[[10.0, 8.0, 10.0], [7.5, 3.375, 7.5], [5.0, 1.0, 5.0]]);
}

/// The kind's own diameter does not matter: masses go with the cube of what it is scaled by.
#[test]
fn a_taper_may_begin_at_another_diameter_than_its_kinds() {
    let keys = "particles = [\"ball\"]\nrepeat = 2\ndiameter = { from = \"5 mm\", to = \"20 mm\" }";
    near(&particles(keys), &[[5.0, 1.0, 5.0], [20.0, 64.0, 20.0]]);
}

/// Each row half as large as the one before; a cylinder's faces stay flat.
#[test]
fn a_factor_scales_every_kind_of_a_row() {
    let keys = "particles = [\"ball\", \"rod\"]\nrepeat = 2\nfactor = 0.5";
    let rod = particles("particles = [\"rod\"]")[0];
    let half = [rod[0] / 2.0, rod[1] / 8.0, rod[2]];
    near(&particles(keys), &[[10.0, 8.0, 10.0], rod, [5.0, 1.0, 5.0], half]);
}

#[test]
fn what_cannot_be_tapered_is_refused() {
    let row = "particles = [\"ball\", \"rod\"]\nrepeat = 3\n";
    let one = "particles = [\"ball\"]\nrepeat = 3\n";
    let taper = "diameter = { from = \"10 mm\", to = \"5 mm\" }";
    for (keys, found, expected) in [
        (format!("{row}{taper}"), "2 kinds", "factor"),
        (format!("{one}{taper}\nfactor = 0.9"), "both", "one of them"),
        (format!("particles = [\"ball\"]\n{taper}"), "a single row", "repeat"),
        (format!("{one}factor = 0"), "0", "above zero"),
        (format!("{one}factor = 1e-9"), "e-20 m", "a length"),
        (format!("{one}diameter = \"5 mm\""), "5 mm", "from = "),
        (format!("{one}diameter = {{ from = \"10 mm\" }}"), "missing", "length"),
        (
            format!("{one}diameter = {{ from = \"10 mm\", to = \"5 mm\", by = 3 }}"),
            "unknown key `by`",
            "from, to",
        ),
    ] {
        let problems = problems(&scene(&keys));
        let told = problems.iter().any(|problem| {
            let text = problem.to_string();
            text.contains(found) && text.contains(expected)
        });
        assert!(told && problems.len() == 1, "{keys}: {problems:?}");
    }
}
