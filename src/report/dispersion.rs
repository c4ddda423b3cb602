//! The dispersion relation of a chain with measured waves on it: as a page of text and as a
//! picture.

use std::f64::consts::PI;

use serde::{Serialize, Serializer};

use super::plot::{Axis, COLOURS, Plot, Series, Sheet, Stroke, terminal};
use super::spectrum::band_edges;
use super::table;
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::wavenumber::{SpectralLine, SpectralLines};
use crate::quantity::engineering;

/// Points of each branch.
const BRANCH_POINTS: u32 = 200;

/// Page of `dispersion`.
#[derive(Debug, Clone, PartialEq)]
pub struct DispersionPage {
    /// Names of the signals.
    pub title: String,
    /// The linear chain there.
    pub chain: DiatomicChain,
    /// Its static force (N).
    pub preload: f64,
    /// The waves found.
    pub found: SpectralLines,
    /// How many cells they were found in.
    pub cells: usize,
}

impl Serialize for DispersionPage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Line {
            frequency_hz: f64,
            phase_rad: f64,
            wavenumber_per_m: f64,
            height: f64,
            onward: bool,
            theory_hz: f64,
        }
        #[derive(Serialize)]
        struct Fields<'a> {
            title: &'a str,
            preload_n: f64,
            cell_m: f64,
            beads_per_cell: usize,
            cells: usize,
            #[serde(flatten, serialize_with = "band_edges")]
            chain: Option<DiatomicChain>,
            frequency_resolution_hz: f64,
            phase_resolution_rad: f64,
            lines: Vec<Line>,
            acoustic: Vec<(f64, f64)>,
            optical: Vec<(f64, f64)>,
        }
        let line = |line: &SpectralLine| Line {
            frequency_hz: line.frequency,
            phase_rad: line.phase,
            wavenumber_per_m: line.phase / self.chain.period(),
            height: line.height,
            onward: line.onward,
            theory_hz: self.theory(line),
        };
        let mut branches = self.branches().into_iter().map(|(_, points)| points);
        Fields {
            title: &self.title,
            preload_n: self.preload,
            cell_m: self.chain.period(),
            beads_per_cell: self.chain.beads_per_cell(),
            cells: self.cells,
            chain: Some(self.chain),
            frequency_resolution_hz: self.found.frequency_resolution,
            phase_resolution_rad: self.found.phase_resolution,
            lines: self.found.lines.iter().map(line).collect(),
            acoustic: branches.next().unwrap_or_default(),
            optical: branches.next().unwrap_or_default(),
        }
        .serialize(serializer)
    }
}

impl DispersionPage {
    /// Each branch with its name: phase a cell (rad) and frequency (Hz).
    fn branches(&self) -> Vec<(&'static str, Vec<(f64, f64)>)> {
        let phases = || (0..=BRANCH_POINTS).map(|i| PI * f64::from(i) / f64::from(BRANCH_POINTS));
        let names = self.chain.branches(0.0).into_iter().map(|(name, _)| name).enumerate();
        let points = |branch: usize| {
            let at = |phase| Some((phase, self.chain.branches(phase).get(branch)?.1));
            phases().filter_map(at).collect()
        };
        names.map(|(branch, name)| (name, points(branch))).collect()
    }

    /// Frequency of the nearer branch at a wave's phase (Hz).
    pub fn theory(&self, line: &SpectralLine) -> f64 {
        let branches = self.chain.branches(line.phase).into_iter().map(|(_, frequency)| frequency);
        let off = |f: &f64| (f - line.frequency).abs();
        branches.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or_default()
    }

