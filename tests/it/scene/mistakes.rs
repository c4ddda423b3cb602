//! Keys, units and numbers, and the chain: one mistake at a time.

use super::{all_told, bench_with, load, problems};

#[test]
fn keys_that_do_not_exist() {
    all_told(&[
        ["title =", "¦titel =", "titel", "unknown key `titel`", "title"],
        ["[striker]\n", "[striker]\n¦masse = 1\n", "striker.masse", "unknown key `masse`", "mass"],
        ["repeat = 19", "repeat = 19\n¦times = 2", "chain.segments.1.times", "`times`", "repeat"],
        [
            "[effects.gravity]",
            "[effects.¦friction]\n\n[effects.gravity]",
            "effects.friction",
            "`friction`",
            "gravity",
        ],
        ["probe = 1\n", "probe = 1\n¦gain = 1\n", "scope.ch1.gain", "`gain`", "scale"],
        ["slope =", "¦edge =", "scope.trigger.edge", "`edge`", "slope"],
        ["[sensors.p3]\n", "[sensors.p3]\n¦size = 1\n", "sensors.p3.size", "`size`", "side"],
        [
            "[materials.plastic]\n",
            "[materials.plastic]\n¦colour = 1\n",
            "materials.plastic.colour",
            "`colour`",
            "youngs_modulus",
        ],
        [
            "[particles.can]\n",
            "[particles.can]\n¦width = 1\n",
            "particles.can.width",
            "`width`",
            "diameter",
        ],
        [
            "{ wall = \"stainless_steel\" }",
            "{ wall = \"stainless_steel\", ¦door = 1 }",
            "chain.bottom.door",
            "`door`",
            "wall",
        ],
    ]);
}

#[test]
fn keys_that_are_missing() {
    all_told(
        &[
            ["duration = \"2 ms\"\n", "", "duration", "no such key", "a time (s) above zero"],
            [
                "[striker]\nmaterial = \"alumina\"\nmass = \"0.61 g\"",
                "¦[striker]\nmaterial = \"alumina\"",
                "striker.mass",
                "no such key",
                "a mass (kg)",
            ],
            [
                "[particles.can]\nmaterial = \"stainless_steel\"\n",
                "¦[particles.can]\n",
                "particles.can.material",
                "no such key",
                "a material",
            ],
            ["[chain]\ntop = \"free\"", "¦[chain]", "chain.top", "no such key", "\"free\""],
            ["particles = [\"ball\"]", "", "chain.segments.2.particles", "no particles", "a list"],
            ["side = \"3 mm\"\n", "", "sensors.p14.side", "no such key", "a length (m)"],
            ["particle = 14\n", "", "sensors.p14.particle", "no such key", "from 1 to 39"],
            ["time_base = \"250 us/div\"\n", "", "scope.time_base", "no such key", "a time base"],
            ["source = \"CH1\"\n", "", "scope.trigger.source", "no such key", "\"CH1\""],
            ["level = \"200 mV\"\n", "", "scope.trigger.level", "no such key", "a voltage (V)"],
            [
                "input = \"p14\"\nscale = \"1 V/div\"",
                "input = \"p14\"",
                "scope.ch2.scale",
                "no such key",
                "a vertical scale",
            ],
            ["model = \"tds2014\"\n", "", "scope.model", "no such key", "oscilloscope"],
        ]
        .map(marked_at_its_table)
        .each_ref()
        .map(|row| row.each_ref().map(String::as_str)),
    );
}

/// A row without a mark expects the problem where the table of its key begins.
fn marked_at_its_table(row: [&str; 5]) -> [String; 5] {
    let [old, new, key, found, expected] = row;
    let owned = [old, new, key, found, expected].map(str::to_owned);
    if new.contains(super::MARK) {
        return owned;
    }
    // The lines from the table's heading to what is replaced.
    let at = super::BENCH.find(old).expect("the old text");
    let before = &super::BENCH[..at];
    let heading = before.rfind("\n[").map_or(0, |line_end| line_end + 1);
    let heading = if before.contains("\n[") { heading } else { 0 };
    let lead = &before[heading..];
    [
        format!("{lead}{old}"),
        format!("¦{lead}{new}"),
        key.to_owned(),
        found.to_owned(),
        expected.to_owned(),
    ]
}

