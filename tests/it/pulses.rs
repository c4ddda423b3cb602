//! Forces are looked at within those steps only in which they may peak or reach a new level: nobody can tell.

use hertzscope::chain::stepper::{ChainStepper, Depth, Due, InstructionSet, LOOKED_AT, Trail};
use hertzscope::chain::{Chain, ForceProbe, ForceSegment};
use hertzscope::experiment::bench::{Bench, Grid};
use hertzscope::experiment::pulse::{LOWEST_LEVEL, Peak, PulseRecorder};
use hertzscope::integrate::{Integrator, Method};
use hertzscope::scene::Scene;

use super::chains::{diatomic, kicked};
use super::splittings::METHODS;

/// Times nobody reaches.
const NEVER: Grid = Grid { start: 1e9, interval: 1.0 };
/// Shares of the first peak at which arrivals are compared (1).
const LEVELS: [f64; 5] = [LOWEST_LEVEL, 0.03, 0.1, 0.5, 0.95];

/// Light beads rattle on while heavy ones press them harder and harder: maxima are first until larger forces come.
const RATTLING: &str = r#"
duration = "100 ms"
materials.hard = { youngs_modulus = "35.16 GPa", poissons_ratio = 0.4182 }
materials.soft = { youngs_modulus = "20.63 MPa", poissons_ratio = 0.1799 }
particles.light = { material = "hard", diameter = "358.5 um", mass = "131.8 ug" }
particles.heavy = { material = "hard", diameter = "5.46 mm", mass = "8.723 g" }
particles.soft = { material = "soft", diameter = "283.5 um", mass = "1.869 mg" }
chain = { top = "free", bottom = { wall = "stainless_steel" }, segments = [
  { particles = ["light", "soft", "light", "light", "heavy", "light", "soft", "light", "soft", "light"] },
] }
striker = { material = "stainless_steel", mass = "39.13 g", diameter = "22.27 mm", speed = "251.7 um/s" }
effects.gravity = { acceleration = "0.0598 m/s^2" }
sensors.a = { model = "pzt-5a-710pf", particle = 1 }
[scope]
model = "tds2014"
time_base = "10 ms/div"
trigger = { source = "CH1", level = "200 mV", slope = "rise", mode = "normal" }
ch1 = { input = "a", scale = "1 V/div" }
"#;

/// First peak (N, s), first times of levels (s) and what was first before if that is a level that is remembered (N, s), to the last bit.
fn readings(pulse: &PulseRecorder) -> Vec<u64> {
    let peak = pulse.first_peak().map(|peak| [peak.dynamic_n, peak.time_s]);
    let highest = peak.map_or(0.0, |[force, _]| force);
    let times = LEVELS.map(|level| pulse.first_reach(level * highest).unwrap_or(-1.0));
    let passed = pulse.passed_over().filter(|p| p.dynamic_n > LOWEST_LEVEL * highest);
    let passed = passed.map(|passed| [passed.dynamic_n, passed.until_s]);
    let all = peak.unwrap_or_default().into_iter().chain(times);
    let all = all.chain(passed.into_iter().flatten());
    all.map(f64::to_bits).collect()
}

/// Maxima that were the first peak for a while, by what a recorder said of it after each step.
#[derive(Clone, Default)]
struct Abandoned {
    first: Option<Peak>,
    /// The highest (N).
    highest: f64,
}

impl Abandoned {
    fn see(&mut self, pulse: &PulseRecorder) {
        let now = pulse.first_peak();
        if let (Some(before), Some(now)) = (self.first, now)
            && now.time_s > before.time_s
        {
            self.highest = self.highest.max(before.dynamic_n);
        }
        self.first = now.or(self.first);
    }
}

