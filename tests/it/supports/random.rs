//! Random chains with moving walls against a solver written for this test: positions and speeds of
//! bodies and walls, fixed steps of the classical Runge-Kutta method, forces by Hertz's formula.

use std::fmt::Write as _;

use std::f64::consts::{PI, TAU};

use hertzscope::experiment::accuracy::run_to_accuracy;
use hertzscope::scene::Scene;

/// Young's modulus (Pa), Poisson's ratio and density (kg/m³) of the one material.
const MATERIAL: (f64, f64, f64) = (70e9, 0.33, 2700.0);

/// Numbers from 0 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

/// A random bench.
struct Bench {
    radii: Vec<f64>,
    preload: f64,
    /// Amplitude (m), frequency (Hz), cycles, and stiffness of a stack (N/m).
    drive: (f64, f64, f64, Option<f64>),
    dashpot: f64,
    /// Impedance of the rod at the bottom by its diameter (m), and its length (m) and reflection.
    rod: Option<(f64, Option<(f64, f64)>)>,
    duration: f64,
}

impl Bench {
    fn drawn(random: &mut Random) -> Self {
        let particles = 2 + (4.0 * random.next()) as usize;
        let radii: Vec<f64> = (0..particles).map(|_| random.between(1e-3, 4e-3)).collect();
        let preload = random.between(0.5, 50.0);
        let stack = (random.next() < 0.5).then(|| random.between(3e6, 1e8));
        let frequency = random.between(3e3, 4e4);
        let overlap = (preload / (0.6 * MATERIAL.0 * radii[0].sqrt())).powf(2.0 / 3.0);
        let amplitude = overlap * random.between(0.01, 0.2);
        let echo = (random.next() < 0.5)
            .then(|| (random.between(0.02, 0.2), if random.next() < 0.5 { 1.0 } else { -1.0 }));
        let rod = (random.next() < 0.7).then(|| (random.between(2e-3, 30e-3), echo));
        let dashpot = if random.next() < 0.3 { random.between(0.01, 1.0) } else { 0.0 };
        let drive = (amplitude, frequency, 1.0 + (4.0 * random.next()).floor(), stack);
        Self { radii, preload, drive, dashpot, rod, duration: 250e-6 }
    }

    fn scene(&self, accuracy: f64) -> Scene {
        let (modulus, ratio, density) = MATERIAL;
        let mut text = format!(
            "duration = \"{:e} s\"\naccuracy = {accuracy:e}\nmaterials.m = {{ youngs_modulus = \"{modulus:e} Pa\", poissons_ratio = {ratio}, density = \"{density} kg/m^3\" }}\n",
            self.duration
        );
        for (i, radius) in self.radii.iter().enumerate() {
            let _ = writeln!(
                text,
                "particles.p{i} = {{ material = \"m\", diameter = \"{:.17e} m\", mass = \"{:.17e} kg\" }}",
                2.0 * radius,
                mass(*radius)
            );
        }
        let names: Vec<String> = (0..self.radii.len()).map(|i| format!("\"p{i}\"")).collect();
        let (amplitude, frequency, cycles, stack) = self.drive;
        let bottom = match self.rod {
            None => "{ wall = \"m\" }".to_owned(),
            Some((diameter, echo)) => {
                let echo = echo.map_or_else(String::new, |(length, reflection)| {
                    let end = if reflection > 0.0 { "free" } else { "held" };
                    format!(", length = \"{length:.17e} m\", far_end = \"{end}\"")
                });
                format!("{{ rod = \"m\", diameter = \"{diameter:.17e} m\"{echo} }}")
            }
        };
        let _ = writeln!(
            text,
            "chain = {{ top = {{ wall = \"m\", preload = \"{:.17e} N\" }}, bottom = {bottom}, segments = [{{ particles = [{}] }}] }}",
            self.preload,
            names.join(", ")
        );
        let motion = match stack {
            None => format!("displacement = \"{amplitude:.17e} m\""),
            Some(k) => format!(
                "stack = {{ stiffness = \"{k:.17e} N/m\", stroke = \"{amplitude:.17e} m\" }}"
            ),
        };
        let _ = writeln!(
            text,
            "drive = {{ {motion}, signal = {{ burst = \"{frequency:.17e} Hz\", cycles = {cycles}, window = \"hann\" }} }}\n"
        );
        if self.dashpot > 0.0 {
            let _ = writeln!(
                text,
                "effects.dashpot = {{ gamma = \"{:.17e} N*s/m\", end_of_contact = \"zero_overlap\" }}",
                self.dashpot
            );
        }
        let _ = writeln!(
            text,
            "sensors.s = {{ model = \"pzt-5a-710pf\", particle = {} }}\n[scope]\nmodel = \"tds2014\"\ntime_base = \"25 us/div\"\nposition = \"100 us\"\ntrigger = {{ source = \"CH1\", level = \"1 V\" }}\nch1 = {{ input = \"s\", scale = \"1 V/div\" }}",
            self.radii.len()
        );
        Scene::from_text("random", "random.toml", &text).unwrap_or_else(|e| panic!("{e}\n{text}"))
    }

