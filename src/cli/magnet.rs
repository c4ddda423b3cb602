//! `hertzscope magnet`: how hard a magnet pulls the sphere, and where it pulls as hard as is
//! wanted.

use anyhow::bail;
use clap::Args;

use super::picture::PlotArguments;
use super::value::{ABOVE_ZERO, quantity};
use crate::quantity::Dimension;
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
    #[arg(long, value_name = "F", value_parser = quantity(Dimension::FORCE, .., "2.38N"))]
    preload: Option<f64>,
    /// Show the force at this distance of the sphere's centre from the magnet's face, e.g. 0.4mm
    #[arg(long, value_name = "D", value_parser = quantity(Dimension::LENGTH, .., "0.4mm"), conflicts_with = "preload", allow_hyphen_values = true)]
    distance: Option<f64>,
    /// Temperature of the magnet, e.g. 40°C [default: the one its remanence is stated at]
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TEMPERATURE, ABOVE_ZERO, "40°C"))]
    temperature: Option<f64>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    plot: PlotArguments,
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
    arguments.plot.save(&page, || page.picture())?;
    super::show(&page, arguments.json, MagnetPage::text)
}