#[test]
fn values_of_the_wrong_kind() {
    all_told(&[
        ["mass = \"0.61 g\"", "mass = ¦true", "striker.mass", "true", "a mass (kg)"],
        ["mass = \"0.61 g\"", "mass = ¦[1]", "striker.mass", "a list of 1", "a mass"],
        [
            "mass = \"0.61 g\"",
            "mass = ¦2014-01-01",
            "striker.mass",
            "the date 2014-01-01",
            "a mass",
        ],
        [
            "title = \"A bench with every kind of key\"",
            "title = ¦4",
            "title",
            "the number 4",
            "text in quotes",
        ],
        ["seed = 7", "seed = ¦\"7\"", "seed", "\"7\"", "a whole number"],
        ["seed = 7", "seed = ¦7.5", "seed", "7.5", "a whole number"],
        ["seed = 7", "seed = ¦-1", "seed", "-1", "from 0"],
        ["seed = 7", "seed = ¦9007199254740993", "seed", "9007199254740993", "9007199254740991"],
        ["repeat = 19", "repeat = ¦19.0", "chain.segments.1.repeat", "19.0", "a whole number"],
        ["repeat = 19", "repeat = ¦0", "chain.segments.1.repeat", "0", "from 1"],
        ["repeat = 19", "repeat = ¦30_001", "chain.segments.1.repeat", "30001", "30000"],
        ["repeat = 19", "repeat = ¦30000", "chain.segments.1.repeat", "a longer chain", "30000"],
        [
            "particles = [\"ball\"]",
            "particles = ¦\"ball\"",
            "chain.segments.2.particles",
            "\"ball\"",
            "a list",
        ],
        [
            "particles = [\"ball\"]",
            "particles = [\"ball\", ¦3]",
            "chain.segments.2.particles",
            "the number 3",
            "a name",
        ],
        [
            "particles = [\"ball\"]",
            "particles = ¦[]",
            "chain.segments.2.particles",
            "no particles",
            "a list",
        ],
        ["invert = false", "invert = ¦\"no\"", "scope.ch1.invert", "\"no\"", "true or false"],
        ["coupling = \"DC\"", "coupling = ¦\"DCX\"", "scope.ch1.coupling", "\"DCX\"", "\"GND\""],
        ["top = \"free\"", "top = ¦\"loose\"", "chain.top", "\"loose\"", "\"free\""],
        [
            "top = \"free\"",
            "top = ¦{ wall = \"alumina\", force = \"1 N\" }",
            "chain.top",
            "a table",
            "{ force =",
        ],
        [
            "[effects.gravity]\nacceleration = \"9.81 m/s^2\"",
            "[effects]\ngravity = ¦true",
            "effects.gravity",
            "true",
            "a table",
        ],
        [
            "[effects.scope_noise]\nrms = \"0.02 div\"",
            "[effects]\nscope_noise = ¦0.02",
            "effects.scope_noise",
            "0.02",
            "a table",
        ],
    ]);
}

#[test]
fn numbers_without_unit_and_units_of_something_else() {
    all_told(&[
        [
            "mass = \"0.61 g\"",
            "mass = ¦0.61",
            "striker.mass",
            "0.61 without a unit",
            "like \"0.61 g\"",
        ],
        ["mass = \"0.61 g\"", "mass = ¦\"0.61\"", "striker.mass", "a plain number", "a mass (kg)"],
        [
            "mass = \"0.61 g\"",
            "mass = ¦\"0.61 mm\"",
            "striker.mass",
            "`0.61 mm` is a length (m)",
            "a mass (kg)",
        ],
        [
            "mass = \"0.61 g\"",
            "mass = ¦\"0.61 stone\"",
            "striker.mass",
            "unknown unit `stone`",
            "a mass (kg)",
        ],
        ["mass = \"0.61 g\"", "mass = ¦\"heavy\"", "striker.mass", "no number", "a mass (kg)"],
        ["mass = \"0.61 g\"", "mass = ¦\"\"", "striker.mass", "no number", "a mass (kg)"],
        [
            "rms = \"0.02 div\"",
            "rms = ¦\"0.02 V\"",
            "effects.scope_noise.rms",
            "a voltage (V)",
            "(div)",
        ],
        [
            "force = \"2.38 N\"",
            "force = ¦\"2.38 N/m\"",
            "effects.magnet_preload.force",
            "a stiffness",
            "a force (N)",
        ],
        [
            "time_base = \"250 us/div\"",
            "time_base = ¦\"250 us\"",
            "scope.time_base",
            "a time (s)",
            "a time base (s/div)",
        ],
        [
            "poissons_ratio = 0.46",
            "poissons_ratio = ¦\"0.46 m\"",
            "materials.plastic.poissons_ratio",
            "a length",
            "a plain number",
        ],
    ]);
}

