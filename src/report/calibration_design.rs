//! The design of a momentum test as a page of text.

use super::table;
use crate::calibrate::blind::CalibrationCoverage;
use crate::calibrate::design::TestDesign;
use crate::numeric::statistics::expected_coverage;
use crate::quantity::{Uncertain, engineering};
use crate::scene::plan::lab::{Laboratory, SpeedReading};

/// Candidates shown.
const SHOWN_DESIGNS: usize = 12;

/// The page that `calibrate --simulate` prints.
pub fn design_page(
    sensor: &str,
    lab: &Laboratory,
    candidates: &[TestDesign],
    checked: Option<&CalibrationCoverage>,
) -> String {
    let gain = lab.gain.map_or("sensor and scope as one chain".to_owned(), |gain| {
        format!("scope gain {:.1} %", 100.0 * gain.u)
    });
    let mass_u = lab.strikers.iter().map(|striker| striker.mass.u).fold(0.0, f64::max);
    let speed = |how: SpeedReading| match how {
        SpeedReading::Speed(u) => format!("{:.1} %", 100.0 * u),
        SpeedReading::Height(u) => format!("height {}", engineering(u, "m", 2)),
        SpeedReading::FlightTime(u) => format!("time of flight {}", engineering(u, "s", 2)),
    };
    let mut lines = vec![
        format!("momentum tests of {sensor}, the best first: six impacts each, calibrated blind"),
        format!(
            "  standard uncertainties of the inputs: mass {}, fall {}, rebound {}; {gain}",
            engineering(mass_u * 1e3, "g", 2),
            speed(lab.incoming),
            speed(lab.rebound)
        ),
    ];
    let heading = ["striker", "mass", "heights", "V/div", "s/div", "peak force", "contact", "U95"];
    let rows = table::titled(
        heading,
        candidates.iter().take(SHOWN_DESIGNS).map(|candidate| {
            let height = |share: f64| {
                engineering(share * candidate.height_m, "m", 3).trim_end_matches(" mm").to_owned()
            };
            vec![
                candidate.striker.clone(),
                engineering(candidate.mass_kg * 1e3, "g", 4),
                format!("{}, {}, {} mm", height(1.0), height(0.5), height(0.25)),
                engineering(candidate.volts_per_div, "V", 3),
                engineering(candidate.seconds_per_div, "s", 3),
                engineering(candidate.peak_force_n, "N", 3),
                engineering(candidate.contact_s, "s", 3),
                candidate.expanded.map_or("-".to_owned(), |u| format!("{:.2} %", 100.0 * u)),
            ]
        }),
    );
    lines.extend(table::lines(&rows, &[0]));
    if candidates.len() > SHOWN_DESIGNS {
        lines.push(format!("  ... and {} more, in --json", candidates.len() - SHOWN_DESIGNS));
    }
    if let Some(checked) = checked {
        lines.push(String::new());
        lines.extend(coverage_lines(checked));
    }
    lines.join("\n")
}

fn coverage_lines(checked: &CalibrationCoverage) -> [String; 5] {
    let percent = |share: f64| format!("{:+.3} %", 100.0 * share);
    let [low, high] = expected_coverage(checked.repeats);
    [
        format!(
            "the best, {} times blind: other sensor, readings and noise each time",
            checked.repeats
        ),
        format!(
            "  bias        {}",
            table::signed_percent(Uncertain::normal(checked.bias, checked.bias_u))
        ),
        format!(
            "  coverage    {:.1} % of the 95 % intervals hold the truth; right ones: {:.1} to {:.1} %",
            100.0 * checked.coverage_95,
            100.0 * low,
            100.0 * high
        ),
        format!(
            "  U95         {:.2} % on average, {:.2} % at most; {} calibrations failed, {} impacts left out",
            100.0 * checked.mean_expanded,
            100.0 * checked.largest_expanded,
            checked.failed,
            checked.impacts_left_out
        ),
        format!(
            "  raw voltage its integral is off by {}, its intervals hold the truth in {:.1} %",
            percent(checked.naive_bias),
            100.0 * checked.naive_coverage_95
        ),
    ]
}
