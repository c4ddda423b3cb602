//! The scenes: fixed numbers, none of them those of a shipped scene, each named after what is
//! extreme in it.

use super::setup::{Bead, End, Law, Loss, Material, Setup, cylinder, sphere};

const fn material(name: &'static str, modulus: f64, ratio: f64, density: f64) -> Material {
    Material { name, modulus, ratio, density }
}

const STEEL: Material = material("tool_steel", 212e9, 0.285, 7790.0);
const BRASS: Material = material("brass", 103e9, 0.34, 8470.0);
const BRONZE: Material = material("bronze", 114e9, 0.33, 8850.0);
const ALUMINIUM: Material = material("aluminium", 71.3e9, 0.332, 2710.0);
const GLASS: Material = material("glass", 64e9, 0.21, 2480.0);
const TEFLON: Material = material("teflon", 0.52e9, 0.45, 2180.0);
const NYLON: Material = material("nylon", 2.7e9, 0.39, 1150.0);
const ACRYLIC: Material = material("acrylic", 3.1e9, 0.37, 1190.0);
const RUBBER: Material = material("rubber", 6.4e6, 0.49, 1120.0);
const CARBIDE: Material = material("carbide", 632e9, 0.22, 15_600.0);
const LEAD: Material = material("lead", 16.1e9, 0.44, 11_340.0);
const ZIRCONIA: Material = material("zirconia", 208e9, 0.31, 6020.0);

/// Beads on a steel wall, hit by a striker; sensors in the first, the middle and the last one.
fn struck(
    name: &'static str,
    beads: Vec<Bead>,
    striker: Bead,
    speed: f64,
    microseconds: f64,
) -> Setup {
    let count = beads.len();
    let mut sensors = vec![(1, 0.0), (count.div_ceil(2), 0.0), (count, 0.0)];
    sensors.dedup();
    Setup {
        name,
        beads,
        striker: Some((striker, speed)),
        top: End::Free,
        bottom: End::Wall(STEEL, 0.0),
        gravity: 0.0,
        magnet: None,
        losses: Vec::new(),
        zero_force: false,
        velocities: Vec::new(),
        sensors,
        duration: 1e-6 * microseconds,
    }
}

/// The same without a striker: particles with initial velocities.
fn kicked(
    name: &'static str,
    beads: Vec<Bead>,
    velocities: &[(usize, f64)],
    microseconds: f64,
) -> Setup {
    let striker = sphere(STEEL, 5.0);
    let setup = struck(name, beads, striker, 1.0, microseconds);
    Setup { striker: None, velocities: velocities.to_vec(), ..setup }
}

fn equal(bead: Bead, count: usize) -> Vec<Bead> {
    vec![bead; count]
}

/// Spheres from one diameter (mm) to another in equal ratios.
fn taper(material: Material, from: f64, to: f64, count: usize) -> Vec<Bead> {
    let ratio = (to / from).powf(1.0 / (count - 1) as f64);
    (0..count as i32).map(|i| sphere(material, from * ratio.powi(i))).collect()
}

/// Equal beads with one replaced, counted from 1.
fn impurity(bead: Bead, count: usize, at: usize, other: Bead) -> Vec<Bead> {
    let mut beads = equal(bead, count);
    beads[at - 1] = other;
    beads
}

/// Two beads in turn.
fn alternating(one: Bead, other: Bead, count: usize) -> Vec<Bead> {
    (0..count).map(|i| if i % 2 == 0 { one } else { other }).collect()
}

fn loss(law: Law, coefficient: f64) -> Loss {
    Loss { law, coefficient, single: Vec::new() }
}

/// Squeezed by equal forces at both ends (N).
fn squeezed(setup: Setup, force: f64) -> Setup {
    Setup { top: End::Force(force), bottom: End::Force(force), ..setup }
}

fn lossy(setup: Setup, losses: Vec<Loss>, zero_force: bool) -> Setup {
    Setup { losses, zero_force, ..setup }
}

