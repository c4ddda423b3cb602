//! `hertzscope magnet`: how hard a magnet pulls the sphere, and where it pulls as hard as is
//! wanted.

use anyhow::bail;
use clap::Args;
use serde_json::{Value, json};

use super::picture::PlotArguments;
use crate::quantity::{Dimension, parse};
use crate::report;
use crate::report::magnet::{MagnetPage, MagnetPoint};
use crate::scene::magnets;

/// The paper's preload (N).
const PAPER_PRELOAD: f64 = 2.38;

/// Show a magnet's force over distance, and the distance for a force
#[derive(Debug, Args)]
pub struct Arguments {
    /// An included magnet, or the path of a magnet's file
    #[arg(default_value = "ring-15-6-6")]
    name: String,
    /// Show the distances at which the magnet exerts this force, e.g. 2.38N
    /// [default: the paper's 2.38 N]
    #[arg(long, value_name = "F", value_parser = force)]
    preload: Option<f64>,
    /// Show the force at this distance of the sphere's centre from the magnet's face, e.g. 0.4mm
    #[arg(long, value_name = "D", value_parser = distance, conflicts_with = "preload", allow_hyphen_values = true)]
    distance: Option<f64>,
    /// Temperature of the magnet, e.g. 40°C [default: the one its remanence is stated at]
    #[arg(long, value_name = "T", value_parser = temperature)]
    temperature: Option<f64>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    plot: PlotArguments,
}

fn force(text: &str) -> Result<f64, String> {
    parse(text, Dimension::FORCE).map_err(|error| format!("{error}, expected a force, e.g. 2.38N"))
}

fn distance(text: &str) -> Result<f64, String> {
    parse(text, Dimension::LENGTH)
        .map_err(|error| format!("{error}, expected a length, e.g. 0.4mm"))
}

fn temperature(text: &str) -> Result<f64, String> {
    match parse(text, Dimension::TEMPERATURE) {
        Ok(kelvin) if kelvin > 0.0 => Ok(kelvin),
        Ok(_) => Err(format!("found {text}, expected a temperature above absolute zero")),
        Err(error) => Err(format!("{error}, expected a temperature, e.g. 40°C")),
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let magnet = magnets::load(&arguments.name)?;
    let temperature = arguments.temperature.unwrap_or(magnet.stated_temperature());
    let limit = magnet.temperature_limit();
    if temperature >= limit {
        let magnet = &magnet.name;
        bail!(
            "--temperature: found {temperature:.1} K, expected less than {limit:.1} K: there {magnet} is no magnet any more"
        );
    }
    let (wanted, distances) = if let Some(distance) = arguments.distance {
        (None, vec![distance])
    } else {
        let wanted = arguments.preload.unwrap_or(PAPER_PRELOAD);
        (Some(wanted), magnet.distances(wanted, temperature))
    };
    let place = |distance: &f64| MagnetPoint::of(&magnet, *distance, temperature);
    let places: Vec<MagnetPoint> = distances.iter().filter_map(place).collect();
    if let (Some(distance), true) = (arguments.distance, places.is_empty()) {
        let [near, far] = magnet.span();
        bail!("found a distance of {distance} m, expected one within the table, {near} to {far} m");
    }
    let page = MagnetPage { magnet, temperature, wanted, places };
    arguments.plot.save(|| report::chart(&page.curve(), &page.magnet.name))?;
    if arguments.json {
        super::print(&serde_json::to_string_pretty(&as_json(&page))?)
    } else {
        super::print(&page.text())
    }
}

fn as_json(page: &MagnetPage) -> Value {
    let places = page.places.iter().map(|place| {
        json!({
            "distance_m": place.distance,
            "force_n": place.force,
            "slope_n_per_m": place.slope,
            "field_t": place.field,
            "gradient_t_per_m": place.gradient,
            "saturation": place.saturation,
        })
    });
    let curve = page.curve();
    let of = |f: fn(&(f64, f64)) -> f64| curve.points.iter().map(f).collect::<Vec<_>>();
    json!({
        "magnet": page.magnet.name,
        "source": page.magnet.source,
        "temperature_k": page.temperature,
        "wanted_n": page.wanted,
        "places": places.collect::<Vec<_>>(),
        "curve": { "distance_m": of(|p| p.0), "force_n": of(|p| p.1) },
    })
}
