//! The effects ledger: what it says against runs made apart from it, and effects that are off
//! against effects that are not there.

use hertzscope::experiment::auto_effects::{change_upper_bound, resolve_auto_effects};
use hertzscope::experiment::outcome::{Reading, Summary};
use hertzscope::experiment::{Integration, Outcome, run};
use hertzscope::motion::Method;
use hertzscope::scene::Scene;
use hertzscope::studies::effects::{
    Change, EffectState, EffectVerdict, Ledger, LedgerEntry, ledger,
};

/// Two runs by one method at a tolerance of 1e-14 agree to this where nothing differs (1).
const SAME: f64 = 1e-9;

fn scene(base: &str, more: &str) -> Scene {
    let text = format!("base = \"{base}\"\n{more}");
    Scene::from_text("s", "s.toml", &text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn simulate(scene: &Scene, accuracy: f64) -> Outcome {
    run(scene, Integration::Accuracy(accuracy), 1, &mut |_| ()).expect("a run")
}

fn entry<'a>(ledger: &'a Ledger, name: &str) -> &'a LedgerEntry {
    ledger.entries.iter().find(|entry| entry.effect == name).expect("an entry")
}

/// Largest relative changes of first peaks and half-rises.
fn change(with: &Summary, without: &Summary) -> (f64, f64) {
    let places = |s: &Summary| s.sensors.iter().chain(&s.wall).cloned().collect::<Vec<_>>();
    let mut most = (0.0_f64, 0.0_f64);
    for (a, b) in places(with).iter().zip(&places(without)) {
        let (Some(p), Some(q)) = (a.first_peak, b.first_peak) else { continue };
        let larger = |x: f64, y: f64| if y.abs() > x.abs() { y } else { x };
        most.0 = larger(most.0, p.dynamic_n / q.dynamic_n - 1.0);
        most.1 = larger(most.1, a.half_rise_s.unwrap() / b.half_rise_s.unwrap() - 1.0);
    }
    most
}

#[test]
fn what_an_effect_changes_is_what_two_runs_say() {
    let bench = scene("magnet-0.61g", "");
    let found = ledger(&bench, 1e-6, &mut |_| ()).expect("a ledger");
    let on = simulate(&bench, 1e-9).summary;
    let off = simulate(&scene("magnet-0.61g", "[effects]\ngravity = false\n"), 1e-9).summary;
    let said = entry(&found, "gravity").change.expect("a trial");
    let (peak, arrival) = change(&on, &off);
    assert!((said.peak.unwrap() - peak).abs() < 4e-6, "{said:?} {peak}");
    assert!((said.arrival.unwrap() - arrival).abs() < 4e-6, "{said:?} {arrival}");
    assert_eq!(entry(&found, "gravity").state, EffectState::On);
    // The chain of the paper: 0.45 + 19 x 0.1226 + 18 x 0.485 g under 9.81 m/s2, against waves of
    // newtons.
    let weight = (0.45 + 19.0 * 0.1226 + 18.0 * 0.485) * 1e-3 * 9.81;
    let value = entry(&found, "gravity").value.expect("a value");
    let weakest = on.sensors.iter().map(|s| s.first_peak.unwrap().dynamic_n).fold(9e9, f64::min);
    assert!((value / (weight / weakest) - 1.0).abs() < 1e-5, "{value}");
    // 5A with 710 pF droops with 1 ms: single pulses read 4 to 12 % low.
    let droop = entry(&found, "sensor_droop").change.expect("a trial").peak.expect("a peak");
    assert!(droop < -0.02 && droop > -0.15, "{droop}");
    // Where nothing is known of a value, none is made up.
    for name in ["dashpot", "kuwabara_kono", "power_law_loss", "scope_offset", "sensor_offset"] {
        let entry = entry(&found, name);
        assert!(entry.state == EffectState::Off && entry.change.is_none(), "{entry:?}");
        assert!(entry.reason.contains("needs"), "{}", entry.reason);
    }
    assert_eq!(entry(&found, "gravity").verdict, EffectVerdict::Needed);
    assert_eq!(entry(&found, "plasticity").verdict, EffectVerdict::LeftOut);
    assert_eq!(entry(&found, "dashpot").verdict, EffectVerdict::NoValue);
    let levels = entry(&found, "quantisation").change.expect("a trial").peak_lsb.expect("levels");
    assert!(levels.abs() <= 0.5 + 1e-9, "{levels}");
    // 100 MHz against a sample every microsecond.
    let delay = 1.0 / (std::f64::consts::TAU * 100e6 * 1e-6);
    assert!((entry(&found, "bandwidth").value.unwrap() / delay - 1.0).abs() < 1e-9);
}