fn with_gravity(setup: Setup, gravity: f64) -> Setup {
    Setup { gravity, ..setup }
}

/// Lossless scenes: tapers, impurities, ends, few particles, extreme strikers.
pub fn lossless() -> Vec<Setup> {
    let steel = |d| sphere(STEEL, d);
    let mut scenes = vec![
        struck(
            "taper to a sixth of the diameter, unloaded",
            taper(STEEL, 9.0, 1.5, 14),
            steel(9.0),
            0.31,
            260.0,
        ),
        struck(
            "taper upwards fourfold, unloaded",
            taper(BRASS, 2.5, 10.0, 12),
            sphere(BRASS, 2.5),
            0.83,
            400.0,
        ),
        struck(
            "light impurity of nylon between carbide",
            impurity(sphere(CARBIDE, 6.0), 11, 6, sphere(NYLON, 3.0)),
            sphere(CARBIDE, 6.0),
            0.22,
            700.0,
        ),
        struck(
            "heavy impurity of carbide between teflon",
            impurity(sphere(TEFLON, 6.35), 9, 4, sphere(CARBIDE, 9.5)),
            sphere(TEFLON, 6.35),
            0.57,
            2500.0,
        ),
        struck("one glass bead on a steel wall", vec![sphere(GLASS, 4.0)], steel(3.0), 0.15, 60.0),
        struck(
            "two beads of lead and glass",
            vec![sphere(LEAD, 7.0), sphere(GLASS, 5.0)],
            sphere(BRONZE, 5.5),
            0.4,
            150.0,
        ),
        struck(
            "three beads, each ten times lighter",
            vec![steel(12.0), steel(5.571), steel(2.586)],
            steel(12.0),
            0.12,
            300.0,
        ),
        struck(
            "feather-light striker of 0.05 mg",
            equal(sphere(BRASS, 6.0), 8),
            sphere(NYLON, 0.436),
            1.9,
            450.0,
        ),
        struck(
            "striker of 2 kg on small glass beads",
            equal(sphere(GLASS, 3.0), 6),
            sphere(STEEL, 40.0).weighing(2.0),
            0.05,
            400.0,
        ),
        struck("slow striker at 10 um/s", equal(steel(4.0), 10), steel(4.0), 1e-5, 3000.0),
        struck("fast striker at 20 m/s", equal(steel(5.0), 10), steel(5.0), 20.0, 100.0),
        struck("rubber beads", equal(sphere(RUBBER, 12.0), 6), sphere(RUBBER, 12.0), 0.6, 60_000.0),
        with_gravity(
            struck(
                "heavy gravity of 300 m/s^2",
                equal(sphere(LEAD, 8.0), 12),
                sphere(LEAD, 8.0),
                0.25,
                1500.0,
            ),
            300.0,
        ),
        with_gravity(
            struck(
                "weak gravity of 1 mm/s^2",
                equal(sphere(ALUMINIUM, 6.0), 10),
                sphere(ALUMINIUM, 6.0),
                0.04,
                600.0,
            ),
            1e-3,
        ),
        with_gravity(
            struck(
                "gravity and alternating glass and lead",
                alternating(sphere(GLASS, 4.0), sphere(LEAD, 6.0), 13),
                sphere(ZIRCONIA, 5.0),
                0.35,
                900.0,
            ),
            9.79,
        ),
        with_gravity(
            struck(
                "drop of a heavy ball under gravity for long",
                equal(sphere(BRONZE, 5.0), 4),
                steel(15.0),
                0.1,
                2500.0,
            ),
            9.83,
        ),
        Setup {
            magnet: Some((1, 40.0)),
            ..struck(
                "magnet of 40 N on the first bead",
                equal(steel(7.0), 12),
                steel(7.0),
                0.3,
                350.0,
            )
        },
        Setup {
            magnet: Some((5, 3.3)),
            ..struck(
                "magnet on the fifth bead, loose above",
                equal(steel(6.0), 9),
                sphere(GLASS, 6.0),
                0.21,
                400.0,
            )
        },
        Setup {
            magnet: Some((2, 0.02)),
            gravity: 9.81,
            ..struck(
                "faint magnet and gravity",
                equal(sphere(ACRYLIC, 8.0), 7),
                steel(3.0),
                0.5,
                1500.0,
            )
        },
        Setup {
            top: End::Force(11.0),
            ..struck(
                "constant force from above and a wall of teflon",
                equal(sphere(BRASS, 5.5), 8),
                sphere(GLASS, 5.0),
                0.45,
                700.0,
            )
        },
        Setup {
            bottom: End::Wall(RUBBER, 0.0),
            ..struck(
                "wall of rubber",
                equal(sphere(ALUMINIUM, 5.0), 5),
                sphere(ALUMINIUM, 5.0),
                0.4,
                3000.0,
            )
        },
        Setup {
            bottom: End::Free,
            ..struck("free bottom end", equal(steel(6.35), 7), steel(9.5), 0.6, 250.0)
        },
        Setup {
            bottom: End::Wall(CARBIDE, 0.0),
            ..struck(
                "flat cylinders of brass between acrylic spheres",
                alternating(sphere(ACRYLIC, 6.0), cylinder(BRASS, 6.0, 4.0), 11),
                cylinder(ZIRCONIA, 6.0, 5.0),
                0.33,
                1500.0,
            )
        },
        squeezed(
            kicked(
                "squeezed by 500 N, kicked by 1 mm/s in the middle",
                equal(steel(10.0), 11),
                &[(6, 1e-3)],
                200.0,
            ),
            500.0,
        ),
        squeezed(
            kicked(
                "squeezed by 1 mN, kicked by 1 m/s",
                equal(sphere(GLASS, 5.0), 8),
                &[(1, 1.0)],
                160.0,
            ),
            1e-3,
        ),
        squeezed(
            struck(
                "squeezed by 50 N and struck",
                taper(BRONZE, 8.0, 4.0, 9),
                steel(2.0),
                0.7,
                220.0,
            ),
            50.0,
        ),
        Setup {
            bottom: End::Free,
            ..kicked(
                "two beads that collide head-on",
                vec![sphere(BRASS, 5.0), sphere(ACRYLIC, 9.0)],
                &[(1, 0.3), (2, -0.4)],
                120.0,
            )
        },
        Setup {
            top: End::Wall(BRASS, 7.5),
            bottom: End::Wall(GLASS, 0.0),
            ..kicked(
                "between two preloaded walls, kicked upward",
                equal(steel(8.0), 7),
                &[(5, -0.2)],
                300.0,
            )
        },
        Setup {
            top: End::Wall(STEEL, 0.0),
            ..kicked(
                "between two walls without preload",
                equal(sphere(NYLON, 7.0), 5),
                &[(3, 0.8)],
                900.0,
            )
        },
        Setup {
            top: End::Wall(CARBIDE, 0.3),
            ..kicked(
                "one bead between two walls",
                vec![sphere(ZIRCONIA, 10.0)],
                &[(1, 0.09)],
                250.0,
            )
        },
        kicked(
            "several beads kicked against each other",
            equal(sphere(ALUMINIUM, 6.0), 9),
            &[(2, 0.5), (5, -0.7), (8, 0.2)],
            400.0,
        ),
        struck(
            "dust grain of 2 ug in a chain of steel",
            impurity(steel(5.0), 7, 4, sphere(GLASS, 0.1155)),
            steel(5.0),
            0.05,
            120.0,
        ),
        struck(
            "forty beads of glass and steel in turn",
            alternating(sphere(GLASS, 5.0), steel(5.0), 40),
            steel(5.0),
            0.5,
            600.0,
        ),
        Setup {
            magnet: Some((1, 0.9)),
            gravity: 9.81,
            ..struck(
                "forty-five beads under gravity and a magnet",
                alternating(sphere(TEFLON, 5.0), sphere(BRASS, 4.2), 45),
                cylinder(CARBIDE, 5.0, 3.0),
                0.38,
                3500.0,
            )
        },
        struck(
            "stiff striker on soft beads",
            equal(sphere(RUBBER, 8.0), 4),
            cylinder(CARBIDE, 12.0, 9.0),
            0.3,
            60_000.0,
        ),
        struck(
            "rattling pair between a heavy striker and the wall",
            vec![sphere(ACRYLIC, 3.0), sphere(LEAD, 4.0)],
            steel(14.0),
            0.35,
            700.0,
        ),
        struck(
            "random-like mixture of six materials",
            vec![
                steel(4.0),
                sphere(GLASS, 7.0),
                sphere(LEAD, 3.0),
                sphere(ACRYLIC, 6.0),
                sphere(BRASS, 2.0),
                sphere(ZIRCONIA, 8.0),
                sphere(TEFLON, 5.0),
                sphere(GLASS, 3.0),
            ],
            sphere(BRONZE, 6.0),
            0.27,
            3000.0,
        ),
    ];
    scenes[19].bottom = End::Wall(TEFLON, 0.0);
    scenes[2].sensors = vec![(1, 0.5), (6, 0.0), (8, -0.25)];
    scenes
}

