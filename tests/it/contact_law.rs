//! Contacts of other exponents than Hertz's.

use hertzscope::chain::{
    Body, Chain, ChainSpec, ContactLaw, EffectsSpec, End, ForceProbe, PlasticModel, Plasticity,
};
use hertzscope::experiment::accuracy::run_to_accuracy;
use hertzscope::experiment::bench::Bench;
use hertzscope::motion::Method;
use hertzscope::scene::Scene;

use crate::chains::{NEVER, ptfe_sphere};

/// Mass of the spheres (kg).
const MASS: f64 = 0.1226e-3;

/// `A` (N/m^p): 10 N at 10 um.
fn stiffness(exponent: f64) -> f64 {
    10.0 / 1e-5_f64.powf(exponent)
}

fn effects(exponent: f64) -> EffectsSpec {
    let contact_law = ContactLaw { exponent, stiffness: stiffness(exponent), between: Vec::new() };
    EffectsSpec { contact_law: Some(contact_law), ..EffectsSpec::default() }
}

fn free(particles: usize, effects: EffectsSpec) -> ChainSpec {
    let particles: Vec<Body> = (0..particles).map(|_| ptfe_sphere()).collect();
    let (top, bottom) = (End::Free, End::Free);
    ChainSpec { striker: None, particles, top, bottom, wall_preload: 0.0, effects }
}

/// The discrete solitary wave of `F = A d^p`, `A = m = F_max = 1`, as another program solves it and
/// direct simulation confirms: its speed in sites, and the largest mean of two neighbouring forces.
#[test]
fn solitary_waves_of_eight_exponents_have_the_speeds_of_the_table() {
    for (exponent, speed, ratio) in [
        (1.3, 0.937343781, 0.807718),
        (1.4, 0.920665358, 0.755287),
        (1.5, 0.905515776, 0.707324),
        (1.6, 0.891659039, 0.663236),
        (1.8, 0.867101301, 0.585894),
        (2.0, 0.845853642, 0.543354),
        (2.5, 0.802617685, 0.509617),
        (3.0, 0.768419828, 0.502352),
    ] {
        let chain = Chain::new(&free(160, effects(exponent))).expect("a chain");
        let mut velocities = vec![0.0; 160];
        velocities[0] = 0.4;
        let probes = [100, 140].map(|j| ForceProbe::contact(&chain, j).expect("a probe"));
        let inside = ForceProbe::inside(&chain, 140, 0.0).expect("a probe");
        let [early, late] = probes;
        let method = Method::DormandPrince853 { tolerance: 1e-11 };
        let probes = [early, late, inside];
        let mut bench = Bench::new(&chain, &velocities, method, &probes, NEVER, NEVER);
        let contact = stiffness(exponent);
        let collision = chain.contacts()[1].collision_overlap(0.5 * MASS, 0.4);
        // A generous estimate of the speed in sites: that of half the collision's force.
        let force = 0.5 * contact * collision.powf(exponent);
        let sites = (contact / MASS).sqrt() * (force / contact).powf(0.5 - 0.5 / exponent);
        bench.run_until(220.0 / sites, true, &mut |_| ()).expect("a run");
        let peaks = [0, 1, 2].map(|i| bench.watches()[i].pulse.first_peak().expect("a peak"));
        let [early, late, inside] = peaks;
        let force = late.dynamic_n;
        let scale = (contact / MASS).sqrt() * (force / contact).powf(0.5 - 0.5 / exponent);
        let found = 40.0 / (late.time_s - early.time_s) / scale;
        println!("p {exponent}: {found:.9}, {:.7}, {:?}", inside.dynamic_n / force, bench.work());
        assert!((found / speed - 1.0).abs() < 1e-6, "{exponent}: {found}");
        assert!((inside.dynamic_n / force - ratio).abs() < 2e-6, "{exponent}");
        let (before, after) = bench.energies();
        assert!((after.total() / before.total() - 1.0).abs() < 1e-9, "{exponent}");
    }
}