/// In a sonic vacuum forces go as the speed to the power 6/5 and times to the power -1/5, whatever
/// the speed is: Nesterenko, J. Appl. Mech. Tech. Phys. 24, 733 (1983).
#[test]
fn a_spread_of_speeds_changes_what_one_standard_deviation_does() {
    let spread = 0.05_f64;
    let table = format!("[effects.striker_speed_spread]\nrelative = \"{} %\"\n", 1e2 * spread);
    let found = ledger(&scene("monatomic-vacuum", &table), 1e-7, &mut |_| ()).expect("a ledger");
    let entry = entry(&found, "striker_speed_spread");
    let Change { peak, arrival, .. } = entry.change.expect("a trial");
    assert!((peak.expect("a peak") - ((1.0 + spread).powf(1.2) - 1.0)).abs() < 1e-6, "{peak:?}");
    let expected = (1.0 + spread).powf(-0.2) - 1.0;
    assert!((arrival.expect("a rise") - expected).abs() < 1e-6, "{arrival:?}");
    assert!(
        (entry.value.expect("a spread") - spread).abs() < 1e-12 && entry.state == EffectState::On
    );
}

/// Host masses, plates off centre and a loss, all with values: a line each that is on and has been
/// measured.
#[test]
fn what_is_on_is_measured() {
    let more = "[effects.dashpot]\ngamma = \"0.8 N*s/m\"\nend_of_contact = \"zero_force\"\n\
        [effects.scope_errors]\n[effects.sensor_tolerance]\nspread = \"20 %\"\n\
        [sensors.p14]\noffset = 0.1\nhost_mass = \"0.13 g\"\n[scope.ch1]\noffset = \"10 mV\"\n";
    let bench = scene("magnet-0.61g", more);
    let found = ledger(&bench, 1e-3, &mut |_| ()).expect("a ledger");
    for name in [
        "dashpot",
        "host_mass",
        "sensor_offset",
        "scope_errors",
        "sensor_tolerance",
        "scope_offset",
    ] {
        let entry = entry(&found, name);
        assert_eq!(entry.state, EffectState::On, "{entry:?}");
        let change = entry.change.expect("a trial");
        assert!(change.peak.expect("a peak") != 0.0, "{entry:?}");
        assert!(entry.run_times.is_some_and(|times| times.with_s > 0.0 && times.without_s > 0.0));
    }
    assert_eq!(entry(&found, "dashpot").verdict, EffectVerdict::Needed);
    // It changes speeds by 7e-4.
    assert_eq!(entry(&found, "host_mass").verdict, EffectVerdict::NoEffect);
    assert!((entry(&found, "host_mass").value.unwrap() - (0.13 / 0.1226 - 1.0)).abs() < 1e-12);
}

/// Plates within 20 % of both constants, evenly: 95 % of the largest changes of four first peaks,
/// by draws of a linear congruence, whatever the scene's seed is. One draw was 13.3 % with the
/// scene's own seed.
#[test]
fn effects_of_chance_do_not_go_by_one_draw() {
    let mut state = 3_u64;
    let mut even = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        2.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
    };
    // d33 over the capacitances of plate, cable and input, 1017 pF, of which the ceramic's are 287
    // pF.
    let mut change = || (1.0 + 0.2 * even()) / (1.0 + 0.2 * 287.0 / 1017.0 * even()) - 1.0;
    let mut largest: Vec<f64> =
        (0..20_000).map(|_| (0..4).map(|_| change().abs()).fold(0.0, f64::max)).collect();
    largest.sort_by(f64::total_cmp);
    let expected = largest[19_000];
    for seed in [1, 2, 3] {
        let bench =
            Scene { seed, ..scene("magnet-0.61g", "[effects.scope_noise]\nrms = \"0 div\"\n") };
        let found = ledger(&bench, 1e-3, &mut |_| ()).expect("a ledger");
        let line = entry(&found, "sensor_tolerance");
        let peak = line.change.expect("a trial").peak.expect("a peak");
        println!("seed {seed}: {peak}, expected {expected}");
        // The quantile of 100 draws scatters by 4 %.
        assert!(line.is_drawn && (peak / expected - 1.0).abs() < 0.15, "{peak} {expected}");
    }
}

