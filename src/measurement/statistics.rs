//! Statistics of arrivals over the shots of a recording: how far heights, times and speeds repeat,
//! and whether they drift.
//!
//! Of `n` values `x_i`: mean, standard deviation `s = sqrt(sum (x_i - mean)^2/(n - 1))`, standard
//! uncertainty of the mean `s/sqrt(n)` (JCGM 100:2008, 4.2), repeatability limit `2.8 s`, which two
//! shots under the same conditions exceed in 5 % of all pairs (ISO 5725-6:1994, 4.1), and trend:
//! the slope of the straight line through `x_i` over the shot's number, with its standard
//! uncertainty from the scatter about the line (JCGM 100:2008, H.3). Valid for shots of one kind;
//! clipped peaks are left out.

use serde::Serialize;

use super::arrivals::{ChannelArrivals, Survey};
use crate::numeric::intervals::student_95;
use crate::numeric::statistics::{Moments, StraightLine};

/// Repeatability limit over standard deviation: 1.96 times the square root of two (1).
const REPEATABILITY_FACTOR: f64 = 2.8;

/// A trend of this many expanded uncertainties is called a drift, three standard ones of many
/// shots: of dozens of quantities, a single one would call some by chance (1).
const DRIFT_FACTOR: f64 = 1.5;

/// One quantity over all shots that tell it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShotStatistic {
    /// `height`, `arrival` or `speed`.
    pub quantity: &'static str,
    /// The channel, for a speed that from which.
    pub channel: String,
    /// For a speed, the channel to which.
    pub to: Option<String>,
    /// Estimator of an arrival or a speed.
    pub estimator: Option<&'static str>,
    /// Unit of all numbers: `N` or the channel's own, `s` or `m/s`.
    pub unit: String,
    /// How many shots tell it.
    pub shots: usize,
    /// Mean (unit).
    pub mean: f64,
    /// Standard deviation of a single shot; none for a single one (unit).
    pub standard_deviation: Option<f64>,
    /// Standard uncertainty of the mean by the scatter; none for a single shot (unit).
    pub mean_u: Option<f64>,
    /// Repeatability limit (unit).
    pub repeatability: Option<f64>,
    /// Change from one shot to the next; none for fewer than three shots.
    pub trend: Option<ShotTrend>,
}

/// The slope of a straight line through values over the shot's number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShotTrend {
    /// Change from one shot to the next (unit).
    pub value: f64,
    /// Its standard uncertainty, from the scatter about the line (unit).
    pub u: f64,
    /// Its expanded uncertainty for 95 %, by Student's t of the shots less two (unit).
    #[serde(rename = "U95")]
    pub expanded: f64,
}

impl ShotStatistic {
    /// Whether the trend is beyond one and a half times its expanded uncertainty.
    pub fn drifts(&self) -> bool {
        self.trend.is_some_and(|trend| trend.value.abs() > DRIFT_FACTOR * trend.expanded)
    }
}

/// A quantity's name, of what it is, and its value by the shot's number.
type Series = (ShotStatistic, Vec<(f64, f64)>);

/// Statistics over `surveys`, one a shot: heights, arrivals, then speeds, in the order of their
/// first appearance.
pub fn statistics(surveys: &[Survey]) -> Vec<ShotStatistic> {
    let mut all: Vec<Series> = Vec::new();
    for survey in surveys {
        let shot = f64::from(survey.shot);
        for channel in &survey.channels {
            add_channel(&mut all, shot, channel);
        }
    }
    for survey in surveys {
        for speed in &survey.speeds {
            let of = ("speed", speed.from.as_str(), Some(speed.to.as_str()), Some(speed.estimator));
            add(&mut all, of, "m/s", (f64::from(survey.shot), speed.m_per_s.value));
        }
    }
    let rank = |statistic: &ShotStatistic| {
        ["height", "arrival", "speed"].iter().position(|name| *name == statistic.quantity)
    };
    all.sort_by_key(|(statistic, _)| rank(statistic));
    all.into_iter().map(|(statistic, values)| completed(statistic, &values)).collect()
}

