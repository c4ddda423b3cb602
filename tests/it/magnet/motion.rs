//! A magnet whose force follows its particle: statics, motion, energy, accuracy, and what a scene
//! can say of it.

use hertzscope::chain::{
    Chain, ChainSpec, EffectsSpec, End, LinearisedContacts, MagnetForce, MagnetLaw, MagnetPreload,
    PlacedAt, PlacedMagnet,
};
use hertzscope::experiment::bench::Bench;
use hertzscope::experiment::outcome::Summary;
use hertzscope::experiment::{Integration, run};
use hertzscope::magnet::{ForceLaw, ForceTable, Magnet, Sphere};
use hertzscope::motion::Method;
use hertzscope::scene::Scene;

use super::{ROOM, ring};
use crate::chains::{NEVER, STEEL, body, kicked};

fn scene(base: &str, more: &str) -> Scene {
    let text = format!("base = \"{base}\"\n{more}");
    Scene::from_text("s", "s.toml", &text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// The shipped ring in place of the base's constant force, and what else is said of it.
fn with_ring(base: &str, more: &str) -> Scene {
    let magnet = "[effects.magnet_preload]\nmodel = \"ring-15-6-6\"\nparticle = 1\n";
    scene(base, &format!("{magnet}{more}"))
}

fn simulate(scene: &Scene, accuracy: f64) -> Summary {
    run(scene, Integration::Accuracy(accuracy), 1, &mut |_| ()).expect("a run").summary
}

/// Slopes and energies against differences and sums of the forces, on both sides of saturation.
#[test]
fn slope_and_energy_are_those_of_the_force() {
    let field = ring(15e-3, 6e-3, 6e-3, 1.3).at(ROOM);
    for saturation in [0.3, 2.0] {
        let sphere = Sphere { radius: 2.38e-3, saturation };
        let pull = |z: f64| field.pull(z, &sphere);
        for z in [-4e-3, -0.5e-3, 0.8e-3, 2.2e-3, 3.4e-3, 5e-3] {
            let h = 1e-6;
            let slope = (8.0 * (pull(z + h) - pull(z - h)) - pull(z + 2.0 * h) + pull(z - 2.0 * h))
                / (12.0 * h);
            let off = field.pull_slope(z, &sphere) - slope;
            assert!(off.abs() < 1e-6 * slope.abs().max(100.0), "{saturation} {z}: {off:e}");
        }
        // The midpoint rule's error is h^2/24 times the force's bend, 1e-9 of the sum here;
        // saturation begins on the way.
        let (from, parts) = (1.5e-3, 20_000);
        let h = 2.5e-3 / f64::from(parts);
        let sum: f64 = (0..parts).map(|i| pull(from + h * (f64::from(i) + 0.5)) * h).sum();
        let found = field.energy(from + 2.5e-3, &sphere) - field.energy(from, &sphere);
        assert!((found / sum - 1.0).abs() < 1e-7, "{saturation}: {found:e} J, {sum:e} J");
    }
    let points = [(0.0, 4.0), (0.2e-3, 3.1), (0.5e-3, 2.2), (0.6e-3, 2.2), (1.5e-3, 0.4)];
    let table = ForceTable::new(&points).expect("a table");
    let parts = 10_000;
    let h = 2e-3 / f64::from(parts);
    let mut sum = 0.0;
    for i in 0..parts {
        // From 0.25 mm before the table to 0.25 mm behind it.
        let x = -0.25e-3 + h * f64::from(i);
        sum += h * table.held_force(x + 0.5 * h);
        let found = table.integral(x + h) - table.integral(-0.25e-3);
        assert!((found - sum).abs() < 1e-6 * 4e-3, "{x}: {found:e} {sum:e}");
        let inside = [x - 1e-9, x + 1e-9].map(|x| table.slope(x).is_some()) == [true; 2];
        if let Some(slope) = table.slope(x).filter(|_| inside) {
            let other = (table.held_force(x + 1e-9) - table.held_force(x - 1e-9)) / 2e-9;
            assert!((slope - other).abs() < 0.01 * slope.abs().max(100.0), "{x}: {slope} {other}");
        }
    }
}

/// The static state of a magnet whose distance was set before anything pressed, by Newton's method
/// on the displacement; the program looks for the force by halving.
#[test]
fn a_magnet_set_on_the_unloaded_chain_settles() {
    for gravity in [true, false] {
        let more = if gravity { "" } else { "[effects]\ngravity = false\n" };
        let found = with_ring("magnet-0.61g", &format!("distance_unloaded = \"0.6 mm\"\n{more}"));
        let chain = &found.chain;
        let (magnet, sphere) = (chain.magnet().expect("a magnet"), 2.38e-3);
        let field = ring(15e-3, 6e-3, 6e-3, 1.3).at(ROOM);
        let sphere = Sphere { radius: sphere, saturation: 2.0 };
        let pull = |sunk: f64| field.pull(3e-3 + 0.6e-3 - sunk, &sphere);
        // Below the sphere every contact bears the magnet's force and the weight of all particles
        // above it.
        let sinks = |force: f64| -> f64 {
            let mut weight = 0.0;
            let mut sum = 0.0;
            for (body, contact) in chain.bodies().iter().zip(&chain.contacts()[1..]).skip(1) {
                weight += if gravity { 9.81 * body.mass } else { 0.0 };
                sum += ((force + weight) / contact.stiffness).powf(2.0 / 3.0);
            }
            sum
        };
        let mut force = 2.0;
        for _ in 0..50 {
            let miss = |force: f64| pull(sinks(force)) - force;
            let slope = (miss(force + 1e-6) - miss(force - 1e-6)) / 2e-6;
            force -= miss(force) / slope;
        }
        println!("{} N at rest, {} m", magnet.force, sinks(force));
        assert!((magnet.force / force - 1.0).abs() < 1e-12, "{} {force}", magnet.force);
        let pulled = magnet.pull.as_ref().expect("a field");
        assert!((pulled.distance - (0.6e-3 - sinks(force))).abs() < 1e-15);
        let below = chain.contacts()[2].static_force - force;
        let weight = if gravity { 9.81 * 0.45e-3 } else { 0.0 };
        assert!((below - weight).abs() < 1e-12, "{below}");
        // As far as the chain gives, 0.2 mm and more, the force has grown by a fifth and more over
        // that at 0.6 mm.
        assert!(force > 1.2 * pull(0.0) && sinks(force) > 0.2e-3);
    }
}

/// A straight line of a table: a spring of its slope beside the contact's.
fn pinned(stiffness: f64, law: bool) -> Chain {
    let end = 5e-6 * stiffness;
    let points = [(0.995e-3, 5.0 + end), (1e-3, 5.0), (1.005e-3, 5.0 - end)];
    let law_of = ForceLaw::Measured(ForceTable::new(&points).expect("a table"));
    let magnet = Magnet { name: "line".to_owned(), source: String::new(), law: law_of };
    let placed = PlacedMagnet { magnet, temperature: ROOM, at: PlacedAt::Rest(1e-3) };
    let particle = |name: &str| body(name, 0.45e-3, Some(2.38e-3), STEEL);
    let spec = ChainSpec {
        striker: None,
        particles: vec![particle("sphere")],
        top: End::Free,
        bottom: End::Wall(STEEL),
        wall_preload: 0.0,
        effects: EffectsSpec {
            linearised_contacts: Some(LinearisedContacts),
            magnet_law: law.then_some(MagnetLaw),
            magnet_preload: Some(MagnetPreload { particle: 1, force: MagnetForce::Placed(placed) }),
            ..EffectsSpec::default()
        },
    };
    Chain::new(&spec).expect("a chain")
}

/// One sphere between a wall and a force that grows in a straight line: `x = v/w sin w t`,
/// `w^2 = (beta - k)/m`.
#[test]
fn a_straight_line_is_a_spring() {
    for (growth, law) in [(2e6, true), (-2e6, true), (2e6, false)] {
        let chain = pinned(growth, law);
        let beta = chain.contacts()[1].static_stiffness();
        let spring = if law { growth } else { 0.0 };
        let omega = ((beta - spring) / 0.45e-3).sqrt();
        for method in [
            Method::DormandPrince853 { tolerance: 1e-13 },
            Method::DormandElMikkawyPrince86 { tolerance: 1e-13 },
        ] {
            let mut bench = kicked(&chain, (0, 0.01), method, &[], NEVER);
            let before = bench.energies().0.total();
            for step in 1..=20 {
                let time = f64::from(step) * 10e-6;
                bench.run_until(time, false, &mut |_| ()).expect("a run");
                let exact = 0.01 / omega * (omega * time).sin();
                let off = (bench.state().position[0] - exact) * omega / 0.01;
                assert!(off.abs() < 1e-10, "{growth} {law} {method} {time}: {off:e}");
            }
            let after = bench.energies().1.total();
            assert!((after / before - 1.0).abs() < 1e-11, "{before:e} {after:e}");
        }
    }
}

/// Loads' energies, each apart, against the work of the forces along the way, summed by Simpson's
/// rule over the film of a run; and their sum against the static contact forces, which balance
/// them.
#[test]
fn each_load_is_booked_with_its_own_work() {
    let found = with_ring("magnet-17.81g", "force = \"2.38 N\"\n");
    let chain = &found.chain;
    let method = Method::DormandPrince853 { tolerance: 1e-13 };
    let mut bench = Bench::new(chain, &found.initial_velocities, method, &[], NEVER, NEVER);
    let before = bench.energies().0.total();
    let pull = chain.pull().expect("it follows").1;
    let (mut work, mut last) = (0.0, 0.0);
    for step in 1..=400 {
        bench.run_until(f64::from(step) * 2.5e-6, false, &mut |_| ()).expect("a run");
        let u = bench.state().position[1];
        let force = |u: f64| 2.38 + pull.change(u);
        work += (u - last) / 6.0 * (force(last) + 4.0 * force(0.5 * (u + last)) + force(u));
        last = u;
    }
    let (_, end) = bench.energies();
    let state = bench.state();
    let weight: f64 =
        chain.bodies().iter().zip(&state.position).map(|(b, u)| 9.81 * b.mass * u).sum();
    println!("the sphere sank by {last:e} m, the magnet did {work:e} J, {end:?}");
    assert!(last > 150e-6, "{last}");
    assert!((end.magnet + work).abs() < 1e-10 * work, "{:e} {work:e}", end.magnet);
    // Far from what a constant force would have done.
    assert!((work / (2.38 * last) - 1.0).abs() > 0.1);
    assert!((end.gravity + weight).abs() < 1e-14 * weight.abs() && end.end_forces == 0.0);
    assert!((end.total() / before - 1.0).abs() < 1e-11, "{:e}", end.total() / before - 1.0);
    // What balances the loads at rest knows nothing of their list.
    let plain = Scene::load("magnet-17.81g").expect("a scene");
    let end = plain.chain.energy(&state);
    let contacts = plain.chain.contacts().iter().enumerate();
    let balanced: f64 = contacts
        .map(|(j, c)| c.static_force * plain.chain.overlap_change(&state.position, j))
        .sum();
    let striker = 9.81 * plain.chain.bodies()[0].mass * state.position[0];
    let loads = end.gravity + end.magnet + end.end_forces;
    assert!((loads + balanced + striker).abs() < 1e-13 * balanced.abs(), "{loads:e} {balanced:e}");
}

#[test]
fn forces_that_press_on_the_ends_are_booked() {
    let chain = crate::chains::diatomic(5, 2.38, false);
    let method = Method::DormandPrince853 { tolerance: 1e-13 };
    let mut bench = kicked(&chain, (0, 0.3), method, &[], NEVER);
    let before = bench.energies().0.total();
    bench.run_until(0.2e-3, false, &mut |_| ()).expect("a run");
    let (state, end) = (bench.state(), bench.energies().1);
    let work = 2.38 * (state.position[0] - state.position[9]);
    assert!((end.end_forces + work).abs() < 1e-14 * work.abs() && end.magnet == 0.0);
    assert!((end.total() / before - 1.0).abs() < 1e-11);
}

const LOSSES: [&str; 3] = [
    "",
    "[effects.dashpot]\ngamma = \"0.8 N*s/m\"\nend_of_contact = \"zero_overlap\"\n",
    "[effects.dashpot]\ngamma = \"100 N*s/m\"\nend_of_contact = \"zero_overlap\"\n",
];

/// What accuracy promises holds with a magnet that follows, lossless, with losses and with stiff
/// ones; and the ledger closes.
#[test]
fn accuracy_and_ledger_hold() {
    for base in ["magnet-0.61g", "magnet-17.81g"] {
        for losses in LOSSES {
            let found = with_ring(base, &format!("force = \"2.38 N\"\n{losses}"));
            let tight = Integration::Method(Method::DormandPrince853 { tolerance: 1e-13 });
            let exact = run(&found, tight, 1, &mut |_| ()).expect("a run").summary;
            for accuracy in [1e-3, 1e-6, 1e-9] {
                let said = simulate(&found, accuracy);
                let places = || said.sensors.iter().zip(&exact.sensors);
                let mut worst = 0.0_f64;
                for (a, b) in places() {
                    let (Some(p), Some(q)) = (a.first_peak, b.first_peak) else {
                        assert_eq!(a.first_peak, b.first_peak);
                        continue;
                    };
                    let rises = a.half_rise_s.expect("a rise") / b.half_rise_s.expect("a rise");
                    for ratio in [p.dynamic_n / q.dynamic_n, p.time_s / q.time_s, rises] {
                        worst = worst.max((ratio - 1.0).abs());
                    }
                }
                println!(
                    "{base} {losses:.20} {accuracy:e}: {} {worst:.1e}, drift {:.1e}",
                    said.method, said.energy.drift
                );
                assert!(worst <= accuracy, "{base} {losses} {accuracy:e}: {worst:e}");
                let bound = 0.25 * accuracy * said.steps as f64;
                assert!(said.energy.drift.abs() < bound, "{base}: {:e}", said.energy.drift);
            }
        }
    }
}

/// A ring whose force is held is the constant force it has at rest; where it follows, the heavy
/// striker's shock has changed by percents.
#[test]
fn a_law_that_is_off_is_a_constant_force() {
    let held =
        with_ring("magnet-17.81g", "force = \"2.38 N\"\n[effects.magnet_law]\nstate = \"off\"\n");
    let (held, plain) = (simulate(&held, 1e-6), simulate(&scene("magnet-17.81g", ""), 1e-6));
    assert_eq!(held.method, plain.method);
    let follows = simulate(&with_ring("magnet-17.81g", "force = \"2.38 N\"\n"), 1e-6);
    for ((a, b), c) in held.sensors.iter().zip(&plain.sensors).zip(&follows.sensors) {
        let peak =
            |r: &hertzscope::experiment::outcome::Reading| r.first_peak.expect("a peak").dynamic_n;
        assert!((peak(a) / peak(b) - 1.0).abs() < 1e-9);
        println!("{}: {:.3} % by the law", a.name, 100.0 * (peak(c) / peak(b) - 1.0));
    }
    assert!(follows.effects.contains(&"magnet_law".to_owned()));
    assert!(!held.effects.contains(&"magnet_law".to_owned()));
    let told =
        follows.effect_settings.iter().find(|e| e.starts_with("magnet_preload")).expect("a line");
    assert!(told.contains("2.380 N at rest") && told.contains("ring-15-6-6"), "{told}");
}

#[test]
fn a_table_that_ends_is_told() {
    let measured = "base = \"gravity-17.81g\"\n[effects.magnet_preload]\nparticle = 1\ndistance = \"0.40 mm\"\n\
        [[effects.magnet_preload.measured]]\ndistance = \"0.39 mm\"\nforce = \"2.41 N\"\n\
        [[effects.magnet_preload.measured]]\ndistance = \"0.5 mm\"\nforce = \"2.05 N\"\n";
    let found = Scene::from_text("s", "s.toml", measured).expect("a scene");
    let said = simulate(&found, 1e-6);
    let note =
        said.notes.iter().find(|note| note.sentence.contains("beyond the ends of its table"));
    assert!(note.is_some(), "{:?}", said.notes);
    assert!(said.energy.drift.abs() < 1e-6 * said.steps as f64, "{:e}", said.energy.drift);
}

#[test]
fn another_force_moves_the_magnet() {
    let found = with_ring("magnet-0.61g", "force = \"2.38 N\"\n");
    let moved = found.altered(None, None, Some(3.0)).expect("a chain");
    let (before, after) = (found.chain.magnet().expect("one"), moved.chain.magnet().expect("one"));
    assert!((after.force - 3.0).abs() < 1e-9);
    let distance = |m: &hertzscope::chain::ChainMagnet| m.pull.as_ref().expect("a field").distance;
    assert!((0.0..distance(before)).contains(&distance(after)), "{}", distance(after));
    assert!(found.altered(None, None, Some(100.0)).is_err());
    assert_eq!(found.altered(None, None, Some(before.force)).expect("the same").spec, found.spec);
}

#[test]
fn mistakes_are_told_at_their_place() {
    let wrong = |more: &str| {
        let magnet = "[effects.magnet_preload]\nmodel = \"ring-15-6-6\"\nparticle = 1\n";
        let text = format!("base = \"magnet-0.61g\"\n{magnet}{more}");
        Scene::from_text("s", "s.toml", &text).expect_err("a mistake").to_string()
    };
    let nowhere = wrong("");
    assert!(nowhere.contains("one of distance") && nowhere.contains("none of them"), "{nowhere}");
    let twice = wrong("distance = \"0.4 mm\"\nforce = \"2 N\"\n");
    assert!(twice.contains("distance and force"), "{twice}");
    assert!(wrong("force = \"100 N\"\n").contains("reaches nowhere"));
    assert!(wrong("distance = \"0.4 mm\"\ntemperature = \"-300 °C\"\n").contains("temperature"));
    let constant =
        Scene::from_text("s", "s.toml", "base = \"magnet-0.61g\"\n[effects.magnet_law]\n");
    assert!(constant.expect_err("a constant").to_string().contains("constant force"));
    let far = wrong(
        "distance = \"0.4 mm\"\n[[effects.magnet_preload.measured]]\ndistance = \"0 mm\"\nforce = \"1 N\"\n",
    );
    assert!(far.contains("one of them"), "{far}");
    // A table so steep that the chain's contacts do not hold against it.
    let steep = "base = \"gravity-0.61g\"\n[effects.magnet_preload]\nparticle = 1\ndistance = \"0.1 mm\"\n\
        [[effects.magnet_preload.measured]]\ndistance = \"0 mm\"\nforce = \"7 N\"\n\
        [[effects.magnet_preload.measured]]\ndistance = \"0.2 mm\"\nforce = \"1 N\"\n";
    let steep = Scene::from_text("s", "s.toml", steep).expect_err("unstable").to_string();
    assert!(steep.contains(":4:") && steep.contains("unstable equilibrium"), "{steep}");
    let beyond = steep_at("0.3 mm");
    assert!(beyond.contains("outside the magnet's force table"), "{beyond}");
}

fn steep_at(distance: &str) -> String {
    let text = format!(
        "base = \"gravity-0.61g\"\n[effects.magnet_preload]\nparticle = 1\ndistance = \"{distance}\"\n\
         [[effects.magnet_preload.measured]]\ndistance = \"0 mm\"\nforce = \"2 N\"\n\
         [[effects.magnet_preload.measured]]\ndistance = \"0.2 mm\"\nforce = \"1.9 N\"\n"
    );
    Scene::from_text("s", "s.toml", &text).expect_err("beyond").to_string()
}