/// Largest relative change of first peaks, and of all arrivals that an accuracy holds for.
fn largest_change(with: &Summary, without: &Summary) -> f64 {
    let places = |s: &Summary| s.sensors.iter().chain(&s.wall).cloned().collect::<Vec<_>>();
    let values = |r: &Reading| {
        let peak = r.first_peak.expect("a peak");
        let arrivals = [Some(peak.time_s), r.half_rise_s, r.ten_percent_s];
        [Some(peak.dynamic_n)].into_iter().chain(arrivals).map(|v| v.expect("a value")).collect()
    };
    let mut most = 0.0_f64;
    for (a, b) in places(with).iter().zip(&places(without)) {
        assert_eq!(a.first_peak.is_some(), b.first_peak.is_some(), "{a:?}, {b:?}");
        if a.first_peak.is_none() {
            continue;
        }
        let (a, b): (Vec<f64>, Vec<f64>) = (values(a), values(b));
        most = a.iter().zip(&b).fold(most, |most, (a, b)| most.max((a / b - 1.0).abs()));
    }
    most
}

/// The same method with and without losses: its own error is the same, too.
fn by_one_method(scene: &Scene) -> Summary {
    let method = Integration::Method(Method::DormandPrince853 { tolerance: 1e-14 });
    run(scene, method, 1, &mut |_| ()).expect("a run").summary
}

