//! Band edges against preload as a table and as a curve.

use super::plot::{Curve, braille};
use super::table;
use crate::analysis::dispersion::DiatomicChain;
use crate::quantity::engineering;

/// The gap's lower edge over the preload.
pub fn bands_curve(rows: &[(f64, DiatomicChain)], now: f64) -> Curve {
    Curve {
        points: rows.iter().map(|(force, chain)| (*force, chain.gap_bottom())).collect(),
        marks: vec![(now, "the scene's preload".to_owned())],
        x_label: "preload".to_owned(),
        y_label: "f1, the gap's lower edge (Hz); f2 and f3 are in proportion".to_owned(),
    }
}

/// The page that `bands` prints.
pub fn bands(title: &str, rows: &[(f64, DiatomicChain)], now: f64) -> String {
    let hertz = |f: f64| engineering(f, "Hz", 5);
    let heading = ["preload", "f1, gap from", "f2, gap to", "f3, cutoff", "long waves", ""];
    let mut lines = vec![heading.map(str::to_owned).to_vec()];
    lines.extend(rows.iter().map(|(force, chain)| {
        vec![
            engineering(*force, "N", 4),
            hertz(chain.gap_bottom()),
            hertz(chain.gap_top()),
            hertz(chain.cutoff()),
            engineering(chain.sound_speed(), "m/s", 4),
            if (*force - now).abs() <= f64::EPSILON * now { "the scene's preload" } else { "" }
                .to_owned(),
        ]
    }));
    let mut page = vec![title.to_owned()];
    page.extend(table::lines(&lines, &[5]));
    page.push(String::new());
    let newtons = |force: f64| engineering(force, "N", 3);
    page.extend(braille(&bands_curve(rows, now), &newtons, &hertz));
    page.join("\n")
}