/// Recorders at `probes` that look into the steps they want to, others that look into every one, and what those gave up; none for steps that are too
/// long.
fn choosy_and_thorough(
    scene: &Scene,
    method: Method,
    probes: &[ForceProbe],
) -> Option<([Vec<PulseRecorder>; 2], Vec<Abandoned>)> {
    let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
    let impact = chain.impact_force(velocities);
    let recorder = |probe: &ForceProbe| PulseRecorder::new(probe, impact, velocities);
    let recorders = || probes.iter().map(recorder);
    let (mut choosy, mut thorough): (Vec<_>, Vec<_>) =
        (recorders().collect(), recorders().collect());
    let mut abandoned = vec![Abandoned::default(); probes.len()];
    let mut felt: Vec<[f64; 2]> = thorough.iter().map(PulseRecorder::felt).collect();
    let scheme = method.scheme().expect("a method of the stepper's");
    let mut stepper = ChainStepper::new(chain, velocities, scheme, InstructionSet::best());
    let mut trail = stepper.trail(probes);
    while stepper.time() < scene.duration {
        stepper.follow(&mut trail, [scene.duration; 2]).ok()?;
        let steps = trail.steps();
        if steps < Trail::STEPS && stepper.time() < scene.duration {
            continue;
        }
        for (place, choosy) in choosy.iter().enumerate() {
            trail.ask(place, choosy.asks());
        }
        stepper.read(&mut trail, Depth::All);
        for (place, (choosy, thorough)) in choosy.iter_mut().zip(&mut thorough).enumerate() {
            let seen = trail.seen(place);
            choosy.follow(seen, trail.wanted(place), steps);
            for step in 0..steps {
                let asked = thorough.asks();
                felt[place] = thorough.go_on(felt[place], seen, step);
                // Nothing else changes what is first.
                if asked.map(f64::to_bits) != thorough.asks().map(f64::to_bits) {
                    abandoned[place].see(thorough);
                }
            }
        }
        trail.clear();
    }
    Some(([choosy, thorough], abandoned))
}

/// The same recorder, once it is known that nothing follows. What is forgotten is not made up.
fn shrunk(pulse: &PulseRecorder) -> PulseRecorder {
    let shrunk = pulse.clone().readings();
    let far_below = 1e-5 * LOWEST_LEVEL * pulse.largest();
    let at_all = shrunk.first_reach(far_below);
    assert!(at_all.is_none() || at_all == pulse.first_reach(far_below), "{at_all:?}");
    shrunk
}

/// In every particle, by steps from the edge of stability down.
#[test]
fn a_force_reads_the_same_wherever_its_steps_were_looked_into() {
    let (mut compared, mut passed_over) = (0, 0);
    let rattling = Scene::from_text("rattling", "rattling.toml", RATTLING).expect("a scene");
    let shipped = ["magnet-0.61g", "gravity-17.81g", "monatomic-vacuum"]
        .map(|name| Scene::load(name).expect("a shipped scene"));
    for scene in shipped.into_iter().chain([rattling]) {
        let name = &scene.name;
        let inside = |particle| ForceProbe::inside(&scene.chain, particle, 0.0);
        let probes: Vec<ForceProbe> = (1..scene.chain.bodies().len()).filter_map(inside).collect();
        let pairs = [
            Method::DormandElMikkawyPrince64 { tolerance: 1e-1 },
            Method::DormandElMikkawyPrince64 { tolerance: 1e-3 },
            Method::DormandElMikkawyPrince86 { tolerance: 1e-5 },
        ];
        let steps = METHODS.into_iter().flat_map(|make| {
            let (_, reach) = make(1.0).fixed_step().expect("a method with a fixed step");
            let limit = scene.chain.stability_limit(&scene.initial_velocities, reach);
            let limit = limit.expect("contacts").step;
            [0.9, 0.2].map(|share| make(share * limit))
        });
        for method in pairs.into_iter().chain(steps) {
            let Some(([choosy, thorough], abandoned)) =
                choosy_and_thorough(&scene, method, &probes)
            else {
                continue;
            };
            for (index, (a, b)) in choosy.iter().zip(&thorough).enumerate() {
                let Abandoned { first, highest } = abandoned[index];
                let words = format!("{name}, particle {}, {method}", index + 1);
                assert_eq!(readings(a), readings(b), "{words}");
                assert_eq!(readings(&shrunk(a)), readings(a), "{words}, shrunk");
                compared += 1;
                if highest > LOWEST_LEVEL * first.map_or(0.0, |peak| peak.dynamic_n) {
                    let told = shrunk(a).passed_over().map_or(0.0, |passed| passed.dynamic_n);
                    assert!(told >= highest, "{words}: {told:e} of {highest:e}");
                    passed_over += 1;
                }
            }
        }
    }
    println!("{compared} forces, in {passed_over} another maximum was first for a while");
    assert!(compared > 900 && passed_over > 10, "{compared}, {passed_over}");
}

