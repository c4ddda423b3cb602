//! Maps of what a chain lets pass over one of a scene's numbers: shades and numbers for a terminal,
//! sheets for a picture.

use serde::{Serialize, Serializer};

use super::plot::{Axis, COLOURS, Plot, Series, ShadedMap, Sheet, Stroke, terminal};
use super::spectrum::band_edges;
use super::table;
use crate::analysis::dispersion::DiatomicChain;
use crate::quantity::engineering;
use crate::studies::tunability::{TunedPoint, Tuning};

/// Highest frequency that is shown (Hz).
const MAX_FREQUENCY: f64 = 20e3;
/// Range of the shades below the highest of each column (dB).
const DYNAMIC_RANGE: f64 = 60.0;
/// Rows of the map.
const MAP_ROWS: usize = 100;
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

/// Bands of frequency in JSON, each 500 Hz wide.
const BANDS: usize = 40;

/// Page of `tunability`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TunabilityPage {
    /// Name of the scene.
    pub scene: String,
    /// Title of the page.
    #[serde(skip)]
    pub title: String,
    /// Each number over its range.
    #[serde(rename = "numbers", serialize_with = "numbers_json")]
    pub tunings: Vec<Tuning>,
}

fn numbers_json<S: Serializer>(tunings: &[Tuning], serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Point {
        value: f64,
        #[serde(flatten, serialize_with = "band_edges")]
        chain: Option<DiatomicChain>,
        long_wave_speed_m_per_s: Option<f64>,
        pulse_speed_m_per_s: Option<f64>,
        first_peak_ratio: Option<f64>,
        transmitted_db_per_500_hz: Vec<f64>,
    }
    #[derive(Serialize)]
    struct Number<'a> {
        path: &'a str,
        unit: &'a str,
        now: f64,
        points: Vec<Point>,
    }
    let point = |point: &TunedPoint, scale: f64| Point {
        value: point.value / scale,
        chain: point.chain,
        long_wave_speed_m_per_s: point.chain.map(|chain| chain.sound_speed()),
        pulse_speed_m_per_s: point.pulse_speed,
        first_peak_ratio: point.transmission,
        transmitted_db_per_500_hz: transmitted(point, BANDS),
    };
    serializer.collect_seq(tunings.iter().map(|tuning| {
        let number = &tuning.number;
        Number {
            path: &number.path,
            unit: &number.unit,
            now: number.now() / number.scale,
            points: tuning.points.iter().map(|at| point(at, number.scale)).collect(),
        }
    }))
}

/// The page that `tunability` prints.
pub fn tunability(title: &str, tunings: &[Tuning]) -> String {
    let mut lines = vec![title.to_owned()];
    for tuning in tunings {
        lines.push(String::new());
        lines.push(heading(tuning));
        lines.extend(terminal(&map_panel(tuning)));
        lines.extend(numbers(tuning));
    }
    lines.push(String::new());
    lines.push(format!(
        "shades: spectrum at the last sensor up to {:.0} kHz, from dark to nothing {DYNAMIC_RANGE:.0} dB below the highest line of its column; 1, 2, 3: band edges of the linear chain",
        1e-3 * MAX_FREQUENCY
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

/// The maps as a picture: for each number the spectrum with the band edges, beside it the speeds.
pub fn tunability_picture(title: &str, tunings: &[Tuning]) -> Sheet {
    let panels = tunings.iter().flat_map(|tuning| [map_panel(tuning), speed_panel(tuning)]);
    Sheet { columns: 2, size: (430.0, 210.0), ..Sheet::stack(title, panels.collect()) }
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
    let columns: Vec<Vec<f64>> =
        tuning.points.iter().map(|point| transmitted(point, MAP_ROWS)).collect();
    panel.map = Some(ShadedMap::decibels(&columns, DYNAMIC_RANGE));
    for ((name, edge), colour) in EDGES.into_iter().zip([1, 3, 4]) {
        let points = curve(tuning, factor, &|point| Some(1e-3 * edge(&point.chain?)));
        panel.lines.push(Series::new(name, points, COLOURS[colour], Stroke::Dashed));
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
    let series = lines
        .into_iter()
        .map(|(name, points, colour, stroke)| Series::new(name, points, COLOURS[colour], stroke));
    panel.lines = series.collect();
    panel
}
