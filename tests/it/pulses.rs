//! Forces at probes: samples, first peaks and arrivals of the vector path against the contacts' own
//! formula and the general path's segments.

use hertzscope::chain::{Chain, ForceProbe};
use hertzscope::experiment::bench::Grid;
use hertzscope::experiment::pulse::{MIN_LEVEL_SHARE, PulseRecorder};
use hertzscope::motion::force_segment::over_step;
use hertzscope::motion::kernel::{InstructionSet, VectorStepper};
use hertzscope::motion::probe_step::{ProbeTracker, SAMPLE_TIMES};
use hertzscope::motion::{Integrator, Method, Scheme};
use hertzscope::scene::Scene;

use super::chains::{NEVER, diatomic, kicked};

/// Shares of the first peak at which arrivals are compared (1).
const LEVELS: [f64; 5] = [MIN_LEVEL_SHARE, 0.03, 0.1, 0.5, 0.95];

/// Light beads rattle on while heavy ones press them harder and harder: maxima are first until
/// larger forces come.
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

/// First peak (N, s) and first times of levels (s).
fn readings(pulse: &PulseRecorder) -> Vec<f64> {
    let Some(peak) = pulse.first_peak() else { return Vec::new() };
    let times = LEVELS.map(|level| pulse.first_reach(level * peak.dynamic_n).unwrap_or(-1.0));
    [peak.dynamic_n, peak.time_s].into_iter().chain(times).collect()
}