    /// First peak of the dynamic force in the last particle (N), and its time (s), by steps of `h`
    /// (s).
    #[allow(
        clippy::too_many_lines,
        reason = "a plain solver in one piece, read from top to bottom"
    )]
    fn first_peak(&self, h: f64) -> Option<(f64, f64)> {
        let n = self.radii.len();
        let (modulus, ratio, density) = MATERIAL;
        let reduced = modulus / (2.0 * (1.0 - ratio * ratio));
        let hertz = |j: usize| {
            let curvature = |i: Option<usize>| {
                i.and_then(|i| self.radii.get(i)).map_or(0.0, |radius| 1.0 / radius)
            };
            let sum = curvature(j.checked_sub(1)) + curvature(Some(j));
            4.0 / 3.0 * reduced / sum.sqrt()
        };
        let stiffness: Vec<f64> = (0..=n).map(hertz).collect();
        let rest: Vec<f64> = stiffness.iter().map(|a| (self.preload / a).powf(2.0 / 3.0)).collect();
        let law = |j: usize, change: f64| {
            stiffness[j] * (rest[j] + change).max(0.0).powf(1.5) - self.preload
        };
        // A stack and a contact in series, by bisection on the force.
        let series = |change: f64| match self.drive.3 {
            None => law(0, change),
            Some(k) => {
                let (mut low, mut high) = (-self.preload, law(0, change.abs()));
                for _ in 0..70 {
                    let force = 0.5 * (low + high);
                    if law(0, change - force / k) > force { low = force } else { high = force }
                }
                0.5 * (low + high)
            }
        };
        let (amplitude, frequency, cycles, _) = self.drive;
        let length = cycles / frequency;
        let drive = |t: f64| {
            if t < 0.0 || t > length {
                return (0.0, 0.0);
            }
            let window = 0.5 * (1.0 - (TAU * t / length).cos());
            let slope = 0.5 * TAU / length * (TAU * t / length).sin();
            let (sine, cosine) = (TAU * frequency * t).sin_cos();
            let speed = TAU * frequency * cosine * window + sine * slope;
            (amplitude * sine * window, amplitude * speed)
        };
        let speed = (modulus / density).sqrt();
        let impedance =
            self.rod.map(|(diameter, _)| 0.25 * PI * diameter.powi(2) * density * speed);
        let echo = self.rod.and_then(|(_, echo)| echo).map(|(length, r)| (2.0 * length / speed, r));
        // Departing velocities at the ends of all steps so far.
        let mut departed: Vec<f64> = vec![0.0];
        let returning = |t: f64, departed: &[f64]| {
            let Some((delay, r)) = echo else { return 0.0 };
            let at = (t - delay) / h;
            if at < 0.0 {
                return 0.0;
            }
            // Four points' cubic.
            let first = (at.floor() as usize).saturating_sub(1).min(departed.len() - 4);
            let s = at - first as f64;
            let value = |i: usize| departed[first + i];
            let cubic = -(s - 1.0) * (s - 2.0) * (s - 3.0) / 6.0 * value(0)
                + s * (s - 2.0) * (s - 3.0) / 2.0 * value(1)
                - s * (s - 1.0) * (s - 3.0) / 2.0 * value(2)
                + s * (s - 1.0) * (s - 2.0) / 6.0 * value(3);
            r * cubic
        };
        // State: positions, speeds, displacement of the rod's face.
        let rates = |t: f64, y: &[f64], departed: &[f64]| {
            let (w, w_speed) = drive(t);
            let mut forces = vec![0.0; n + 1];
            let mut face_speed = 0.0;
            for j in 0..=n {
                let (above, above_speed) =
                    if j == 0 { (w, w_speed) } else { (y[j - 1], y[n + j - 1]) };
                let (below, below_speed) = if j < n { (y[j], y[n + j]) } else { (y[2 * n], 0.0) };
                let change = above - below;
                let elastic = if j == 0 { series(change) } else { law(j, change) };
                forces[j] = elastic + self.dashpot * (above_speed - below_speed);
                if let (true, Some(z)) = (j == n, impedance) {
                    // The face's own speed is in the dashpot's closing speed.
                    let g = returning(t, departed);
                    let force = (elastic + self.dashpot * (above_speed - 2.0 * g))
                        / (1.0 + self.dashpot / z);
                    forces[j] = force;
                    face_speed = force / z + 2.0 * g;
                }
            }
            let mut out = vec![0.0; 2 * n + 1];
            for i in 0..n {
                out[i] = y[n + i];
                out[n + i] = (forces[i] - forces[i + 1]) / mass(self.radii[i]);
            }
            out[2 * n] = face_speed;
            (out, forces)
        };
        let mut y = vec![0.0; 2 * n + 1];
        let mut samples = vec![0.0];
        let steps = (self.duration / h).round() as usize;
        for step in 0..steps {
            let t = step as f64 * h;
            let add = |k: &[f64], by: f64| -> Vec<f64> {
                y.iter().zip(k).map(|(y, k)| y + by * k).collect()
            };
            let (a, _) = rates(t, &y, &departed);
            let (b, _) = rates(t + 0.5 * h, &add(&a, 0.5 * h), &departed);
            let (c, _) = rates(t + 0.5 * h, &add(&b, 0.5 * h), &departed);
            let (d, _) = rates(t + h, &add(&c, h), &departed);
            for i in 0..y.len() {
                y[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
            }
            let (at, forces) = rates(t + h, &y, &departed);
            departed.push(at[2 * n] - returning(t + h, &departed));
            samples.push(0.5 * (forces[n - 1] + forces[n]));
        }
        let largest = samples.iter().fold(0.0_f64, |most, force| most.max(*force));
        let place = (1..samples.len() - 1).find(|i| {
            let [before, now, after] = [samples[i - 1], samples[*i], samples[i + 1]];
            now > 0.25 * largest && now > before && now >= after
        })?;
        let [before, now, after] = [samples[place - 1], samples[place], samples[place + 1]];
        let shift = 0.5 * (before - after) / (before - 2.0 * now + after);
        let peak = now - 0.25 * (before - after) * shift;
        Some((peak, (place as f64 + shift) * h))
    }
}