#[test]
fn numbers_that_are_none() {
    all_told(&[
        ["mass = \"0.61 g\"", "mass = ¦nan", "striker.mass", "nan", "a mass (kg)"],
        ["mass = \"0.61 g\"", "mass = ¦inf", "striker.mass", "inf", "a mass (kg)"],
        [
            "mass = \"0.61 g\"",
            "mass = ¦\"nan kg\"",
            "striker.mass",
            "`nan kg` is not a finite number",
            "a mass",
        ],
        [
            "mass = \"0.61 g\"",
            "mass = ¦\"-inf kg\"",
            "striker.mass",
            "not a finite number",
            "a mass",
        ],
        [
            "mass = \"0.61 g\"",
            "mass = ¦\"1e400 kg\"",
            "striker.mass",
            "not a finite number",
            "a mass",
        ],
        ["accuracy = 1e-6", "accuracy = ¦nan", "accuracy", "nan", "a plain number"],
        ["accuracy = 1e-6", "accuracy = ¦-inf", "accuracy", "-inf", "a plain number"],
        [
            "poissons_ratio = 0.46",
            "poissons_ratio = ¦+nan",
            "materials.plastic.poissons_ratio",
            "nan",
            "below 0.5",
        ],
    ]);
}

#[test]
fn what_no_bench_has() {
    all_told(&[
        [
            "speed = \"0.44 m/s\"",
            "speed = ¦\"1e200 m/s\"",
            "striker.speed",
            "\"1e200 m/s\"",
            "a speed (m/s) from 1e-12 to 100000",
        ],
        [
            "youngs_modulus = \"1.46 GPa\"",
            "youngs_modulus = ¦\"1.46e9 GPa\"",
            "materials.plastic.youngs_modulus",
            "\"1.46e9 GPa\"",
            "a pressure (Pa) from 1 to 1e14",
        ],
    ]);
}

#[test]
fn physics_that_is_impossible() {
    all_told(&[
        ["mass = \"0.61 g\"", "mass = ¦\"0 g\"", "striker.mass", "\"0 g\"", "above zero"],
        ["mass = \"0.61 g\"", "mass = ¦\"-1 g\"", "striker.mass", "\"-1 g\"", "above zero"],
        [
            "mass = \"0.61 g\"",
            "mass = ¦\"1e-400 kg\"",
            "striker.mass",
            "\"1e-400 kg\"",
            "above zero",
        ],
        ["mass = \"0.485 g\"", "mass = ¦\"0 kg\"", "particles.can.mass", "\"0 kg\"", "above zero"],
        [
            "diameter = \"4.76 mm\"",
            "diameter = ¦\"0 mm\"",
            "particles.ball.diameter",
            "\"0 mm\"",
            "above zero",
        ],
        [
            "height = \"3.12 mm\"",
            "height = ¦\"-3 mm\"",
            "particles.can.height",
            "\"-3 mm\"",
            "above zero",
        ],
        [
            "poissons_ratio = 0.46",
            "poissons_ratio = ¦0.5",
            "materials.plastic.poissons_ratio",
            "0.5",
            "below 0.5",
        ],
        [
            "poissons_ratio = 0.46",
            "poissons_ratio = ¦-1",
            "materials.plastic.poissons_ratio",
            "-1",
            "above -1",
        ],
        [
            "youngs_modulus = \"1.46 GPa\"",
            "youngs_modulus = ¦\"-1 GPa\"",
            "materials.plastic.youngs_modulus",
            "\"-1 GPa\"",
            "a pressure (Pa) above zero",
        ],
        [
            "youngs_modulus = \"1.46 GPa\"",
            "youngs_modulus = ¦\"0 Pa\"",
            "materials.plastic.youngs_modulus",
            "\"0 Pa\"",
            "above zero",
        ],
        ["speed = \"0.44 m/s\"", "speed = ¦\"0 m/s\"", "striker.speed", "\"0 m/s\"", "above zero"],
        ["duration = \"2 ms\"", "duration = ¦\"0 s\"", "duration", "\"0 s\"", "above zero"],
        ["duration = \"2 ms\"", "duration = ¦\"-2 ms\"", "duration", "\"-2 ms\"", "above zero"],
        [
            "rms = \"0.02 div\"",
            "rms = ¦\"-0.02 div\"",
            "effects.scope_noise.rms",
            "-0.02",
            "zero or more",
        ],
        [
            "force = \"2.38 N\"",
            "force = ¦\"-2.38 N\"",
            "effects.magnet_preload.force",
            "-2.38",
            "zero or more",
        ],
        ["accuracy = 1e-6", "accuracy = ¦1e-12", "accuracy", "1e-12", "from 1e-11"],
        ["accuracy = 1e-6", "accuracy = ¦0.2", "accuracy", "0.2", "to 0.1"],
    ]);
}