/// In every particle, the recorder that samples only steps that may matter reads what one reads
/// that samples every step of the general path's segments. Both interpolate the same steps:
/// rounding tells them apart, and that a correction at an opening that moves bodies by less than 3
/// % of the tolerance leaves the jerks of the general path as they were.
#[test]
fn steps_that_are_not_sampled_hold_nothing() {
    let mut compared = 0;
    let rattling = Scene::from_text("rattling", "rattling.toml", RATTLING).expect("a scene");
    let shipped = ["magnet-0.61g", "gravity-17.81g", "monatomic-vacuum"]
        .map(|name| Scene::load(name).expect("a shipped scene"));
    for scene in shipped.into_iter().chain([rattling]) {
        let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
        let bodies = chain.bodies().len();
        let inside = |particle| ForceProbe::inside(chain, particle, 0.0);
        let probes: Vec<ForceProbe> = (1..bodies).filter_map(inside).collect();
        let fixed = |share: f64, make: fn(f64) -> Method| {
            let (_, reach) = make(1.0).fixed_step().expect("a method with a fixed step");
            let limit = chain.stability_limit(velocities, reach).expect("contacts").step;
            make(share * limit)
        };
        for method in [
            Method::DormandElMikkawyPrince86 { tolerance: 1e-3 },
            Method::DormandElMikkawyPrince86 { tolerance: 1e-5 },
            Method::TwoStepForceGradient { tolerance: 1e-3 },
            fixed(0.2, |step| Method::ForceGradient { step }),
            // Steps of more than half an oscillation.
            fixed(0.35, |step| Method::ForceGradient { step }),
            fixed(0.55, |step| Method::ForceGradient { step }),
            fixed(0.2, |step| Method::VelocityVerlet { step }),
        ] {
            let impact = chain.impact_force(velocities);
            let recorder = |probe: &ForceProbe| PulseRecorder::new(probe, impact, velocities);
            let mut found: Vec<PulseRecorder> = probes.iter().map(recorder).collect();
            let mut every: Vec<PulseRecorder> = probes.iter().map(recorder).collect();
            let state = chain.initial_state(velocities);
            let Scheme::Lossless(scheme) = method.scheme() else { panic!("a method for losses") };
            let mut stepper = VectorStepper::new(chain, &state, scheme, InstructionSet::best());
            let tracker = |probe| ProbeTracker::new(probe, &stepper, bodies);
            let mut trackers: Vec<ProbeTracker> = probes.iter().map(tracker).collect();
            while stepper.time() < scene.duration {
                // Steps beyond stability may lose the motion.
                if stepper.step(scene.duration).is_err() {
                    break;
                }
                for (index, probe) in probes.iter().enumerate() {
                    trackers[index].advance(&stepper);
                    found[index].take_step(&trackers[index]);
                    every[index].process_step(over_step(probe, &stepper, bodies));
                }
            }
            for (particle, (found, every)) in (1..).zip(found.iter().zip(&every)) {
                let (found, every) = (readings(found), readings(every));
                let bound = 1e-9 + 1e-4 * method.tolerance().unwrap_or(0.0);
                assert_eq!(
                    found.len(),
                    every.len(),
                    "{}, particle {particle}, {method}",
                    scene.name
                );
                for (a, b) in found.iter().zip(&every) {
                    let off = (a / b - 1.0).abs();
                    assert!(
                        off < bound,
                        "{}, particle {particle}, {method}: {found:?} {every:?}",
                        scene.name
                    );
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 3_000, "{compared}");
}

/// Samples taken within steps are the forces of a chain that was stopped at their times, by the
/// contacts' own formula; before anything arrives they are zero to the last bit.
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
        for method in [by_pair(1e-10), by_pair(1e-13), Method::ForceGradient { step: 0.05e-6 }] {
            let words = format!("{cells} cells, {force} N, {method}");
            let mut bench = kicked(&chain, (0, 0.4), method, &probes, GRID);
            bench.run_until(300e-6, false, &mut |_| ()).expect("a run");
            let [near, far] = bench.watches() else { panic!("two watches") };
            assert_eq!(near.samples.len(), GRID.samples_until(300e-6), "{words}");
            let largest = near.samples.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
            assert!(largest > 0.1, "{words}: {largest}");
            for index in (7..near.samples.len()).step_by(61) {
                let time = GRID.time(index);
                let mut stopped = kicked(&chain, (0, 0.4), method, &[], NEVER);
                stopped.run_until(time, false, &mut |_| ()).expect("a run");
                let at = stopped.state().position;
                let measured = |contact: usize, weight: f64| {
                    let change = chain.overlap_change(&at, contact);
                    weight * chain.contacts()[contact].force_change(change)
                };
                for (watch, particle) in [(near, 5), (far, 2 * cells)] {
                    let body = chain.body_of(particle);
                    let force = measured(body, 0.3) + measured(body + 1, 0.7);
                    let off = (watch.samples[index] - force).abs() / largest;
                    assert!(off < BOUND, "{words}: {off:e} in {particle} at {time:e} s");
                }
            }
            // In 3 us motion spreads through less than 600 particles, a contact a stage.
            let silent = &far.samples[GRID.samples_until(0.0)..GRID.samples_until(3e-6)];
            assert!(silent.len() >= 3, "{words}");
            assert!(cells == 8 || silent.iter().all(|force| *force == 0.0), "{words}: {silent:?}");
        }
    }
}

/// What a tracker computes from the bodies around it is what the whole chain's interpolants give,
/// everywhere in chains of every shape, and a frame of the whole chain stands where they say.
#[test]
fn trackers_and_frames_agree_with_the_interpolants() {
    // Displacements of a tenth of a millimetre round to 1e-20 m, in overlaps of a micrometre, by
    // polynomials with coefficients up to 84.
    const ROUNDING: f64 = 1e-11;
    const THETA: f64 = 0.37;
    let mut chains: Vec<(Chain, Vec<f64>)> = ["magnet-0.61g", "gravity-17.81g", "monatomic-vacuum"]
        .map(|name| Scene::load(name).expect("a shipped scene"))
        .map(|scene| (scene.chain, scene.initial_velocities))
        .into();
    for (cells, force) in [(1, 2.38), (4, 0.0), (8, 2.38)] {
        let chain = diatomic(cells, force, false);
        let mut velocities = vec![0.0; chain.bodies().len()];
        velocities[0] = 0.4;
        chains.push((chain, velocities));
    }
    for (chain, velocities) in &chains {
        let bodies = chain.bodies().len();
        let inside = (1..=bodies).filter_map(|particle| ForceProbe::inside(chain, particle, 0.2));
        let contacts = (1..=bodies).filter_map(|contact| ForceProbe::contact(chain, contact));
        let probes: Vec<ForceProbe> = inside.chain(contacts).collect();
        let statics = probes.iter().map(ForceProbe::static_force).fold(0.1, f64::max);
        let scale = chain.impact_force(velocities) + statics;
        let methods = [
            Method::DormandElMikkawyPrince86 { tolerance: 1e-6 },
            Method::ForceGradient { step: 0.5e-6 },
        ];
        for (method, set) in methods
            .into_iter()
            .flat_map(|m| InstructionSet::available().into_iter().map(move |set| (m, set)))
        {
            let Scheme::Lossless(scheme) = method.scheme() else { panic!("a method for losses") };
            // Corrections at openings leave jerks as they were, as above.
            let bound = ROUNDING + 1e-4 * method.tolerance().unwrap_or(0.0);
            let state = chain.initial_state(velocities);
            let mut stepper = VectorStepper::new(chain, &state, scheme, set);
            let tracker = |probe| ProbeTracker::new(probe, &stepper, bodies);
            let mut trackers: Vec<ProbeTracker> = probes.iter().map(tracker).collect();
            for _ in 0..100 {
                if stepper.time() >= 1e-3 {
                    break;
                }
                stepper.step(1e-3).expect("a step");
                for (tracker, probe) in trackers.iter_mut().zip(&probes) {
                    tracker.advance(&stepper);
                    let (whole, step) = (over_step(probe, &stepper, bodies), tracker.overlaps());
                    for theta in SAMPLE_TIMES.into_iter().chain([0.0, THETA]) {
                        let [force, rate] = tracker.pair().force_and_rate(&step, theta);
                        let off = (force - whole.force(theta)).abs() / scale;
                        // A rate times the step is as exact as a force.
                        let rate_off = step.length * (rate - whole.rate(theta)).abs() / scale;
                        assert!(
                            off < bound && rate_off < bound,
                            "{bodies} bodies, {method}: {off:e}, {rate_off:e}"
                        );
                    }
                    let off = (tracker.end()[0] - whole.force(1.0)).abs() / scale;
                    assert!(off < bound, "{bodies} bodies, {method}: {off:e}");
                }
                let alone: Vec<f64> =
                    (0..bodies).map(|body| stepper.interpolant(body).position(THETA)).collect();
                let largest = alone.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                let (positions, _) = stepper.frame(THETA);
                for (frame, alone) in positions.zip(alone) {
                    assert!((frame - alone).abs() <= 1e-13 * largest, "{frame:e} and {alone:e}");
                }
            }
        }
    }
}

/// A run that is lost names the body that was lost, and when, by each method.
#[test]
fn a_lost_motion_names_the_body() {
    let chain = diatomic(8, 2.38, false);
    for step in [30e-6, 100e-6] {
        for method in [Method::VelocityVerlet { step }, Method::ForceGradient { step: 10.0 * step }]
        {
            let mut bench = kicked(&chain, (0, 0.4), method, &[], NEVER);
            let error = bench.run_until(0.2, true, &mut |_| ());
            // Hertz contacts open before numbers overflow: far beyond stability a chain may just
            // fly apart.
            if let Err(error) = error {
                assert!(error.to_string().contains("body"), "{error}");
            }
        }
    }
}