    /// The branches with the waves found on them, the gap shaded and its edges named.
    pub fn plot(&self) -> Plot {
        let waves = |name: &str, onward: bool, colour| {
            let lines = self.found.lines.iter().filter(|line| line.onward == onward);
            let points = lines.map(|line| (line.phase, line.frequency)).collect();
            Series::new(name, points, colour, Stroke::Dots)
        };
        let across = |frequency: f64| [(0.0, frequency), (PI, frequency)];
        let mut lines = Vec::new();
        if self.chain.has_gap() {
            let [low, high] = [self.chain.gap_bottom(), self.chain.gap_top()].map(across);
            lines.push(Series::area("gap", &low, &high));
        }
        let colours = [COLOURS[0], COLOURS[3]];
        lines.extend(self.branches().into_iter().zip(colours).map(|((name, points), colour)| {
            Series::new(format!("theory, {name}"), points, colour, Stroke::Solid)
        }));
        lines.push(waves("found, forward", true, COLOURS[1]));
        lines.push(waves("found, backward", false, COLOURS[2]));
        let y = ["frequency", "Hz"];
        let plot = Plot::fitted(["", ""], y, lines);
        let edge = |(name, frequency): (&str, f64)| {
            (frequency, format!("{name} {}", engineering(frequency, "Hz", 4)))
        };
        let beside = self.chain.edges().into_iter().map(edge).collect();
        Plot { x: self.phases(), beside, ..plot }
    }

    /// The abscissa, from 0 to pi.
    fn phases(&self) -> Axis {
        let cell = if self.chain.has_gap() { "cell" } else { "bead" };
        let ticks = ["0", "π/4", "π/2", "3π/4", "π"].into_iter().enumerate();
        let ticks = ticks.map(|(i, name)| (0.25 * PI * i as f64, name.to_owned())).collect();
        let label = format!("phase per {cell}, k a (rad)");
        Axis { label, from: 0.0, to: PI, logarithmic: false, ticks }
    }

    /// The picture.
    pub fn picture(&self) -> Sheet {
        Sheet::stack(self.title.as_str(), vec![self.plot()])
    }

    /// The page.
    pub fn text(&self) -> String {
        let hertz = |f: f64| engineering(f, "Hz", 4);
        let (chain, found) = (&self.chain, &self.found);
        let mut page = vec![
            self.title.clone(),
            format!(
                "  theory      Eq. (7) under {}: {}, nothing above f3 {}",
                engineering(self.preload, "N", 4),
                if chain.has_gap() {
                    let (f1, f2) = (hertz(chain.gap_bottom()), hertz(chain.gap_top()));
                    format!("gap from f1 {f1} to f2 {f2}")
                } else {
                    "equal particles, no gap".to_owned()
                },
                hertz(chain.cutoff())
            ),
            format!(
                "  found       over {} {}; resolution {} in frequency, {:.3} rad in k a",
                self.cells,
                if chain.has_gap() { "cells of two beads" } else { "beads" },
                hertz(found.frequency_resolution),
                found.phase_resolution
            ),
            String::new(),
        ];
        let heading = ["frequency", "k a", "amplitude", "theory at k a", "deviation", "direction"];
        let rows = table::titled(
            heading,
            found.lines.iter().map(|line| {
                let theory = self.theory(line);
                vec![
                    hertz(line.frequency),
                    format!("{:.3} rad", line.phase),
                    format!("{:.0} %", 100.0 * line.height),
                    hertz(theory),
                    format!("{:+.1} %", 100.0 * (line.frequency / theory - 1.0)),
                    if line.onward { "forward" } else { "backward" }.to_owned(),
                ]
            }),
        );
        page.extend(table::lines(&rows, &[5]));
        page.push(String::new());
        page.extend(terminal(&self.plot()));
        if chain.has_gap() {
            page.push(
            "  note        on the optical branch phase and energy travel in opposite directions"
                .to_owned(),
        );
        }
        page.push("  note        theory is that of small signals; a wave as strong as the preload stiffens the contacts and runs above it".to_owned());
        page.join("\n")
    }
}

/// The linear chain under one preload.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PressedChain {
    /// Preload (N).
    pub preload_n: f64,
    /// Speed of long waves (m/s).
    pub long_wave_speed_m_per_s: f64,
    /// The chain.
    #[serde(flatten, serialize_with = "band_edges")]
    chain: Option<DiatomicChain>,
}

