//! The ring magnet against current loops summed up here, measured tables, the files, and the
//! command.

mod motion;

use std::f64::consts::TAU;

use assert_cmd::Command;
use hertzscope::magnet::{ForceLaw, ForceTable, Magnet, RingMagnet, Sphere, TableError};
use hertzscope::scene::magnets;
use serde_json::Value;

/// Permeability of vacuum, CODATA 2018 (N/A^2).
const MU0: f64 = 1.25663706212e-6;
const ROOM: f64 = 293.15;

fn ring(outer: f64, inner: f64, length: f64, remanence: f64) -> RingMagnet {
    RingMagnet {
        inner_radius: 0.5 * inner,
        outer_radius: 0.5 * outer,
        length,
        remanence,
        temperature_coefficient: -1.2e-3,
        curie_temperature: f64::INFINITY,
        reference_temperature: ROOM,
    }
}

/// Field of a loop with one ampere on its axis by Biot and Savart's law, element by element: of
/// `mu0/(4 pi) dl x r / |r|^3` what points along the axis. Every element of a loop gives the same
/// to a point on the axis; 12 of them check that too.
fn loop_field(radius: f64, along: f64) -> f64 {
    let elements = 12;
    let step = TAU / f64::from(elements);
    let part = |i: i32| {
        let angle = step * f64::from(i);
        let (x, y) = (radius * angle.cos(), radius * angle.sin());
        let (dx, dy) = (-radius * angle.sin() * step, radius * angle.cos() * step);
        // From the element to the point on the axis: (-x, -y, along).
        let cross = dx * -y - dy * -x;
        let distance = (x * x + y * y + along * along).sqrt();
        MU0 / (2.0 * TAU) * cross / (distance * distance * distance)
    };
    (0..elements).map(part).sum()
}

/// Field on a ring's axis from loops along both its cylinders, `Br/mu0` amperes a metre, against
/// each other: Gauss and Legendre's rule with five points in each of 200 parts, whose error is far
/// below rounding.
fn summed_field(ring: &RingMagnet, z: f64) -> f64 {
    const RULE: [(f64, f64); 5] = [
        (0.0, 0.5688888888888889),
        (0.5384693101056831, 0.47862867049936647),
        (-0.5384693101056831, 0.47862867049936647),
        (0.906179845938664, 0.23692688505618908),
        (-0.906179845938664, 0.23692688505618908),
    ];
    let parts = 200;
    let half = 0.5 * ring.length / f64::from(parts);
    let sheet = ring.remanence / MU0;
    let mut sum = 0.0;
    for part in 0..parts {
        let middle = -0.5 * ring.length + half * f64::from(2 * part + 1);
        for (place, weight) in RULE {
            let along = z - (middle + half * place);
            let loops = loop_field(ring.outer_radius, along) - loop_field(ring.inner_radius, along);
            sum += weight * half * sheet * loops;
        }
    }
    sum
}

/// Slope of the summed field by the central difference of eighth order; with steps of 50 um its
/// error is `h^8 B^(9)/630`, below 1e-11 of the slope for a field that changes over 3 mm.
fn summed_gradient(ring: &RingMagnet, z: f64) -> f64 {
    let step = 50e-6;
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let difference = |(k, weight): (i32, f64)| {
        let h = f64::from(k) * step;
        weight * (summed_field(ring, z + h) - summed_field(ring, z - h))
    };
    (1..).zip(weights).map(difference).sum::<f64>() / step
}

#[test]
fn field_and_gradient_are_those_of_current_loops() {
    for magnet in [ring(15e-3, 6e-3, 6e-3, 1.3), ring(12e-3, 6e-3, 6e-3, 1.42)] {
        let field = magnet.at(ROOM);
        for z in [-9e-3, -3.4e-3, -1.1e-3, 0.0, 1e-3, 2.3e-3, 3e-3, 3.37e-3, 5e-3, 8e-3, 20e-3] {
            let (found, exact) = (field.field(z), summed_field(&magnet, z));
            assert!((found / exact - 1.0).abs() < 1e-10, "{z}: {found} T, summed {exact} T");
            // At the centre the slope is zero by symmetry: there it is held to the slope at the
            // face.
            let (found, exact) = (field.gradient(z), summed_gradient(&magnet, z));
            let scale = if z == 0.0 { field.gradient(3e-3).abs() } else { exact.abs() };
            assert!((found - exact).abs() < 1e-8 * scale, "{z}: {found} T/m, summed {exact} T/m");
        }
    }
}