/// Small changes under 10 N: two spheres swing against each other on a spring of `p F/d`.
#[test]
fn a_weak_wave_sees_the_tangent() {
    for exponent in [1.0, 1.3, 1.5, 2.7, 5.0] {
        let pressed = ChainSpec {
            top: End::Force(10.0),
            bottom: End::Force(10.0),
            ..free(2, effects(exponent))
        };
        let chain = Chain::new(&pressed).expect("a chain");
        let contact = &chain.contacts()[1];
        assert!((contact.static_overlap / 1e-5 - 1.0).abs() < 1e-14);
        let spring = exponent * 10.0 / 1e-5;
        assert!((contact.static_stiffness() / spring - 1.0).abs() < 1e-14);
        let half_period = std::f64::consts::PI / (2.0 * spring / MASS).sqrt();
        let method = Method::DormandPrince853 { tolerance: 1e-12 };
        let speeds = [1e-9, -1e-9];
        let mut bench = Bench::new(&chain, &speeds, method, &[], NEVER, NEVER);
        bench.run_until(half_period, false, &mut |_| ()).expect("a run");
        let after = bench.state().velocity;
        assert!((after[0] + 1e-9).abs() < 1e-17 && (after[1] - 1e-9).abs() < 1e-17, "{after:?}");
    }
}

/// As a scene, with another law at the wall. What is made for Hertz's law is refused.
#[test]
fn a_scene_takes_the_numbers_of_a_fit() {
    let law = "[effects.contact_law]\nexponent = 1.5\nforce = \"10 N\"\noverlap = \"10 um\"\n";
    let scene = |more: &str| {
        let text = format!("base = \"magnet-0.61g\"\n{law}{more}");
        Scene::from_text("law", "law.toml", &text)
    };
    let own = "contacts = [{ between = [\"ptfe_sphere\", \"wall\"], exponent = 2, force = \"1 N\", overlap = \"2 um\" }]\n";
    let chain = scene(own).expect("a scene").chain.clone();
    let last = chain.contacts().last().expect("contacts");
    assert!((last.stiffness / (1.0 / 4e-12) - 1.0).abs() < 1e-14 && last.exponent() == 2.0);
    assert!((chain.contacts()[3].stiffness / stiffness(1.5) - 1.0).abs() < 1e-14);
    let by_law = scene("").expect("a scene");
    let outcome = run_to_accuracy(&by_law, 1e-4, 1, &mut |_| ()).expect("a run");
    assert!(outcome.summary.effects.iter().any(|e| format!("{e:?}").contains("contact_law")));
    for (more, named) in [
        ("[effects.plasticity]\nmodel = \"thornton\"\n", "effects.plasticity"),
        ("[effects.linearised_contacts]\n", "effects.linearised_contacts"),
        (
            "[effects.dashpot]\nrestitution = 0.9\nspeed = \"1 m/s\"\nend_of_contact = \"zero_force\"\n",
            "restitution",
        ),
        (
            "[effects.kuwabara_kono]\neta = \"1 us\"\nend_of_contact = \"zero_force\"\n",
            "effects.kuwabara_kono",
        ),
        (
            "contacts = [{ between = [\"wall\", \"a\"], exponent = 2, force = \"1 N\", overlap = \"2 um\" }]\n",
            "which do not touch",
        ),
    ] {
        let told = scene(more).expect_err("refused").to_string();
        assert!(told.contains(named), "{more}: {told}");
    }
    // Flat faces, which have no Hertz contact, may have a measured one.
    let flat = crate::chains::steel_cylinder();
    let spec = ChainSpec { particles: vec![flat.clone(), flat], ..free(2, effects(1.0)) };
    assert!(Chain::new(&spec).is_ok());
    let thornton = Plasticity::new(PlasticModel::Thornton);
    let both = EffectsSpec { plasticity: Some(thornton), ..effects(1.4) };
    assert!(Chain::new(&free(3, both)).is_err());
}