fn add_channel(all: &mut Vec<Series>, shot: f64, channel: &ChannelArrivals) {
    let name = channel.channel.as_str();
    let in_newtons = channel.height_n.map(|force| ("N", force));
    let height = in_newtons.or(channel.height.map(|height| (channel.unit.as_str(), height)));
    if let Some((unit, height)) = height.filter(|_| channel.clipped == 0) {
        add(all, ("height", name, None, None), unit, (shot, height.value));
    }
    for arrival in &channel.arrivals {
        let Some(time) = arrival.time_s else { continue };
        add(all, ("arrival", name, None, Some(arrival.estimator)), "s", (shot, time.value));
    }
}

fn add(
    all: &mut Vec<Series>,
    (quantity, channel, to, estimator): (&'static str, &str, Option<&str>, Option<&'static str>),
    unit: &str,
    value: (f64, f64),
) {
    let is_same = |known: &ShotStatistic| {
        (known.quantity, known.channel.as_str(), known.to.as_deref(), known.estimator)
            == (quantity, channel, to, estimator)
            && known.unit == unit
    };
    if let Some((_, values)) = all.iter_mut().find(|(known, _)| is_same(known)) {
        values.push(value);
        return;
    }
    let statistic = ShotStatistic {
        quantity,
        channel: channel.to_owned(),
        to: to.map(str::to_owned),
        estimator,
        unit: unit.to_owned(),
        shots: 0,
        mean: 0.0,
        standard_deviation: None,
        mean_u: None,
        repeatability: None,
        trend: None,
    };
    all.push((statistic, vec![value]));
}

fn completed(statistic: ShotStatistic, values: &[(f64, f64)]) -> ShotStatistic {
    let numbers: Vec<f64> = values.iter().map(|(_, x)| *x).collect();
    let weighted: Vec<(f64, f64, f64)> = values.iter().map(|(i, x)| (*i, *x, 1.0)).collect();
    let moments = Moments::of(&numbers);
    let repeated = (values.len() > 1).then_some(moments);
    let line = StraightLine::through(&weighted).filter(|_| values.len() > 2);
    let trend = line.map(|line| {
        let u = line.slope_u(values.len());
        ShotTrend { value: line.slope, u, expanded: student_95(values.len() as f64 - 2.0) * u }
    });
    ShotStatistic {
        shots: values.len(),
        mean: moments.mean,
        standard_deviation: repeated.map(|moments| moments.deviation),
        mean_u: repeated.map(|moments| moments.mean_u()),
        repeatability: repeated.map(|moments| REPEATABILITY_FACTOR * moments.deviation),
        trend,
        ..statistic
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 2, 4, 6, 5 over 1, 2, 3, 4 have mean 4.25, s = sqrt(8.75/3), slope 1.1 and scatter
    /// sqrt(2.7/2/5).
    #[test]
    fn four_values_by_hand() {
        let mut all = Vec::new();
        for (shot, value) in [(1.0, 2.0), (2.0, 4.0), (3.0, 6.0), (4.0, 5.0)] {
            add(&mut all, ("height", "CH1", None, None), "V", (shot, value));
        }
        let (statistic, values) = all.remove(0);
        let found = completed(statistic, &values);
        let s = (8.75f64 / 3.0).sqrt();
        assert_eq!((found.shots, found.mean), (4, 4.25));
        assert!((found.standard_deviation.unwrap() - s).abs() < 1e-12);
        assert!((found.mean_u.unwrap() - s / 2.0).abs() < 1e-12);
        assert!((found.repeatability.unwrap() - 2.8 * s).abs() < 1e-12);
        let trend = found.trend.unwrap();
        assert!(
            (trend.value - 1.1).abs() < 1e-12 && (trend.u - 0.27f64.sqrt()).abs() < 1e-12,
            "{trend:?}"
        );
        // Student's t of two degrees of freedom, JCGM 100:2008, table G.2.
        assert!((trend.expanded / trend.u - 4.30).abs() < 0.005);
        // 1.1 is 2.1 times its uncertainty.
        assert!(!found.drifts());
        let sharper = |u| {
            let trend = Some(ShotTrend { value: 1.1, u, expanded: student_95(2.0) * u });
            ShotStatistic { trend, ..found.clone() }
        };
        assert!(!sharper(0.18).drifts() && sharper(0.16).drifts());
    }
}