/// Far away a ring is a dipole, `B = mu0 m/(2 pi z^3)`, `m = Br V/mu0`, times
/// `1 + [L^2/2 - 3 (R1^2 + R2^2)/2]/z^2` and terms of fourth order (the loops' field expanded in
/// `1/z`).
#[test]
fn far_away_it_is_a_dipole() {
    let magnet = ring(15e-3, 6e-3, 6e-3, 1.3);
    let volume = 0.5 * TAU * (7.5e-3_f64.powi(2) - 3e-3_f64.powi(2)) * 6e-3;
    let z = 0.3_f64;
    let dipole = 1.3 * volume / (TAU * z.powi(3));
    let next = (0.5 * 6e-3_f64.powi(2) - 1.5 * (3e-3_f64.powi(2) + 7.5e-3_f64.powi(2))) / (z * z);
    let found = magnet.at(ROOM).field(z) / dipole - 1.0 - next;
    // The fourth order's coefficient is a few; the difference of g's cancels to 1e-16/1e-5 of what
    // is left.
    assert!(found.abs() < 10.0 * (7.5e-3 / z).powi(4), "{found:e}");
}

/// Below saturation `F = (4 pi Rs^3/mu0) B B'`, above `V Ms B'`, with the field summed from loops.
#[test]
fn force_below_and_above_saturation() {
    let magnet = ring(15e-3, 6e-3, 6e-3, 1.3);
    let z = 3.4e-3;
    let (b, slope) = (summed_field(&magnet, z), summed_gradient(&magnet, z));
    let radius = 2.38e-3_f64;
    let soft = Sphere { radius, saturation: 2.0 };
    let unsaturated = 2.0 * TAU * radius.powi(3) / MU0 * b * slope;
    let found = magnet.at(ROOM).attraction(z, &soft);
    // Against the sign of z: the field's square falls outward, and the sphere is drawn in.
    assert!((found / -unsaturated - 1.0).abs() < 1e-8 && found > 0.0, "{found}");
    assert!((magnet.at(ROOM).attraction(-z, &soft) / found - 1.0).abs() < 1e-12);
    let weak = Sphere { radius, saturation: 0.1 };
    let saturated = 2.0 / 3.0 * TAU * radius.powi(3) * 0.1 / MU0 * slope;
    let found = magnet.at(ROOM).attraction(z, &weak);
    assert!((found / saturated.abs() - 1.0).abs() < 1e-8 && found > 0.0, "{found}");
    assert_eq!(magnet.at(ROOM).saturation(z, &weak), 1.0);
    // The two laws meet where 3 B is the saturation.
    let edge = |saturation: f64| magnet.at(ROOM).attraction(z, &Sphere { radius, saturation });
    let at = 3.0 * b.abs();
    assert!((edge(at * (1.0 - 1e-9)) / edge(at * (1.0 + 1e-9)) - 1.0).abs() < 1e-8);
}

/// Both rings of the bench, over the remanences it names: 2.38 N within half a millimetre of the
/// face, falling by 1.4 to 3.9 N/mm (each rounded to two digits).
#[test]
fn rings_of_the_bench_press_with_the_papers_force() {
    let sphere = Sphere { radius: 2.38e-3, saturation: 2.0 };
    for outer in [15e-3, 12e-3] {
        for remanence in [1.2, 1.3, 1.42] {
            let law = ForceLaw::Ring(ring(outer, 6e-3, 6e-3, remanence), sphere);
            let magnet = Magnet { name: String::new(), source: String::new(), law };
            let distance = magnet.distances(2.38, ROOM)[0];
            let slope = -1e-3 * magnet.slope(distance, ROOM).expect("a slope");
            println!("{outer} {remanence}: {distance:.3e} m, {slope:.2} N/mm");
            assert!(distance.abs() <= 0.5e-3, "{outer} {remanence}: {distance}");
            assert!((1.35..3.95).contains(&slope), "{outer} {remanence}: {slope}");
        }
    }
}

/// The default ring: the force at the place found, from the loops' field, is 2.38 N to far better
/// than 1 %.
#[test]
fn the_default_ring_gives_the_papers_force() {
    for name in ["ring-15-6-6", "ring-12-6-6"] {
        let magnet = magnets::load(name).expect("a shipped magnet");
        let ForceLaw::Ring(ring, sphere) = magnet.law else { panic!("{name} is a ring") };
        let distances = magnet.distances(2.38, ROOM);
        let z = 0.5 * ring.length + distances[0];
        let factor = 2.0 * TAU * sphere.radius.powi(3) / MU0;
        let force = factor * summed_field(&ring, z) * summed_gradient(&ring, z);
        assert!(distances[0].abs() <= 0.5e-3 && (force.abs() / 2.38 - 1.0).abs() < 1e-8, "{name}");
        // Without saturation the force goes with the remanence's square: 50 K at -0.12 %/K leave
        // 0.94^2.
        let warm = magnet.force(distances[0], ROOM + 50.0).expect("a force");
        assert!((warm / 2.38 - 0.94 * 0.94).abs() < 1e-9, "{name}: {warm}");
    }
}

