//! Maps of what a chain lets pass over one of a scene's numbers: shades and numbers for a terminal,
//! sheets for a picture.

use super::sheet::{Axis, COLOURS, Plot, Polyline, ShadedMap, Sheet, Stroke, sheet_svg};
use super::table;
use crate::analysis::dispersion::DiatomicChain;
use crate::quantity::engineering;
use crate::studies::tunability::{TunedPoint, Tuning};

/// Highest frequency that is shown (Hz).
const MAX_FREQUENCY: f64 = 20e3;
/// Range of the shades below the highest of each column (dB).
const DYNAMIC_RANGE: f64 = 60.0;
/// Rows of the map in a terminal and in a picture.
const MAP_ROWS: (usize, usize) = (16, 100);
/// Characters across the map in a terminal.
const MAP_COLUMNS: usize = 64;
/// Shades from nothing to the highest.
const SHADES: [char; 5] = [' ', '░', '▒', '▓', '█'];
/// Rows of numbers below a map.
const NUMBER_ROWS: usize = 7;

type Edge = (&'static str, fn(&DiatomicChain) -> f64);
const EDGES: [Edge; 3] = [
    ("f1", DiatomicChain::gap_bottom),
    ("f2", DiatomicChain::gap_top),
    ("f3", DiatomicChain::cutoff),
];

/// The spectrum in decibels below its highest line, the highest of each of `rows` bands of
/// frequency up to 20 kHz (dB).
pub fn transmitted(point: &TunedPoint, rows: usize) -> Vec<f64> {
    let mut highest = vec![0.0_f64; rows];
    for (bin, amplitude) in point.transmitted.amplitude.iter().enumerate() {
        let row = (point.transmitted.frequency(bin) / MAX_FREQUENCY * rows as f64) as usize;
        let Some(cell) = highest.get_mut(row) else { break };
        *cell = cell.max(*amplitude);
    }
    let top = highest.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    highest
        .into_iter()
        .map(|amplitude| (20.0 * (amplitude / top).log10()).max(-DYNAMIC_RANGE))
        .collect()
}

fn shares(point: &TunedPoint, rows: usize) -> Vec<f64> {
    transmitted(point, rows)
        .into_iter()
        .map(|db| (1.0 + db / DYNAMIC_RANGE).clamp(0.0, 1.0))
        .collect()
}

/// The page that `tunability` prints.
pub fn tunability(title: &str, tunings: &[Tuning]) -> String {
    let mut lines = vec![title.to_owned()];
    for tuning in tunings {
        lines.push(String::new());
        lines.push(heading(tuning));
        lines.extend(map(tuning));
        lines.extend(numbers(tuning));
    }
    lines.push(String::new());
    lines.push(format!(
        "shades: spectrum at the last sensor up to {:.0} kHz, each {:.0} dB, nothing is {DYNAMIC_RANGE:.0} dB below the highest line of its column; 1, 2, 3: band edges of the linear chain",
        1e-3 * MAX_FREQUENCY,
        DYNAMIC_RANGE / 5.0
    ));
    lines.join("\n")
}

fn heading(tuning: &Tuning) -> String {
    let number = &tuning.number;
    format!("{} (the scene has {})", number.path, value(tuning, number.now()))
}

/// A value of the number with its unit.
fn value(tuning: &Tuning, value: f64) -> String {
    engineering(value / tuning.number.scale, &tuning.number.unit, 3)
}

fn map(tuning: &Tuning) -> Vec<String> {
    let rows = MAP_ROWS.0;
    let columns: Vec<Vec<char>> = (0..MAP_COLUMNS)
        .filter_map(|column| tuning.points.get(column * tuning.points.len() / MAP_COLUMNS))
        .map(|point| {
            let shade =
                |share: f64| SHADES[((share * SHADES.len() as f64) as usize).min(SHADES.len() - 1)];
            let mut column: Vec<char> = shares(point, rows).into_iter().map(shade).collect();
            for ((_, edge), sign) in EDGES.iter().zip(['1', '2', '3']) {
                let row = point.chain.map(|chain| edge(&chain) / MAX_FREQUENCY * rows as f64);
                if let Some(cell) = row.and_then(|row| column.get_mut(row as usize)) {
                    *cell = sign;
                }
            }
            column
        })
        .collect();
    let mut lines = Vec::new();
    for row in (0..rows).rev() {
        let line: String = columns.iter().filter_map(|column| column.get(row)).collect();
        let label = match row {
            _ if row + 1 == rows => engineering(MAX_FREQUENCY, "Hz", 2),
            0 => "0".to_owned(),
            _ => String::new(),
        };
        lines.push(format!("  {label:>7} │{line}│"));
    }
    let ends = [tuning.points.first(), tuning.points.last()];
    let [from, to] = ends.map(|point| point.map_or_else(String::new, |p| value(tuning, p.value)));
    let gap = MAP_COLUMNS.saturating_sub(from.chars().count() + to.chars().count());
    lines.push(format!("  {:7} └{}┘", "", "─".repeat(MAP_COLUMNS)));
    lines.push(format!("  {:7}  {from}{}{to}", "", " ".repeat(gap)));
    lines
}

fn numbers(tuning: &Tuning) -> Vec<String> {
    let heading = ["", "f1", "f2", "f3", "long waves", "pulse", "first peak"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    let none = || "-".to_owned();
    let last = tuning.points.len().saturating_sub(1);
    let picked = (0..NUMBER_ROWS).map(|row| row * last / (NUMBER_ROWS - 1));
    for point in picked.filter_map(|index| tuning.points.get(index)) {
        let edge = |of: fn(&DiatomicChain) -> f64, unit: &str| {
            point.chain.map_or_else(none, |chain| engineering(of(&chain), unit, 4))
        };
        rows.push(vec![
            value(tuning, point.value),
            edge(DiatomicChain::gap_bottom, "Hz"),
            edge(DiatomicChain::gap_top, "Hz"),
            edge(DiatomicChain::cutoff, "Hz"),
            edge(DiatomicChain::sound_speed, "m/s"),
            point.pulse_speed.map_or_else(none, |speed| engineering(speed, "m/s", 4)),
            point.transmission.map_or_else(none, |share| format!("{:.1} %", 100.0 * share)),
        ]);
    }
    table::lines(&rows, &[])
}

/// The map as a picture: for each number what arrives with the band edges, and beside it the
/// speeds.
pub fn tunability_svg(title: &str, tunings: &[Tuning]) -> String {
    let panels = tunings.iter().flat_map(|tuning| [map_panel(tuning), speed_panel(tuning)]);
    sheet_svg(&Sheet {
        title: title.to_owned(),
        columns: 2,
        size: (430.0, 210.0),
        panels: panels.collect(),
        legend: Vec::new(),
        note: String::new(),
    })
}

/// The axis of a number, and the factor from SI units to its unit.
fn axis(tuning: &Tuning) -> (Axis, f64) {
    let (unit, factor) = match tuning.number.unit.as_str() {
        "Pa" => ("GPa", 1e-9),
        unit => (unit, 1.0 / tuning.number.scale),
    };
    let ends = [tuning.points.first(), tuning.points.last()];
    let [from, to] = ends.map(|point| point.map_or(1.0, |point| factor * point.value));
    let label = format!("{} ({unit})", tuning.number.path);
    (Axis::logarithmic(&label, from, to), factor)
}

fn curve(tuning: &Tuning, factor: f64, of: &dyn Fn(&TunedPoint) -> Option<f64>) -> Vec<(f64, f64)> {
    tuning.points.iter().filter_map(|point| Some((factor * point.value, of(point)?))).collect()
}

fn map_panel(tuning: &Tuning) -> Plot {
    let (x, factor) = axis(tuning);
    let mut panel = Plot::new(
        "spectrum at the last sensor",
        x,
        Axis::linear("frequency (kHz)", 0.0, 1e-3 * MAX_FREQUENCY),
    );
    panel.map = Some(ShadedMap {
        columns: tuning.points.iter().map(|point| shares(point, MAP_ROWS.1)).collect(),
        shades: [format!("-{DYNAMIC_RANGE:.0} dB"), "0 dB".to_owned()],
    });
    for ((name, edge), colour) in EDGES.into_iter().zip([1, 3, 4]) {
        let points = curve(tuning, factor, &|point| Some(1e-3 * edge(&point.chain?)));
        let name = name.to_owned();
        panel.lines.push(Polyline {
            name,
            points,
            colour: COLOURS[colour],
            stroke: Stroke::Dashed,
        });
    }
    panel
}

fn speed_panel(tuning: &Tuning) -> Plot {
    let (x, factor) = axis(tuning);
    let lines = [
        ("pulse, half-rise", curve(tuning, factor, &|point| point.pulse_speed), 0, Stroke::Solid),
        (
            "long waves, linear",
            curve(tuning, factor, &|point| Some(point.chain?.sound_speed())),
            1,
            Stroke::Dashed,
        ),
    ];
    let speeds = lines.iter().flat_map(|(_, points, ..)| points.iter().map(|(_, speed)| *speed));
    let top = speeds.fold(1.0, f64::max);
    let mut panel = Plot::new(
        "speed between first and last sensor",
        x,
        Axis::linear("speed (m/s)", 0.0, 1.3 * top),
    );
    panel.lines = lines
        .into_iter()
        .map(|(name, points, colour, stroke)| Polyline {
            name: name.to_owned(),
            points,
            colour: COLOURS[colour],
            stroke,
        })
        .collect();
    panel
}