/// Scenes with losses: each law, several at once, both ends of contact, single contacts with their
/// own coefficients.
pub fn dissipative() -> Vec<Setup> {
    let steel = |d| sphere(STEEL, d);
    let brass_chain = |name, us| struck(name, equal(sphere(BRASS, 6.0), 8), steel(6.0), 0.42, us);
    let standing = |name, us| {
        let beads = alternating(sphere(GLASS, 5.0), sphere(BRONZE, 4.5), 9);
        with_gravity(struck(name, beads, sphere(ZIRCONIA, 5.5), 0.36, us), 9.81)
    };
    let pressed = |name, us| {
        let setup = kicked(name, equal(sphere(ALUMINIUM, 8.0), 9), &[(1, 0.25)], us);
        squeezed(setup, 20.0)
    };
    let own = |law, coefficient, single: &[(usize, f64)]| Loss {
        law,
        coefficient,
        single: single.to_vec(),
    };
    vec![
        lossy(
            brass_chain("weak dashpot, ends at zero overlap", 300.0),
            vec![loss(Law::Dashpot, 0.3)],
            false,
        ),
        lossy(
            brass_chain("weak dashpot, ends at zero force", 300.0),
            vec![loss(Law::Dashpot, 0.3)],
            true,
        ),
        lossy(
            standing("strong dashpot under gravity, ends at zero overlap", 450.0),
            vec![loss(Law::Dashpot, 6.0)],
            false,
        ),
        lossy(
            standing("strong dashpot under gravity, ends at zero force", 450.0),
            vec![loss(Law::Dashpot, 6.0)],
            true,
        ),
        lossy(
            pressed("overdamped dashpot in a squeezed chain", 600.0),
            vec![loss(Law::Dashpot, 80.0)],
            false,
        ),
        lossy(
            brass_chain("Kuwabara-Kono of 0.1 us, ends at zero overlap", 300.0),
            vec![loss(Law::KuwabaraKono, 1e-7)],
            false,
        ),
        lossy(
            brass_chain("Kuwabara-Kono of 2 us, ends at zero force", 300.0),
            vec![loss(Law::KuwabaraKono, 2e-6)],
            true,
        ),
        lossy(
            standing("Kuwabara-Kono of 1 us under gravity, ends at zero overlap", 400.0),
            vec![loss(Law::KuwabaraKono, 1e-6)],
            false,
        ),
        lossy(
            pressed("Kuwabara-Kono of 5 us in a squeezed chain", 300.0),
            vec![loss(Law::KuwabaraKono, 5e-6)],
            false,
        ),
        lossy(
            brass_chain("power law of exponent 1.75, ends at zero overlap", 300.0),
            vec![loss(Law::Power(1.75), 3.0)],
            false,
        ),
        lossy(
            standing("power law of exponent 3, ends at zero force", 400.0),
            vec![loss(Law::Power(3.0), 5.0)],
            true,
        ),
        lossy(
            pressed("power law of exponent 1.2 in a squeezed chain", 300.0),
            vec![loss(Law::Power(1.2), 0.9)],
            false,
        ),
        lossy(
            brass_chain("dashpot with Kuwabara-Kono, ends at zero overlap", 300.0),
            vec![loss(Law::Dashpot, 0.7), loss(Law::KuwabaraKono, 6e-7)],
            false,
        ),
        lossy(
            brass_chain("dashpot with Kuwabara-Kono, ends at zero force", 300.0),
            vec![loss(Law::Dashpot, 0.7), loss(Law::KuwabaraKono, 6e-7)],
            true,
        ),
        lossy(
            standing("all three losses, end at zero force", 400.0),
            vec![
                loss(Law::Dashpot, 0.5),
                loss(Law::KuwabaraKono, 4e-7),
                loss(Law::Power(1.6), 1.1),
            ],
            true,
        ),
        lossy(
            standing("all three losses, end at zero overlap", 400.0),
            vec![
                loss(Law::Dashpot, 0.5),
                loss(Law::KuwabaraKono, 4e-7),
                loss(Law::Power(1.6), 1.1),
            ],
            false,
        ),
        lossy(
            brass_chain("dashpot at the wall alone", 300.0),
            vec![own(Law::Dashpot, 0.0, &[(9, 4.0)])],
            false,
        ),
        lossy(
            standing("dashpot everywhere but at the striker, stronger in the middle", 450.0),
            vec![own(Law::Dashpot, 0.4, &[(1, 0.0), (5, 3.0)])],
            false,
        ),
        lossy(
            brass_chain("dashpot and Kuwabara-Kono in different contacts", 300.0),
            vec![
                own(Law::Dashpot, 0.0, &[(3, 1.2), (4, 1.2)]),
                own(Law::KuwabaraKono, 0.0, &[(6, 1.5e-6), (7, 1.5e-6)]),
            ],
            true,
        ),
        lossy(
            struck("one bead with a dashpot", vec![sphere(NYLON, 8.0)], steel(5.0), 0.9, 300.0),
            vec![loss(Law::Dashpot, 1.5)],
            true,
        ),
        lossy(
            struck(
                "rubber with strong Kuwabara-Kono",
                equal(sphere(RUBBER, 10.0), 4),
                sphere(RUBBER, 10.0),
                0.5,
                50_000.0,
            ),
            vec![loss(Law::KuwabaraKono, 5e-4)],
            false,
        ),
        lossy(
            with_gravity(
                struck(
                    "dashpot under gravity for long, rattling",
                    equal(sphere(GLASS, 4.0), 4),
                    steel(9.0),
                    0.2,
                    1500.0,
                ),
                9.81,
            ),
            vec![loss(Law::Dashpot, 0.2)],
            false,
        ),
    ]
}

