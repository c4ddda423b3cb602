//! A magnet's force over distance as a page of text and as a curve.

use serde::{Serialize, Serializer};

use super::plot::{Plot, Series, Sheet, terminal};
use super::table;
use crate::magnet::{ForceLaw, Magnet};
use crate::quantity::engineering;

/// Points of the curve.
const CURVE_POINTS: u32 = 600;
/// Zero degrees Celsius (K).
const ZERO_CELSIUS: f64 = 273.15;

/// Force and field of the magnet at one distance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MagnetPoint {
    /// From the face to the sphere's centre (m).
    #[serde(rename = "distance_m")]
    pub distance: f64,
    /// Attraction (N).
    #[serde(rename = "force_n")]
    pub force: f64,
    /// Its change with distance (N/m).
    #[serde(rename = "slope_n_per_m")]
    pub slope: f64,
    /// Flux density on the axis, of a ring (T).
    #[serde(rename = "field_t")]
    pub field: Option<f64>,
    /// Its change along the axis, of a ring (T/m).
    #[serde(rename = "gradient_t_per_m")]
    pub gradient: Option<f64>,
    /// How far the sphere is magnetised, of a ring; 1 is saturated (1).
    pub saturation: Option<f64>,
}

/// A magnet at a temperature, with the places that were asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct MagnetPage {
    /// The magnet.
    pub magnet: Magnet,
    /// Temperature (K).
    pub temperature: f64,
    /// The force that was asked for (N).
    pub wanted: Option<f64>,
    /// The places found, the one nearest to the face first.
    pub places: Vec<MagnetPoint>,
}

impl MagnetPoint {
    /// Force and field of `magnet` at `distance` (m); none beyond a table.
    pub fn of(magnet: &Magnet, distance: f64, temperature: f64) -> Option<Self> {
        let ring = match &magnet.law {
            ForceLaw::Ring(ring, sphere) => {
                Some((ring.at(temperature), 0.5 * ring.length + distance, sphere))
            }
            _ => None,
        };
        Some(Self {
            distance,
            force: magnet.force(distance, temperature)?,
            slope: magnet.slope(distance, temperature)?,
            field: ring.map(|(field, z, _)| field.field(z)),
            gradient: ring.map(|(field, z, _)| field.gradient(z)),
            saturation: ring.map(|(field, z, sphere)| field.saturation(z, sphere)),
        })
    }
}

impl Serialize for MagnetPage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Points {
            distance_m: Vec<f64>,
            force_n: Vec<f64>,
        }
        #[derive(Serialize)]
        struct Fields<'a> {
            magnet: &'a str,
            source: &'a str,
            temperature_k: f64,
            wanted_n: Option<f64>,
            places: &'a [MagnetPoint],
            curve: Points,
        }
        let (distance_m, force_n) = self.points().into_iter().unzip();
        Fields {
            magnet: &self.magnet.name,
            source: &self.magnet.source,
            temperature_k: self.temperature,
            wanted_n: self.wanted,
            places: &self.places,
            curve: Points { distance_m, force_n },
        }
        .serialize(serializer)
    }
}

impl MagnetPage {
    fn points(&self) -> Vec<(f64, f64)> {
        let [near, far] = self.magnet.span();
        let place = |i: u32| near + (far - near) * f64::from(i) / f64::from(CURVE_POINTS);
        let point =
            |distance: f64| Some((distance, self.magnet.force(distance, self.temperature)?));
        (0..=CURVE_POINTS).map(place).filter_map(point).collect()
    }

    /// Force over distance, with the places marked.
    pub fn plot(&self) -> Plot {
        let mark = |place: &MagnetPoint| {
            let [force, distance] = [(place.force, "N"), (place.distance, "m")]
                .map(|(value, unit)| engineering(value, unit, 4));
            (place.distance, format!("{force} at {distance}"))
        };
        let x = ["from the face to the sphere's centre", "m"];
        Plot::fitted(x, ["attraction", "N"], vec![Series::main(self.points())])
            .with_marks(self.places.iter().map(mark).collect())
    }

    /// The picture.
    pub fn picture(&self) -> Sheet {
        Sheet::stack(self.magnet.name.as_str(), vec![self.plot()])
    }

    /// The page that `magnet` prints.
    pub fn text(&self) -> String {
        let mut lines = vec![format!("{}: {}", self.magnet.name, self.describe())];
        if !self.magnet.source.is_empty() {
            lines.push(format!("  source      {}", self.magnet.source));
        }
        lines.push(String::new());
        if let (Some(wanted), true) = (self.wanted, self.places.is_empty()) {
            let [near, far] = self.magnet.span().map(|d| engineering(d, "m", 3));
            let wanted = engineering(wanted, "N", 4);
            lines.push(format!("  {wanted} is not reached between {near} and {far}"));
        } else {
            lines.extend(self.place_lines());
        }
        lines.push(String::new());
        lines.extend(terminal(&self.plot()));
        lines.join("\n")
    }

    fn describe(&self) -> String {
        match &self.magnet.law {
            ForceLaw::Constant(force) => {
                format!("a constant {} whatever the distance", engineering(*force, "N", 4))
            }
            ForceLaw::Ring(ring, sphere) => {
                let millimetres = |metres: f64| engineering(metres, "m", 3);
                format!(
                    "ring of outer diameter {}, bore {}, length {}, Br {} at {:.0} °C, on a sphere of {}",
                    millimetres(2.0 * ring.outer_radius),
                    millimetres(2.0 * ring.inner_radius),
                    millimetres(ring.length),
                    engineering(ring.at(self.temperature).remanence, "T", 4),
                    self.temperature - ZERO_CELSIUS,
                    millimetres(2.0 * sphere.radius)
                )
            }
            ForceLaw::Measured(_) => "measured forces".to_owned(),
        }
    }

    fn place_lines(&self) -> Vec<String> {
        let heading = ["distance", "attraction", "slope", "B (axial)", "dB/dx", "saturation"];
        let mut rows = vec![heading.map(str::to_owned).to_vec()];
        let or_none = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
        rows.extend(self.places.iter().map(|place| {
            vec![
                engineering(place.distance, "m", 4),
                engineering(place.force, "N", 4),
                format!("{:.3} N/mm", place.slope * 1e-3),
                or_none(place.field.map(|b| engineering(b, "T", 4))),
                or_none(place.gradient.map(|b| engineering(b, "T/m", 4))),
                or_none(place.saturation.map(|share| format!("{:.0} %", 100.0 * share))),
            ]
        }));
        table::lines(&rows, &[])
    }
}