fn mass(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3) * MATERIAL.2
}

/// Fifty benches at accuracies from 1e-3 to 1e-9: the first peak and its time are as accurate as
/// asked for.
#[test]
fn fifty_random_driven_chains_agree_with_a_plain_solver() {
    let mut random = Random(0x2545_F491_4F6C_DD1D);
    let (mut worst, mut compared) = (0.0_f64, 0);
    for number in 0..50 {
        let bench = Bench::drawn(&mut random);
        let accuracy = [1e-3, 1e-5, 1e-7, 1e-9][number % 4];
        let scene = bench.scene(accuracy);
        let found = run_to_accuracy(&scene, accuracy, 1, &mut |_| ()).expect("a run").summary;
        let step = if accuracy < 1e-8 { 1.5625e-9 } else { 1.25e-8 };
        let (peak, exact) = (found.sensors[0].first_peak, bench.first_peak(step));
        assert_eq!(peak.is_some(), exact.is_some(), "{number}: {peak:?} {exact:?}");
        let Some((peak, (force, time))) = peak.zip(exact) else { continue };
        compared += 1;
        let error = (peak.dynamic_n / force - 1.0).abs();
        let late = (peak.time_s / time - 1.0).abs();
        println!("{number}: asked {accuracy:e}, force {error:.1e}, time {late:.1e}");
        worst = worst.max(error / accuracy);
        // The time of a parabola's top is known to the square root of rounding.
        assert!(error <= accuracy, "{number}: {error:e} of {accuracy:e}");
        assert!(late <= accuracy.max(1e-7), "{number}: {late:e} of {accuracy:e}");
    }
    println!("largest error: {worst:.2} of what was asked for, {compared} peaks");
    assert!(compared > 40, "{compared}");
}