#[test]
fn a_measured_table_is_read_between_its_points() {
    let points = [(0.0, 4.0), (0.2e-3, 3.1), (0.5e-3, 2.2), (0.6e-3, 2.2), (1.5e-3, 0.4)];
    let table = ForceTable::new(&points).expect("a table");
    for (distance, force) in points {
        assert!((table.force(distance).expect("a point") - force).abs() < 1e-14);
    }
    let steps: Vec<f64> =
        (0..=1500).map(|i| table.force(f64::from(i) * 1e-6).expect("inside")).collect();
    assert!(steps.windows(2).all(|w| w[1] <= w[0] + 1e-14), "it never rises");
    assert_eq!((table.force(-1e-6), table.force(1.6e-3)), (None, None));
    // Where the data are a straight line, so is the curve.
    let line = ForceTable::new(&[(0.0, 1.0), (1.0, 3.0), (4.0, 9.0)]).expect("a table");
    for x in [0.3, 0.9, 2.2, 3.7] {
        assert!((line.force(x).expect("inside") - (1.0 + 2.0 * x)).abs() < 1e-14);
    }
    assert_eq!(ForceTable::new(&points[..1]), Err(TableError::TooFew { points: 1 }));
    let turned = ForceTable::new(&[(1.0, 0.0), (1.0, 1.0)]);
    assert_eq!(turned, Err(TableError::Order { before: 1.0, next: 1.0 }));
}

fn written(text: &str) -> Result<Magnet, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("magnet.toml");
    std::fs::write(&file, text).expect("a file");
    magnets::load(&file.display().to_string()).map_err(|error| error.to_string())
}

#[test]
fn all_problems_of_a_magnets_file_are_told_at_once() {
    for name in magnets::names() {
        magnets::load(name).expect("a shipped magnet");
    }
    let error = written(
        "outer_diameter = \"6 mm\"\ninner_diameter = \"15 mm\"\nlength = \"6 kg\"\nremanence = 1.3\nsphere_diameter = \"-1 mm\"\n\
         remanence_coefficient = \"-0.12 %/K\"\nreference_temperature = \"20 °C\"\nsphere_saturation = \"2 T\"\ncolour = \"blue\"\n",
    )
    .expect_err("five problems");
    for told in [":2:", ":3:", ":4:", ":5:", "`colour`", "5 problems in the magnet's file"] {
        assert!(error.contains(told), "{told}: {error}");
    }
    let points = "[[measured]]\ndistance = \"0 mm\"\nforce = \"3 N\"\n[[measured]]\ndistance = \"0.5 mm\"\nforce = \"2 N\"\n";
    let magnet = written(points).expect("a table");
    assert!((magnet.distances(2.5, ROOM)[0] - 0.25e-3).abs() < 1e-12);
    assert!(
        written(&format!("force = \"1 N\"\n{points}"))
            .expect_err("two kinds")
            .contains("2 of them")
    );
    assert!(written("source = \"none\"").expect_err("no kind").contains("one of force"));
    let unknown = magnets::load("no-such").expect_err("no such magnet").to_string();
    assert!(unknown.contains("ring-15-6-6"), "{unknown}");
}

fn hertzscope(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("hertzscope").expect("the program");
    command.args(arguments);
    command
}

#[test]
fn the_command_answers() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("magnet.svg").display().to_string();
    let output = hertzscope(&["magnet", "--preload", "2.38N", "--json", "--plot", &picture])
        .assert()
        .success()
        .get_output()
        .stdout
        .clone();
    let found: Value = serde_json::from_slice(&output).expect("JSON");
    let place = &found["places"][0];
    assert!((place["force_n"].as_f64().expect("a force") - 2.38).abs() < 1e-9);
    assert!(std::fs::read_to_string(&picture).expect("a picture").contains("2.380 N"));
    let page = hertzscope(&["magnet", "ring-12-6-6", "--distance", "-0.1mm"]).assert().success();
    let page = String::from_utf8_lossy(&page.get_output().stdout).into_owned();
    assert!(page.contains("-100.0 µm"), "{page}");
    let strong = hertzscope(&["magnet", "--preload", "100N"]).assert().success();
    let strong = String::from_utf8_lossy(&strong.get_output().stdout).into_owned();
    assert!(strong.contains("is not reached"), "{strong}");
    hertzscope(&["magnet", "no-such"]).assert().code(2);
    hertzscope(&["magnet", "--preload", "2 mm"]).assert().code(2);
}