#[test]
fn a_chain_that_cannot_stand() {
    all_told(&[
        [
            "particles = [\"ball\"]",
            "particles = [¦\"cube\"]",
            "chain.segments.2.particles",
            "\"cube\"",
            "ball, can",
        ],
        [
            "material = \"alumina\"",
            "material = ¦\"unobtanium\"",
            "striker.material",
            "unobtanium",
            "ptfe, soda_lime_glass, stainless_steel",
        ],
        ["wall = \"stainless_steel\"", "wall = ¦\"jelly\"", "chain.bottom.wall", "jelly", "ptfe"],
        [
            "top = \"free\"",
            "top = ¦{ wall = \"alumina\" }",
            "chain.top",
            "both a striker and a wall are at the top: leave one out",
            "",
        ],
    ]);
}

#[test]
fn loads_that_nothing_holds() {
    // Bottom free under gravity: the weight of 39 particles and the magnet's force remain.
    let told =
        problems(&bench_with("bottom = { wall = \"stainless_steel\" }", "bottom = \"free\""));
    let keys: Vec<&str> = told.iter().map(|p| p.key.as_str()).collect();
    assert_eq!(keys, ["chain.bottom", "sensors.floor.wall"], "{told:#?}");
    assert!(told[0].found.contains("left at the bottom"), "{}", told[0]);
    assert!(told[1].expected.contains("a wall"), "{}", told[1]);
    // Upward gravity lifts every particle; the magnet holds only the first contacts.
    let told = problems(&bench_with("\"9.81 m/s^2\"", "\"-981 m/s^2\""));
    assert_eq!(told.len(), 1, "{told:#?}");
    assert_eq!(told[0].key, "chain.segments");
    assert!(told[0].found.contains("no static equilibrium: the contact above"), "{}", told[0]);
    assert!(told[0].found.contains("tensile force"), "{}", told[0]);
}

#[test]
fn flat_faces_that_meet() {
    let told = problems(&bench_with("[\"ball\", \"can\"]", "[\"can\", \"can\"]"));
    let flat: Vec<_> = told.iter().filter(|p| p.key == "chain.segments").collect();
    assert_eq!(flat.len(), 1, "{told:#?}");
    // The striker's face is flat too, and it is met first.
    assert!(flat[0].found.contains("two flat faces touch, striker on can"), "{}", flat[0]);
    assert!(flat[0].found.contains("curved"), "{}", flat[0]);
}

#[test]
fn a_chain_of_nothing() {
    let segments = "[[chain.segments]]\nrepeat = 19\nparticles = [\"ball\", \"can\"]\n\n[[chain.segments]]\nparticles = [\"ball\"]\n";
    let told = problems(&bench_with(segments, ""));
    assert_eq!(
        told.len(),
        1,
        "only the chain is wrong, not the particles its sensors sit in: {told:#?}"
    );
    assert_eq!(told[0].key, "chain.segments");
    let without_chain = bench_without_chain();
    let told = problems(&without_chain);
    assert_eq!(told.iter().map(|p| p.key.as_str()).collect::<Vec<_>>(), ["chain"], "{told:#?}");
}

fn bench_without_chain() -> String {
    let start = super::BENCH.find("[chain]").expect("a chain");
    let end = super::BENCH.find("[striker]").expect("a striker");
    format!("{}{}", &super::BENCH[..start], &super::BENCH[end..])
}

