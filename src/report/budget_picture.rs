//! The budget of an uncertain scene as an SVG picture: a bar for each output, divided among the
//! inputs that carry its variance.

use std::fmt::Write as _;

use super::escape;
use super::sheet::COLOURS;
use super::uncertainty::interval;
use crate::predict::{OutputInterval, UncertainPrediction};

/// Width of a whole bar, and of the words behind it (pixels).
const WIDTHS: (f64, f64) = (420.0, 150.0);
/// Width of the outputs' names (pixels).
const LEFT: f64 = 190.0;
/// Height of a row, and of a bar (pixels).
const HEIGHTS: (f64, f64) = (20.0, 13.0);
/// Colour of the other inputs, and of what is not linear.
const REST: [(&str, &str); 2] = [("other inputs", "#b0b0b0"), ("not linear", "#e4e4e4")];

/// The inputs that carry most of all outputs' variances, as many as there are colours, the largest
/// first.
fn largest(found: &UncertainPrediction) -> Vec<&str> {
    let share = |name: &str| -> f64 { found.outputs.iter().map(|output| of(output, name)).sum() };
    let mut all: Vec<(&str, f64)> =
        found.inputs.iter().map(|input| (input.name.as_str(), share(&input.name))).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.truncate(COLOURS.len());
    all.into_iter().map(|(name, _)| name).collect()
}

/// Share of the variance of `output` that the input `name` carries (1).
fn of(output: &OutputInterval, name: &str) -> f64 {
    output.inputs.iter().find(|input| input.input == name).map_or(0.0, |input| input.share)
}

/// The picture.
pub fn budget_picture(found: &UncertainPrediction) -> String {
    let inputs = largest(found);
    let legend: Vec<(&str, &str)> = inputs.iter().copied().zip(COLOURS).chain(REST).collect();
    let (row, bar) = HEIGHTS;
    let above = 44.0 + row * legend.len() as f64;
    let (width, height) =
        (LEFT + WIDTHS.0 + WIDTHS.1, above + row * found.outputs.len() as f64 + 20.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n<text x=\"14\" y=\"24\" font-size=\"15\">{}: shares of the variance</text>\n",
        escape(&found.scene)
    );
    for (index, (name, colour)) in legend.iter().enumerate() {
        let y = 36.0 + row * index as f64;
        let _ = writeln!(
            svg,
            "<rect x=\"{LEFT}\" y=\"{y}\" width=\"{bar}\" height=\"{bar}\" fill=\"{colour}\"/>\n<text x=\"{}\" y=\"{}\">{}</text>",
            LEFT + bar + 7.0,
            y + bar - 2.0,
            escape(name)
        );
    }
    for (index, output) in found.outputs.iter().enumerate() {
        let y = above + row * index as f64;
        let known: Vec<f64> = inputs.iter().map(|name| of(output, name)).collect();
        let named: f64 = known.iter().sum();
        let rest = [(output.explained - named).max(0.0), 1.0 - output.explained];
        let mut x = LEFT;
        for (share, (_, colour)) in known.into_iter().chain(rest).zip(&legend) {
            let long = (WIDTHS.0 * share).min(LEFT + WIDTHS.0 - x).max(0.0);
            let _ = writeln!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{y}\" width=\"{long:.1}\" height=\"{bar}\" fill=\"{colour}\"/>"
            );
            x += long;
        }
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n<text x=\"{}\" y=\"{}\">{}</text>",
            LEFT - 10.0,
            y + bar - 2.0,
            escape(&output.name),
            LEFT + WIDTHS.0 + 10.0,
            y + bar - 2.0,
            escape(&interval(output))
        );
    }
    svg.push_str("</svg>\n");
    svg
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predict::InputShare;
    use crate::scene::random_inputs::RandomInput;

    /// Half, a quarter, and a quarter that is not linear: a whole bar.
    #[test]
    fn a_bar_is_divided_by_shares() {
        let input = |name: &str| RandomInput {
            name: name.to_owned(),
            value: 1.0,
            unit: String::new(),
            u: 0.1,
            source: None,
        };
        let share = |name: &str, share| InputShare { input: name.to_owned(), change: 1.0, share };
        let output = OutputInterval {
            name: "a peak".to_owned(),
            unit: "N",
            value: 3.0,
            as_run: 3.0,
            u: 0.05,
            expanded: 0.1,
            interval_95: [2.9, 3.1],
            explained: 0.75,
            inputs: vec![share("speed", 0.5), share("mass", 0.25)],
        };
        let found = UncertainPrediction {
            scene: "bench".to_owned(),
            samples: 20,
            seed: 1,
            failed: 0,
            wall_s: 0.1,
            inputs: vec![input("mass"), input("speed")],
            outputs: vec![output],
            bands: Vec::new(),
        };
        let svg = budget_picture(&found);
        for width in [
            "width=\"210.0\" height=\"13\" fill=\"#0072b2\"",
            "width=\"105.0\" height=\"13\" fill=\"#d55e00\"",
            "width=\"105.0\" height=\"13\" fill=\"#e4e4e4\"",
        ] {
            assert!(svg.contains(width), "{width}: {svg}");
        }
        assert!(svg.contains("3.00 ± 0.10 N"), "{svg}");
    }
}
