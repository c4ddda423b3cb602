//! The bench behind the scope: what clients can turn, and what they cannot break.

use std::time::Duration;

use hertzscope::scene::Scene;
use hertzscope::server::ServerOptions;

use super::process::Process;
use super::{Client, IDENTITY, Server, connect, scene};

/// Highest voltage of channel 1 after an impact (V).
fn highest(server: &Server, settings: &str) -> f64 {
    let mut client = server.connect();
    client.send(format!("{settings}\nACQ:STOPA SEQ;STATE ON;:BENC:IMP\n").as_bytes());
    assert_eq!(client.ask("*OPC?"), "1\n");
    let reply = client.ask("MEASU:IMM:SOU CH1;TYP MAXI;VAL?");
    reply.trim_end().parse().expect("a voltage")
}

/// A sonic vacuum's force scales with speed^(6/5); preload makes it gentler, towards speed itself.
/// The scale leaves room.
#[test]
fn a_faster_striker_hits_harder() {
    let server = Server::at_rest();
    let settings = "CH1:SCALE 2;POSITION 0;:TRIG:MAI:LEV 0.5";
    let usual = highest(&server, settings);
    let fast = highest(&server, &format!("{settings};:BENC:STRI:SPE 0.88"));
    assert!((2.0..2.0_f64.powf(1.2) * 1.1).contains(&(fast / usual)), "{usual} V, {fast} V");
    let light = highest(&server, &format!("{settings};:BENC:STRI:SPE 0.44;MASS 3E-4"));
    assert!(light < 0.9 * usual, "{light} V, {usual} V");
}

#[test]
fn the_bench_tells_how_it_is_set_up() {
    let server = Server::at_rest();
    let mut client = server.connect();
    assert_eq!(client.ask("BENC?"), "0;6.1E-4;4.4E-1;2.38E0;\"magnet-0.61g\"\n");
    // Clamped, as numbers are everywhere.
    assert_eq!(client.ask("BENC:STRI:MASS 5;SPE 1E9;:BENC:STRI?"), "1.0E-1;1.0E1\n");
    assert_eq!(client.ask("BENC:MAGN:FORC 1.19;FORC?"), "1.19E0\n");
    assert_eq!(client.ask("HEAD ON;:BENC:SCEN?"), ":BENCH:SCENE \"magnet-0.61g\"\n");
    client.send(b"HEAD OFF\n");
    // Another scene brings its own striker; this one has no magnet.
    assert_eq!(client.ask("BENC:SCEN GRAVITY-2.75G;SCEN?"), "\"gravity-2.75g\"\n");
    assert_eq!(client.ask("BENC:STRI:MASS?"), "2.75E-3\n");
    client.send(b"*CLS;:BENC:MAGN:FORC 1\n");
    assert_eq!(client.ask("*ESR?;EVENT?"), "16;221\n");
    // A path is no scene: clients open no files.
    for name in ["\"/etc/passwd\"", "../magnet-0.61g", "\"\""] {
        client.send(format!("*CLS;:BENC:SCEN {name}\n").as_bytes());
        assert_eq!(client.ask("*ESR?;EVENT?"), "16;224\n", "{name}");
    }
    assert_eq!(client.ask("BENC:SCEN magnet-0.61g;:BENC:STRI:MASS?;SPE?"), "6.1E-4;4.4E-1\n");
}

/// Half a volt at the amplifier is half a volt on the screen, to half a level of the digitiser
/// (0.04 V at 1 V/div).
#[test]
fn the_scene_s_amplifier_offset_is_on_the_screen() {
    let mut scene = scene();
    for channel in scene.scope.channels.iter_mut().flatten() {
        channel.offset = 0.5;
    }
    let server = Server::of(scene);
    let mut client = server.connect();
    client.send(b"CH1:SCALE 1;POSITION 0;:TRIG:MAI:MOD AUTO;:ACQ:STOPA SEQ;STATE ON\n");
    assert_eq!(client.ask("*OPC?"), "1\n");
    let mean: f64 =
        client.ask("MEASU:IMM:SOU CH1;TYP MEAN;VAL?").trim_end().parse().expect("volts");
    assert!((mean - 0.5).abs() < 0.02, "{mean} V");
}