/// Samples taken within steps are the forces of a chain that was stopped at their times, by the contacts' own formula, in every form of the forces;
/// before anything arrives they are nothing to the last bit.
#[test]
fn samples_are_the_forces_at_their_times() {
    const GRID: Grid = Grid { start: -3e-6, interval: 0.7e-6 };
    // As exact as the motion is by these methods, relative to the largest force.
    const BOUND: f64 = 1e-8;
    let by_pair = |tolerance| Method::DormandElMikkawyPrince86 { tolerance };
    for (cells, force, linear) in
        [(8, 2.38, false), (300, 2.38, false), (8, 0.0, false), (8, 2.38, true)]
    {
        let chain = diatomic(cells, force, linear);
        let probes = [5, 2 * cells].map(|particle| ForceProbe::inside(&chain, particle, 0.2));
        let probes = probes.map(|probe| probe.expect("a particle"));
        for method in [by_pair(1e-10), by_pair(1e-13), Method::BlanesMoan { step: 0.2e-6 }] {
            let words = format!("{cells} cells, {force} N, {method}");
            let mut bench = kicked(&chain, (0, 0.4), method, &probes, GRID);
            let exact = force > 0.0 && !linear && method == by_pair(1e-13);
            assert_eq!(bench.has_exact_forces(), exact, "{words}");
            bench.run_until(300e-6, false, &mut |_| ()).expect("a run");
            let [near, far] = bench.watches() else { panic!("two watches") };
            assert_eq!(near.samples.len(), GRID.samples_until(300e-6), "{words}");
            let largest = near.samples.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
            assert!(largest > 0.1, "{words}: {largest}");
            for index in (7..near.samples.len()).step_by(31) {
                let time = GRID.time(index);
                let mut stopped = kicked(&chain, (0, 0.4), method, &[], NEVER);
                stopped.run_until(time, false, &mut |_| ()).expect("a run");
                let at = stopped.state().position;
                let felt = |contact: usize, weight: f64| {
                    let change = chain.overlap_change(&at, contact);
                    weight * chain.contacts()[contact].force_change(change)
                };
                for (watch, particle) in [(near, 5), (far, 2 * cells)] {
                    let body = chain.body_of(particle);
                    let force = felt(body, 0.3) + felt(body + 1, 0.7);
                    let off = (watch.samples[index] - force).abs() / largest;
                    assert!(off < BOUND, "{words}: {off:e} in {particle} at {time:e} s");
                }
            }
            // In 3 us news come through less than 600 particles, a contact a stage.
            let silent = &far.samples[GRID.samples_until(0.0)..GRID.samples_until(3e-6)];
            assert!(silent.len() >= 3, "{words}");
            assert!(cells == 8 || silent.iter().all(|force| *force == 0.0), "{words}: {silent:?}");
        }
    }
}