#[test]
fn a_preload_where_none_can_be() {
    all_told(&[[
        "{ wall = \"stainless_steel\" }",
        "{ wall = \"stainless_steel\", preload = ¦\"1 N\" }",
        "chain.bottom.preload",
        "a preload of the wall at the bottom",
        "at the top",
    ]]);
}

#[test]
fn velocities_that_contradict_one_another() {
    let striker = "[striker]\nmaterial = \"alumina\"\nmass = \"0.61 g\"\nspeed = \"0.44 m/s\"\n";
    let velocity = |particle: &str, speed: &str| {
        format!("[[initial_velocities]]\nparticle = {particle}\nvelocity = \"{speed}\"\n\n")
    };
    let one = velocity("3", "0.1 m/s");
    assert!(load(&bench_with(striker, &one)).is_ok(), "a particle may move instead of a striker");
    let twice = one.clone() + &velocity("¦3", "0.2 m/s");
    let slow = velocity("3", "0 m/s");
    let beyond = velocity("¦40", "1 m/s");
    let wrong = "[[initial_velocities]]\nparticle = 3\nvelocity = ¦\"1 m\"\n";
    all_told(&[
        [
            striker,
            &twice,
            "initial_velocities.2.particle",
            "a second velocity of particle 3",
            "one velocity",
        ],
        [striker, &beyond, "initial_velocities.1.particle", "40", "from 1 to 39"],
        [striker, wrong, "initial_velocities.1.velocity", "a length", "a speed"],
    ]);
    let told = problems(&bench_with(striker, &slow));
    assert_eq!(told.len(), 1, "{told:#?}");
    assert!(told[0].found.contains("nothing moves"), "{}", told[0]);
    let told = problems(&bench_with(striker, ""));
    assert_eq!(told.len(), 1, "{told:#?}");
    assert!(told[0].found.contains("nothing moves"), "{}", told[0]);
}

#[test]
fn sensors_in_places_that_do_not_exist() {
    all_told(&[
        ["particle = 14", "particle = ¦0", "sensors.p14.particle", "0", "from 1 to 39"],
        ["particle = 14", "particle = ¦40", "sensors.p14.particle", "40", "from 1 to 39"],
        ["particle = 14", "particle = ¦1.5", "sensors.p14.particle", "1.5", "a whole number"],
        [
            "host = \"can\"",
            "host = ¦\"ball\"",
            "sensors.p14.host",
            "\"ball\"",
            "\"can\", which particle 14 is",
        ],
        ["offset = 0.25", "offset = ¦0.51", "sensors.p14.offset", "0.51", "from -0.5 to 0.5"],
        [
            "wall = true",
            "wall = ¦true\nparticle = 3",
            "sensors.floor.wall",
            "both `wall`",
            "one place",
        ],
        [
            "ceramic = \"pzt-5a\"",
            "ceramic = ¦\"chalk\"",
            "sensors.p14.ceramic",
            "chalk",
            "pzt-5a, pzt-5h",
        ],
        [
            "thickness = \"0.5 mm\"",
            "thickness = ¦\"0 mm\"",
            "sensors.p14.thickness",
            "0 mm",
            "above zero",
        ],
        [
            "cable_capacitance = \"710 pF\"",
            "cable_capacitance = ¦\"-1 pF\"",
            "sensors.p14.cable_capacitance",
            "-1 pF",
            "zero or more",
        ],
        [
            "[effects.magnet_preload]\nforce = \"2.38 N\"\nparticle = 1",
            "[effects.magnet_preload]\nforce = \"2.38 N\"\nparticle = ¦40",
            "effects.magnet_preload.particle",
            "40",
            "from 1 to 39",
        ],
    ]);
}

#[test]
fn an_effect_is_switched_off_by_false() {
    let base = "base = \"magnet-0.61g\"\n";
    let on = load(base).expect("sound");
    let off = load(&format!("{base}[effects]\nmagnet_preload = false\n")).expect("sound");
    assert!(on.spec.effects.magnet_preload.is_some());
    assert_eq!(off.spec.effects.magnet_preload, None);
    assert_eq!(off.spec.effects.gravity, on.spec.effects.gravity);
    let quiet = load(&format!("{base}[effects]\nscope_noise = false\n")).expect("sound");
    assert!(on.scope.noise > 0.0);
    assert_eq!(quiet.scope.noise.to_bits(), 0.0_f64.to_bits());
}
