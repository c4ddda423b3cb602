//! What is done about contacts that open and close, side by side: errors against work on a chain under gravity, where they do so all the time.
//! `cargo bench --bench kinks`; with `-- FILE.svg` drawn, too. The treatments that hertzscope does not use are written down here in a few lines.
#![allow(clippy::expect_used, reason = "a bench that cannot run has nothing to say")]

mod kinks {
    pub mod chart;
    pub mod treatments;
}

use std::path::PathBuf;

use hertzscope::chain::stepper::{ChainStepper, InstructionSet, Refinement};
use hertzscope::experiment::bench::start;
use hertzscope::integrate::{Integrator, Method};
use hertzscope::scene::Scene;
use kinks::chart;
use kinks::treatments::{Fixed, Motion};

/// The scene, and up to when (s).
const SCENE: (&str, f64) = ("gravity-0.61g", 0.5e-3);
/// Errors that a treatment is to reach (1).
const WANTED: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Fixed steps up to the end.
const STEPS: [u32; 22] = [
    64, 90, 128, 181, 256, 362, 512, 724, 1024, 1448, 2048, 2896, 4096, 5792, 8192, 11585, 16384,
    23170, 32768, 46340, 65536, 92681,
];
/// Evaluations beyond which nobody waits.
const MOST: f64 = 3e5;
/// Errors between which orders are fitted: coarser steps resolve nothing, and finer ones come near the reference (1).
const FITTED: (f64, f64) = (1e-10, 1e-3);

/// A treatment's errors by its force evaluations.
pub struct Row {
    name: &'static str,
    points: Vec<(f64, f64)>,
}

impl Row {
    /// Exponent of the error against evaluations, by least squares (1).
    fn order(&self) -> Option<f64> {
        let fitted = |(_, error): &&(f64, f64)| (FITTED.0..FITTED.1).contains(error);
        let points: Vec<(f64, f64)> =
            self.points.iter().filter(fitted).map(|(n, e)| (n.ln(), e.ln())).collect();
        #[allow(clippy::cast_precision_loss, reason = "a few points")]
        let count = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        let variance: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
        (points.len() > 2).then(|| -covariance / variance)
    }

    /// The fewest evaluations with which it, as with all more, errs by no more than `wanted` (1).
    fn reaches(&self, wanted: f64) -> Option<f64> {
        let holds = |(_, error): &&(f64, f64)| *error <= wanted;
        self.points.iter().rev().take_while(holds).last().map(|(count, _)| *count)
    }
}

fn main() {
    let rows = rows();
    println!(
        "| up to {} ms of {} | order | evaluations to 1e-3 | 1e-6 | 1e-9 |\n|---|---|---|---|---|",
        1e3 * SCENE.1,
        SCENE.0
    );
    for row in &rows {
        let order = row.order().map_or("-".to_owned(), |order| format!("{order:.1}"));
        let cells = WANTED.map(|wanted| {
            row.reaches(wanted).map_or("more".to_owned(), |count| format!("{count:.0}"))
        });
        println!("| {} | {order} | {} |", row.name, cells.join(" | "));
    }
    let pictures = std::env::args().map(PathBuf::from);
    if let Some(file) = pictures.into_iter().find(|file| file.extension() == Some("svg".as_ref())) {
        std::fs::write(file, chart::svg(&rows)).expect("a file that can be written");
    }
}

type Make = fn(f64) -> Method;

/// All treatments over their settings.
fn rows() -> Vec<Row> {
    let scene = Scene::load(SCENE.0).expect("this scene ships with the program");
    let (chain, velocities, end) = (&scene.chain, &scene.initial_velocities, SCENE.1);
    let fastest = velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let reference = Method::DormandPrince853 { tolerance: 1e-15 };
    let mut exact = start(chain, reference, chain.initial_state(velocities));
    exact.advance(end).expect("a motion");
    let exact = exact.state().velocity;
    let error = |found: &[f64]| {
        let off = found.iter().zip(&exact).map(|(a, b)| (a - b).abs());
        off.fold(0.0, f64::max) / fastest
    };
    let mut rows = Vec::new();
    for (name, fixed) in Fixed::ALL {
        let mut points = Vec::new();
        for steps in STEPS {
            let mut motion = Motion::new(chain, velocities);
            fixed.run(&mut motion, steps, end);
            if motion.evaluations > MOST {
                break;
            }
            points.push((motion.evaluations, error(&motion.v)));
        }
        rows.push(Row { name, points });
    }
    let controlled: [(&str, Make, bool); 5] = [
        (
            "Dormand-Prince 8(5,3), error control",
            |t| Method::DormandPrince853 { tolerance: t },
            false,
        ),
        (
            "Runge-Kutta-Nystrom 6(4), error control",
            |t| Method::DormandElMikkawyPrince64 { tolerance: t },
            true,
        ),
        ("the same, kinks put right", |t| Method::DormandElMikkawyPrince64 { tolerance: t }, false),
        (
            "Runge-Kutta-Nystrom 8(6), error control",
            |t| Method::DormandElMikkawyPrince86 { tolerance: t },
            true,
        ),
        ("the same, kinks put right", |t| Method::DormandElMikkawyPrince86 { tolerance: t }, false),
    ];
    for (name, make, as_they_are) in controlled {
        let mut points = Vec::new();
        for tolerance in (2..=26).map(|k| 10f64.powf(-0.5 * f64::from(k))) {
            let method = make(tolerance);
            let mut motion: Box<dyn Integrator> = match method.scheme() {
                Some(scheme) if as_they_are => Box::new(
                    ChainStepper::new(chain, velocities, scheme, InstructionSet::best())
                        .without(Refinement::KinkCorrection, chain),
                ),
                _ => start(chain, method, chain.initial_state(velocities)),
            };
            motion.advance(end).expect("a motion");
            #[allow(clippy::cast_precision_loss, reason = "counts far below 2^53")]
            let count = motion.work().force_evaluations as f64;
            points.push((count, error(&motion.state().velocity)));
        }
        rows.push(Row { name, points });
    }
    rows
}