/// Steps that are taken at once, and looked into only as far as anybody asks, read the same to the last bit as steps that are taken one by one
/// because a frame of a film is due in each.
#[test]
fn steps_taken_at_once_read_the_same() {
    const SAMPLES: Grid = Grid { start: 0.0, interval: 1e-6 };
    const FRAMES: Grid = Grid { start: 0.0, interval: 0.05e-6 };
    const END: f64 = 0.7e-3;
    let mut methods: Vec<Method> = METHODS.iter().map(|make| make(2e-6)).collect();
    methods.push(Method::PacedForceGradient { tolerance: 1e-3 });
    methods.push(Method::DormandElMikkawyPrince64 { tolerance: 1e-5 });
    methods.push(Method::DormandElMikkawyPrince86 { tolerance: 1e-6 });
    let mut peaks = 0;
    for (cells, force, linear) in
        [(2, 2.38, false), (15, 2.38, false), (15, 0.0, false), (60, 2.38, true)]
    {
        let chain = diatomic(cells, force, linear);
        let probes: Vec<ForceProbe> = [1, cells, 2 * cells]
            .iter()
            .filter_map(|p| ForceProbe::inside(&chain, *p, 0.2))
            .collect();
        for method in &methods {
            for grid in [NEVER, SAMPLES] {
                let run = |frames: Grid| {
                    let mut velocities = vec![0.0; chain.bodies().len()];
                    velocities[0] = 0.4;
                    let mut bench =
                        Bench::new(&chain, &velocities, *method, &probes, (grid, frames));
                    bench.run_until(END, true, &mut |_| ()).expect("a run");
                    bench
                };
                let (once, singly) = (run(NEVER), run(FRAMES));
                let words = format!("{cells} cells, {force} N, {method}");
                assert!(singly.film().displacements[0].len() > 10_000, "{words}");
                assert_eq!(once.state(), singly.state(), "{words}");
                assert_eq!(once.work(), singly.work(), "{words}");
                for (once, singly) in once.watches().iter().zip(singly.watches()) {
                    let same = once.samples.iter().eq(&singly.samples);
                    assert!(same, "{words}: samples differ");
                    assert_eq!(readings(&once.pulse), readings(&singly.pulse), "{words}");
                    peaks += usize::from(once.pulse.first_peak().is_some());
                }
            }
        }
    }
    println!("{peaks} peaks");
    assert!(peaks > 100, "{peaks}");
}

/// Where a motion is lost in steps that were taken at once it is told which body was lost, and when, as if they had been taken one by one.
#[test]
fn what_is_lost_in_steps_taken_at_once_is_found() {
    const END: f64 = 0.2;
    let chain = diatomic(8, 2.38, true);
    let mut velocities = vec![0.0; chain.bodies().len()];
    velocities[0] = 0.4;
    for method in METHODS.map(|make| make(100e-6)) {
        let probes = [ForceProbe::inside(&chain, 5, 0.0).expect("a particle")];
        let mut bench = Bench::new(&chain, &velocities, method, &probes, (NEVER, NEVER));
        let told = bench.run_until(END, true, &mut |_| ()).expect_err("far beyond stability");
        let scheme = method.scheme().expect("a splitting");
        let mut stepper = ChainStepper::new(&chain, &velocities, scheme, InstructionSet::best());
        let mut found = Ok(());
        while found.is_ok() {
            found = stepper.step(END);
        }
        println!("{method}: {told}");
        assert_eq!(Err(told), found);
    }
}

/// What a place sees of a step through the bodies around it is what the whole chain's interpolants say, at every place of chains of every shape,
/// however many steps are looked into at a time.
#[test]
fn a_place_sees_what_the_whole_chain_does() {
    let mut chains: Vec<(Chain, Vec<f64>)> = ["magnet-0.61g", "gravity-17.81g", "monatomic-vacuum"]
        .map(|name| Scene::load(name).expect("a shipped scene"))
        .map(|scene| (scene.chain, scene.initial_velocities))
        .into();
    for (cells, force, linear) in [(1, 2.38, false), (4, 0.0, false), (8, 2.38, true)] {
        let chain = diatomic(cells, force, linear);
        let mut velocities = vec![0.0; chain.bodies().len()];
        velocities[0] = 0.4;
        chains.push((chain, velocities));
    }
    let by_pair = |tolerance| Method::DormandElMikkawyPrince86 { tolerance };
    let mut compared = 0;
    for (chain, velocities) in &chains {
        let bodies = chain.bodies().len();
        let inside = (1..=bodies).filter_map(|particle| ForceProbe::inside(chain, particle, 0.2));
        let contacts = (1..=bodies).filter_map(|contact| ForceProbe::contact(chain, contact));
        let probes: Vec<ForceProbe> = inside.chain(contacts).collect();
        let scale = chain.impact_force(velocities)
            + probes.iter().map(ForceProbe::static_force).fold(0.1, f64::max);
        for (method, set) in [by_pair(1e-6), by_pair(1e-13), Method::BlanesMoan { step: 0.5e-6 }]
            .into_iter()
            .flat_map(|method| {
                InstructionSet::available().into_iter().map(move |set| (method, set))
            })
        {
            let scheme = method.scheme().expect("a method of the stepper's");
            let stepper = ChainStepper::new(chain, velocities, scheme, set);
            let words = format!("{bodies} bodies, {method}, {set:?}");
            compared += compare_places(stepper, &probes, (bodies, scale), &words);
        }
    }
    println!("{compared} forces and rates compared");
    assert!(compared > 1_000_000, "{compared}");
}