/// Two equal spheres that meet at twice the speed of each, with a loss of this force at 1 m/s (N)
/// that goes as the fifth power of that.
fn head_on(force: f64) -> Scene {
    let text = format!(
        "
        duration = \"30 us\"
        particles.ball = {{ material = \"ptfe\", diameter = \"4.76 mm\", mass = \"0.1226 g\" }}
        chain = {{ top = \"free\", bottom = \"free\", segments = [{{ particles = [\"ball\", \"ball\"] }}] }}
        initial_velocities = [{{ particle = 1, velocity = \"0.5 m/s\" }}, {{ particle = 2, velocity = \"-0.5 m/s\" }}]
        sensors.s = {{ model = \"pzt-5a-710pf\", particle = 1, offset = 0.5 }}
        [effects.power_law_loss]
        state = \"auto\"
        force_at_1_m_per_s = \"{force:e} N\"
        exponent = 5
        end_of_contact = \"zero_overlap\"
        [scope]
        model = \"tds2014\"
        time_base = \"2.5 us/div\"
        position = \"7.5 us\"
        trigger = {{ source = \"CH1\", level = \"100 mV\", slope = \"rise\", mode = \"auto\" }}
        ch1 = {{ input = \"s\", scale = \"1 V/div\" }}
        "
    );
    Scene::from_text("head-on", "head-on.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// Scenes in which an effect may or may not be seen.
fn left_to_accuracy() -> Vec<(&'static str, Scene)> {
    let mut scenes = Vec::new();
    let loss = |base: &str, name: &str, key: &str, value: &str, end: &str| {
        scene(
            base,
            &format!(
                "[effects.{name}]\nstate = \"auto\"\n{key} = \"{value}\"\nend_of_contact = \"{end}\"\n"
            ),
        )
    };
    for (base, end) in [
        ("magnet-0.61g", "zero_force"),
        ("gravity-2.75g", "zero_overlap"),
        ("monatomic-vacuum", "zero_force"),
    ] {
        for gamma in ["1e-9 N*s/m", "1e-7 N*s/m", "1e-5 N*s/m", "1e-2 N*s/m"] {
            scenes.push(("dashpot", loss(base, "dashpot", "gamma", gamma, end)));
        }
        for eta in ["1e-18 s", "1e-15 s", "1e-12 s", "1e-8 s"] {
            scenes.push(("kuwabara_kono", loss(base, "kuwabara_kono", "eta", eta, end)));
        }
        for force in ["1e-9 N", "1e-6 N", "1e-3 N"] {
            let key = "exponent = 1.5\nforce_at_1_m_per_s";
            scenes.push(("power_law_loss", loss(base, "power_law_loss", key, force, end)));
        }
    }
    // Over so soon that what a loss itself is felt by is more than what it does to the motion.
    for (duration, gamma) in [("10 us", 0.025), ("10 us", 0.005), ("20 us", 0.012)] {
        let more = format!(
            "duration = \"{duration}\"\n[effects.dashpot]\nstate = \"auto\"\ngamma = \"{gamma} N*s/m\"\nend_of_contact = \"zero_overlap\"\n[scope]\nposition = \"5 us\"\ntime_base = \"2.5 us/div\"\n"
        );
        scenes.push(("dashpot", scene("momentum-test", &more)));
    }
    scenes.extend([1e-2, 1e-4, 1e-5].map(|force| ("power_law_loss", head_on(force))));
    for acceleration in ["1e-9 m/s^2", "1e-6 m/s^2", "1e-3 m/s^2", "9.81 m/s^2"] {
        let more =
            format!("[effects.gravity]\nstate = \"auto\"\nacceleration = \"{acceleration}\"\n");
        scenes.push(("gravity", scene("magnet-0.61g", &more)));
        scenes.push(("gravity", scene("gravity-0.61g", &more)));
    }
    // A magnet whose force changes by this much a metre (N/m).
    for slope in [1e-6, 1e-4, 1e-3, 10.0] {
        let row = |distance: f64| {
            let force = 2.38 - slope * distance;
            format!(
                "[[effects.magnet_preload.measured]]\ndistance = \"{distance:e} m\"\nforce = \"{force:.17} N\"\n"
            )
        };
        let more = format!(
            "[effects.magnet_law]\nstate = \"auto\"\n[effects.magnet_preload]\nparticle = 1\ndistance = \"0 mm\"\n{}{}",
            row(-5e-3),
            row(5e-3)
        );
        scenes.push(("magnet_law", scene("gravity-0.61g", &more)));
        scenes.push(("magnet_law", scene("gravity-17.81g", &more)));
    }
    scenes
}

/// A magnet's law: what the ledger says is what two runs say, on where the scene has a ring, and
/// against a ring where it has a force.
#[test]
fn a_magnets_law_is_measured() {
    let magnet =
        "[effects.magnet_preload]\nmodel = \"ring-15-6-6\"\nparticle = 1\nforce = \"2.38 N\"\n";
    let (ring, constant) = (scene("magnet-17.81g", magnet), scene("magnet-17.81g", ""));
    let (on, off) = (simulate(&ring, 1e-9).summary, simulate(&constant, 1e-9).summary);
    let (peak, arrival) = change(&on, &off);
    println!("{peak:e} {arrival:e}");
    assert!(peak.abs() > 1e-3);
    for (bench, state) in [(&ring, EffectState::On), (&constant, EffectState::Off)] {
        let found = ledger(bench, 1e-6, &mut |_| ()).expect("a ledger");
        let entry = entry(&found, "magnet_law");
        assert_eq!(entry.state, state);
        let said = entry.change.expect("a trial");
        assert!((said.peak.unwrap() - peak).abs() < 4e-6, "{said:?} {peak}");
        assert!((said.arrival.unwrap() - arrival).abs() < 4e-6, "{said:?} {arrival}");
        // 3.3 N/mm, and 215 um of travel.
        let value = entry.value.expect("a value");
        assert!((0.2..0.35).contains(&value), "{value}");
    }
}

#[test]
fn auto_leaves_out_only_what_cannot_be_seen() {
    let (mut out, mut kept) = (0, 0);
    for (name, scene) in left_to_accuracy() {
        let most = change_upper_bound(&scene, name);
        let mut measured = None;
        for accuracy in [1e-2, 1e-3, 1e-6] {
            let settled = resolve_auto_effects(&scene, Integration::Accuracy(accuracy));
            let told = settled.notes.iter().filter(|note| note.code == "auto_effect");
            assert_eq!((settled.auto.len(), told.count()), (0, 1));
            if settled.spec == scene.spec {
                kept += 1;
                assert!(most >= 0.1 * accuracy);
                continue;
            }
            out += 1;
            // Both sides tighter than what is to be told apart.
            let change = *measured.get_or_insert_with(|| {
                let on = Scene { auto: Vec::new(), ..scene.clone() };
                largest_change(&by_one_method(&on), &by_one_method(&settled))
            });
            assert!(change < 0.1 * accuracy, "{name}: {change:e}");
            // And below what was change_upper_bound, as far as two runs can tell.
            assert!(change < most + SAME, "{name}: {change:e}, {most:e}");
        }
    }
    assert!(out >= 20 && kept >= 10, "{out} left out, {kept} kept");
}

/// The same motion, bit for bit, by the same number of evaluations: an effect that is off is no
/// part of what is integrated.
#[test]
fn an_effect_that_is_off_is_as_if_it_were_not_there() {
    let dashpot = "gamma = \"0.8 N*s/m\"\nend_of_contact = \"zero_force\"\n";
    let plain = simulate(&scene("magnet-0.61g", ""), 1e-6);
    for (more, accuracy) in [
        (format!("[effects.dashpot]\nstate = \"off\"\n{dashpot}"), 1e-6),
        ("[effects.contact_law]\nstate = \"off\"\nexponent = 1.2\nforce = \"1 N\"\noverlap = \"1 um\"\n".to_owned(), 1e-6),
        (format!("[effects.dashpot]\nstate = \"auto\"\n{}", dashpot.replace("0.8", "1e-12")), 1e-6),
        ("[effects.kuwabara_kono]\nstate = \"off\"\neta = \"1 us\"\nend_of_contact = \"zero_force\"\n[effects.scope_errors]\nstate = \"off\"\n[effects.sensor_tolerance]\nstate = \"off\"\nspread = \"20 %\"\n[effects.linearised_contacts]\nstate = \"off\"\n".to_owned(), 1e-6),
        ("[effects.striker_speed_spread]\nstate = \"off\"\nrelative = \"5 %\"\n".to_owned(), 1e-6),
    ] {
        let found = simulate(&scene("magnet-0.61g", &more), accuracy);
        assert_eq!(found.shot, plain.shot, "{more}");
        let work = |s: &Summary| (s.method.clone(), s.force_evaluations, s.steps, s.rejected_steps);
        assert_eq!(work(&found.summary), work(&plain.summary), "{more}");
        assert_eq!(found.summary.sensors, plain.summary.sensors);
        assert_eq!(found.summary.energy, plain.summary.energy);
        assert_eq!(found.summary.effects, plain.summary.effects);
    }
    let gravity = "[effects.gravity]\nstate = \"off\"\nacceleration = \"9.81 m/s^2\"\n";
    let absent = simulate(&scene("magnet-0.61g", "[effects]\ngravity = false\n"), 1e-6);
    assert_eq!(simulate(&scene("magnet-0.61g", gravity), 1e-6).shot, absent.shot);
}

#[test]
fn a_state_is_one_of_its_words_and_mistakes_behind_it_are_told() {
    let wrong = |more: &str| {
        let text = format!("base = \"magnet-0.61g\"\n{more}");
        Scene::from_text("s", "s.toml", &text).expect_err("a mistake").to_string()
    };
    // Everything that a scene may switch, by its table.
    for name in [
        "contact_law",
        "dashpot",
        "gravity",
        "kuwabara_kono",
        "linearised_contacts",
        "magnet_law",
        "magnet_preload",
        "power_law_loss",
        "scope_errors",
        "scope_noise",
        "sensor_tolerance",
        "striker_speed_spread",
    ] {
        let told = wrong(&format!("[effects.{name}]\nstate = \"maybe\"\n"));
        assert!(told.contains("\"maybe\"") && told.contains("\"off\""), "{name}: {told}");
    }
    assert!(wrong("[effects.gravity]\nstate = \"maybe\"\n").contains("auto"));
    let magnet = wrong("[effects.magnet_preload]\nstate = \"auto\"\n");
    assert!(magnet.contains("expected one of \"on\", \"off\""), "{magnet}");
    assert!(
        wrong("[effects.gravity]\nstate = \"off\"\nacceleration = \"9.81 m\"\n")
            .contains("acceleration")
    );
}

#[test]
fn the_ledger_tells_what_auto_decided() {
    let text = "[effects.dashpot]\nstate = \"auto\"\ngamma = \"1e-12 N*s/m\"\nend_of_contact = \"zero_force\"\n";
    let found = ledger(&scene("magnet-0.61g", text), 1e-3, &mut |_| ()).expect("a ledger");
    let dashpot = entry(&found, "dashpot");
    assert_eq!(dashpot.state, EffectState::Auto);
    assert!(
        dashpot.reason.starts_with("dashpot is off: it would change readings"),
        "{}",
        dashpot.reason
    );
}