/// Speeds are drawn from the seed, shot by shot: alike with the same seed, spread as the scene
/// says.
#[test]
fn the_strikers_speed_is_drawn_from_the_seed() {
    let typed = "base = \"magnet-0.61g\"\n[effects.striker_speed_spread]\nrelative = \"0.5 %\"\n";
    let scene = Scene::from_text("spread", "spread.toml", typed).expect("a scene");
    let speeds =
        |scene: &Scene| -> Vec<f64> { (1..=4000).map(|n| scene.velocities(n)[0]).collect() };
    let drawn = speeds(&scene);
    assert_eq!(drawn, speeds(&scene));
    let count = drawn.len() as f64;
    let mean = drawn.iter().sum::<f64>() / count;
    let variance = drawn.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
    // Four standard errors: of the mean 0.005 / sqrt(4000), of the standard deviation 1 / sqrt(2 *
    // 4000).
    let speed = scene.striker_speed().expect("a striker");
    assert!((mean / speed - 1.0).abs() < 4.0 * 0.005 / count.sqrt(), "{mean}");
    let spread = variance.sqrt() / mean;
    assert!((spread / 0.005 - 1.0).abs() < 4.0 / (2.0 * count).sqrt(), "{spread}");
    let mut other = scene.clone();
    other.seed += 1;
    assert_ne!(speeds(&other), drawn);
    let still = Scene::load("magnet-0.61g").expect("it ships");
    assert!(speeds(&still).iter().all(|v| *v == speed));
}

/// The time base turns while impacts are simulated for the old one: once the server then asked for
/// 40 GB and ended. It has 4 GB here.
#[cfg(target_os = "linux")]
#[test]
fn time_bases_turn_while_the_chain_moves() {
    let mut process = Process::start_within(4_000_000, &["magnet-0.61g"]);
    let mut client = connect(process.address);
    client.send(b"TRIG:MAI:MODE AUTO\n");
    for turn in 0..30 {
        let slow = ["HOR:SCA 1", "HOR:SCA 50", "HOR:SCA 2.5E-3"][turn % 3];
        let turned =
            ["HOR:SCA 5E-9", "RECA:SETU FACTORY", "*RST", "HOR:SCA 5E-9;POS 1E-6"][turn % 4];
        client.send(format!("{slow}\n").as_bytes());
        std::thread::sleep(Duration::from_millis(60));
        client.send(format!("BENC:IMP\n{turned}\n").as_bytes());
        assert_eq!(client.ask("*IDN?"), IDENTITY, "{slow}, {turned}");
    }
    // It still measures.
    client.send(
        b"*RST;:HOR:SCA 2.5E-4;:CH1:SCA 1;:TRIG:MAI:MOD NORM;LEV 0.5;:ACQ:STOPA SEQ;STATE RUN\n",
    );
    std::thread::sleep(Duration::from_millis(60));
    client.send(b"BENC:IMP\n");
    assert_eq!(client.ask("*OPC?"), "1\n");
    assert!(process.child.try_wait().expect("a child").is_none(), "the server lives");
}

/// With `--read-only` no client changes the bench, with `--no-faults` none switches a fault on; the
/// oscilloscope is everybody's.
#[test]
fn access_to_the_bench_is_limited() {
    use hertzscope::instrument::BenchAccess;
    let changes = [
        "BENC:IMP",
        "BENC:STRI:MASS 1E-3",
        "BENC:STRI:SPE 1",
        "BENC:MAGN:FORC 1",
        "BENC:SCEN gravity-0.61g",
    ];
    for (access, refused) in [(BenchAccess::ReadOnly, true), (BenchAccess::NoFaults, false)] {
        let server = Server::with(ServerOptions { access, ..ServerOptions::default() });
        let mut client = server.connect();
        let before = client.ask("BENC?;:BENC:FAU?");
        for change in changes {
            client.send(format!("*CLS;:{change}\n").as_bytes());
            let expected = if refused { "16;241\n" } else { "0;0\n" };
            assert_eq!(client.ask("*ESR?;EVENT?"), expected, "{change}");
        }
        client.send(b"*CLS;:BENC:FAU \"late=1s\"\n");
        assert_eq!(client.ask("*ESR?;EVENT?"), "16;241\n");
        if refused {
            assert_eq!(client.ask("BENC?;:BENC:FAU?"), before);
        }
        assert_eq!(client.ask("CH1:SCA 2;SCA?"), "2.0E0\n");
    }
}

/// An impact whose records are made again, because a setting was changed during it, is one impact.
#[test]
fn an_impact_counts_once_however_often_it_is_recorded() {
    let server = Server::at_rest();
    let mut client = server.connect();
    let impacts = |client: &mut Client| -> u32 {
        client.ask("BENC:IMP?").trim_end().parse().expect("a count")
    };
    client.send(b"ACQ:STOPA SEQ;STATE ON\n");
    for number in 1..=8 {
        // The strike is made at once, and the scale is set during it. That starts the acquisition
        // again: it may be ready for the impact or not. The impact before may have ended it.
        loop {
            match client.ask("TRIG:STATE?").trim_end() {
                "READY" => break,
                "SAVE" => client.send(b"ACQ:STOPA SEQ;STATE ON\n"),
                _ => {}
            }
        }
        assert_eq!(impacts(&mut client), number - 1);
        client.send(format!("BENC:IMP\nCH1:SCA {}\n", 1 + number % 2).as_bytes());
        while impacts(&mut client) < number {}
    }
}