/// Takes steps of `stepper` and compares what is felt at `probes`, relative to a force (N); how many forces and rates.
fn compare_places(
    mut stepper: ChainStepper,
    probes: &[ForceProbe],
    (bodies, scale): (usize, f64),
    words: &str,
) -> usize {
    // Displacements of a tenth of a millimetre round to 1e-20 m, in overlaps of a micrometre, by polynomials with coefficients up to 84.
    const BOUND: f64 = 1e-11;
    const PLACES: (f64, f64) = (0.13, 0.29);
    const END: f64 = 1e-3;
    let mut trail = stepper.trail(probes);
    let (mut taken, mut compared) = (0, 0);
    // As many steps at a time as are left of eight, one less the next time.
    for most in (1..=Trail::STEPS).rev().cycle().take(30) {
        let mut whole: Vec<Option<Vec<ForceSegment>>> = Vec::new();
        while trail.steps() < most && stepper.time() < END {
            // One at a time: a pause from now on.
            let pause = stepper.time();
            stepper.follow(&mut trail, [END, pause]).expect("a step");
            taken += 1;
            if taken % 5 == 0 {
                // The whole chain is not asked for every step either.
                whole.push(None);
                continue;
            }
            stepper.prepare_interpolation();
            let place = |probe: &ForceProbe| probe.over_step(&stepper, bodies);
            whole.push(Some(probes.iter().map(place).collect()));
            check_frame(&mut stepper, bodies);
        }
        if whole.is_empty() {
            break;
        }
        stepper.read(&mut trail, Depth::All);
        for (index, probe) in probes.iter().enumerate() {
            let due = Due {
                counts: std::array::from_fn(|step| if step < whole.len() { 3 } else { 0 }),
                first: [PLACES.0; Trail::STEPS],
                interval: [PLACES.1; Trail::STEPS],
            };
            let mut sampled = Vec::new();
            stepper.sample(&trail, index, &due, &mut sampled);
            assert_eq!(sampled.len(), 3 * whole.len());
            for (step, whole) in whole.iter().enumerate() {
                let Some(whole) = whole.as_ref().map(|places| &places[index]) else {
                    continue;
                };
                let place = probe.body();
                let mut check = |force: f64, exact: f64| {
                    let off = (force - exact).abs() / scale;
                    assert!(off < BOUND, "{words}: {off:e} at {place}");
                    compared += 1;
                };
                for (sample, force) in (0_u8..).zip(&sampled[3 * step..][..3]) {
                    check(*force, whole.force(PLACES.0 + f64::from(sample) * PLACES.1));
                }
                let seen = trail.seen(index);
                let (looks, length) = (seen.looks(step), whole.length);
                for (look, theta) in LOOKED_AT.into_iter().enumerate() {
                    check(looks.forces[look], whole.force(theta));
                    // A rate times the step is as exact as a force.
                    check(length * looks.rates[look], length * whole.rate(theta));
                }
                let ([force, rate], seen_length) = seen.end(step);
                check(force, whole.force(1.0));
                check(length * rate, length * whole.rate(1.0));
                assert_eq!(seen_length.to_bits(), length.to_bits());
            }
        }
        trail.clear();
    }
    compared
}

/// The whole chain at a time within the last step stands where its bodies' interpolants say.
fn check_frame(stepper: &mut ChainStepper, bodies: usize) {
    const THETA: f64 = 0.37;
    // Of the largest displacement: coefficients of up to 84, rounded to 1e-16, add up (1).
    const BOUND: f64 = 1e-13;
    let alone: Vec<f64> =
        (0..bodies).map(|body| stepper.interpolant(body).position(THETA)).collect();
    let largest = alone.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let (positions, _) = stepper.frame(THETA);
    for (body, (frame, alone)) in positions.zip(alone).enumerate() {
        assert!((frame - alone).abs() <= BOUND * largest, "{body}: {frame:e} and {alone:e}");
    }
}