/// Scenes that a random search found to be hard: first peaks next to an inflection, very light
/// beads, losses near the border of stiffness.
pub fn found_by_search() -> Vec<Setup> {
    let m = |name, modulus, density| material(name, modulus, 0.25, density);
    let wall = |material| End::Wall(material, 0.0);
    // A name stands for one material in each scene.
    let (a, b, c, d) = (
        m("a", 299e9, 13e3),
        m("b", 129e9, 12.5e3),
        m("c", 28.7e9, 1.35e3),
        m("d", 84.8e9, 19.3e3),
    );
    let beads = vec![
        sphere(a, 2.01),
        sphere(c, 5.1),
        sphere(b, 8.19),
        sphere(d, 2.81),
        sphere(b, 2.14),
        sphere(b, 8.51),
        sphere(b, 3.94),
    ];
    let inflection = struck(
        "first peak next to an inflection, Kuwabara-Kono",
        beads,
        sphere(b, 6.58),
        2.42,
        99.4,
    );
    let inflection = Setup {
        bottom: wall(c),
        sensors: vec![(1, 0.0), (4, 0.0), (7, 0.0)],
        ..with_gravity(inflection, 9.81)
    };

    let (a, b, c) = (m("a", 6.58e9, 10e3), m("b", 142e9, 2490.0), m("c", 26.4e9, 10.1e3));
    let light = sphere(b, 2.36).weighing(1.592e-6);
    let beads = vec![sphere(b, 8.55), light, sphere(c, 5.91), sphere(b, 5.07), sphere(a, 2.61)];
    let magnetic = struck(
        "bead of 1.6 mg with a magnet and a strong dashpot",
        beads,
        sphere(b, 5.51),
        2.46,
        651.0,
    );
    let magnetic = Setup { bottom: wall(c), magnet: Some((2, 12.6)), ..magnetic };

    let (a, b, c, d) = (
        m("a", 2.61e9, 8940.0),
        m("b", 7.3e9, 4950.0),
        m("c", 30.8e9, 3750.0),
        m("d", 12.4e9, 6760.0),
    );
    let light = sphere(b, 2.94).weighing(8.365e-7);
    let beads = vec![
        light,
        sphere(d, 3.7),
        sphere(a, 2.42),
        sphere(a, 9.09),
        sphere(b, 3.34),
        sphere(b, 6.65),
        sphere(b, 8.7),
        sphere(c, 5.32),
    ];
    let jumping = struck(
        "bead of 0.8 mg, dashpot with strong Kuwabara-Kono, free end",
        beads,
        sphere(c, 4.72),
        0.627,
        664.0,
    );
    let jumping = Setup { bottom: End::Free, ..jumping };

    let (a, b, c) = (m("a", 6.17e9, 19.4e3), m("b", 497e9, 4530.0), m("c", 28.3e9, 12.6e3));
    let beads = vec![
        sphere(c, 2.11),
        sphere(a, 7.57),
        sphere(b, 2.68),
        sphere(c, 5.05),
        sphere(b, 3.9),
        sphere(b, 3.29),
    ];
    let faint = struck("faint dashpot that never pulls", beads, sphere(c, 10.7), 0.12, 343.0);
    let faint = Setup { bottom: wall(b), ..faint };

    vec![
        lossy(inflection, vec![loss(Law::KuwabaraKono, 2.37e-7)], true),
        lossy(magnetic, vec![loss(Law::Dashpot, 40.2)], true),
        lossy(jumping, vec![loss(Law::Dashpot, 0.651), loss(Law::KuwabaraKono, 8.26e-6)], false),
        lossy(faint, vec![loss(Law::Dashpot, 0.0209)], true),
    ]
}

/// A scene that takes long.
pub fn slow() -> Vec<Setup> {
    let m = |name, modulus, density| material(name, modulus, 0.25, density);
    let (a, b, c, d) = (
        m("a", 20.5e9, 3160.0),
        m("b", 92.8e9, 1130.0),
        m("c", 327e9, 2200.0),
        m("d", 24.7e9, 16.3e3),
    );
    let light = sphere(c, 2.12).weighing(5.027e-8);
    let beads = vec![
        sphere(b, 5.87),
        sphere(b, 4.19),
        sphere(b, 3.37),
        sphere(a, 5.79),
        light,
        sphere(b, 2.3),
        sphere(a, 11.1),
        sphere(a, 5.54),
    ];
    let tiny = struck("bead of 50 ug among strong dashpots", beads, sphere(d, 7.54), 1.1, 382.0);
    let tiny = Setup { bottom: End::Wall(a, 0.0), magnet: Some((7, 0.0275)), ..tiny };
    vec![lossy(tiny, vec![loss(Law::Dashpot, 9.63)], true)]
}