impl PressedChain {
    /// `chain`, which is under `preload` (N).
    pub fn new(preload: f64, chain: DiatomicChain) -> Self {
        let speed = chain.sound_speed();
        Self { preload_n: preload, long_wave_speed_m_per_s: speed, chain: Some(chain) }
    }
}

/// Page of `bands`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BandsPage {
    /// Name of the scene.
    pub scene: String,
    /// Particle around which the chain is periodic.
    pub particle: usize,
    /// Preload of the scene, if there is one (N).
    #[serde(rename = "preload_n")]
    pub preload: Option<f64>,
    /// The chain under several preloads.
    pub bands: Vec<PressedChain>,
}

impl BandsPage {
    fn chains(&self) -> Vec<(f64, DiatomicChain)> {
        self.bands.iter().filter_map(|row| Some((row.preload_n, row.chain?))).collect()
    }

    /// Title of the page and the picture.
    pub fn title(&self) -> String {
        format!("{}, around particle {}", self.scene, self.particle)
    }

    /// The band edges over the preload, with the gap between them.
    pub fn plot(&self) -> Plot {
        let rows = self.chains();
        let points = |edge: fn(&DiatomicChain) -> f64| -> Vec<(f64, f64)> {
            rows.iter().map(|(force, chain)| (*force, edge(chain))).collect()
        };
        let cutoff = points(DiatomicChain::cutoff);
        let lines = if rows.iter().all(|(_, chain)| chain.has_gap()) {
            let [low, high] = [points(DiatomicChain::gap_bottom), points(DiatomicChain::gap_top)];
            vec![
                Series::area("gap", &low, &high),
                Series::new("f3", cutoff, COLOURS[2], Stroke::Solid),
                Series::new("f2", high, COLOURS[1], Stroke::Solid),
                Series { name: "f1".to_owned(), ..Series::main(low) },
            ]
        } else {
            vec![Series { name: "f3, no gap: equal particles".to_owned(), ..Series::main(cutoff) }]
        };
        let mark = |force| (force, format!("the scene's preload: {}", engineering(force, "N", 4)));
        let (from, to) = rows.first().zip(rows.last()).map_or((0.0, 1.0), |(a, b)| (a.0, b.0));
        let plot = Plot::fitted(["preload", "N"], ["frequency", "Hz"], lines);
        // Rows are at equal ratios.
        let x =
            if from > 0.0 { Axis::logarithmic("preload (N)", from, to) } else { plot.x.clone() };
        Plot { x, ..plot }.with_marks(self.preload.map(mark).into_iter().collect())
    }

    /// The picture.
    pub fn picture(&self) -> Sheet {
        Sheet::stack(self.title(), vec![self.plot()])
    }

    /// The page as text.
    pub fn text(&self) -> String {
        let hertz = |f: f64| engineering(f, "Hz", 4);
        let gap_edge = |chain: &DiatomicChain, edge| {
            if chain.has_gap() { hertz(edge) } else { "-".to_owned() }
        };
        let heading = ["preload", "f1, gap from", "f2, gap to", "f3, cutoff", "long waves", ""];
        let mut lines = vec![heading.map(str::to_owned).to_vec()];
        let now = self.preload;
        lines.extend(self.chains().iter().map(|(force, chain)| {
            let is_now = now.is_some_and(|now| (*force / now - 1.0).abs() < 1e-9);
            vec![
                engineering(*force, "N", 4),
                gap_edge(chain, chain.gap_bottom()),
                gap_edge(chain, chain.gap_top()),
                hertz(chain.cutoff()),
                engineering(chain.sound_speed(), "m/s", 4),
                if is_now { "the scene's preload" } else { "" }.to_owned(),
            ]
        }));
        let mut page = vec![self.title()];
        page.extend(table::lines(&lines, &[5]));
        page.push(String::new());
        page.extend(terminal(&self.plot()));
        page.join("\n")
    }
}
