//! Statistics over shots as a table of text, and as a table for other programs.

use std::fmt::Write as _;

use super::table;
use crate::measurement::statistics::ShotStatistic;
use crate::quantity::engineering;

/// The table that `arrivals` ends with.
pub fn statistics(found: &[ShotStatistic]) -> String {
    let heading =
        ["", "estimator", "shots", "mean", "st. dev.", "", "repeatability", "trend per shot", ""];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for statistic in found {
        let shown = |value: f64| engineering(value, statistic.unit, 3);
        let or_none = |value: Option<f64>| value.map_or("-".to_owned(), shown);
        // A time after the trigger has no natural zero.
        let relative = statistic.standard_deviation.filter(|_| statistic.unit != "s");
        let relative = relative.map(|s| 100.0 * s / statistic.mean.abs());
        let trend = statistic.trend.map_or("-".to_owned(), |trend| {
            format!("{} ± {}", shown(trend.value), shown(trend.expanded))
        });
        rows.push(vec![
            match &statistic.to {
                Some(to) => format!("speed {} -> {to}", statistic.channel),
                None => format!("{} {}", statistic.quantity, statistic.channel),
            },
            statistic.estimator.unwrap_or_default().replace('_', " "),
            statistic.shots.to_string(),
            engineering(statistic.mean, statistic.unit, 5),
            or_none(statistic.standard_deviation),
            relative.filter(|r| r.is_finite()).map_or(String::new(), |r| format!("{r:.2} %")),
            or_none(statistic.repeatability),
            trend,
            if statistic.drifts() { "drifts".to_owned() } else { String::new() },
        ]);
    }
    let mut lines = vec![
        "over all shots: repeatability is 2.8 standard deviations: 95 % of pairs of shots differ by less".to_owned(),
    ];
    lines.extend(table::lines(&rows, &[0, 1, 8]));
    lines.join("\n")
}

/// The same as a CSV table, one row a quantity.
pub fn statistics_csv(found: &[ShotStatistic]) -> String {
    let mut text = "quantity,channel,to,estimator,unit,shots,mean,standard_deviation,mean_u,repeatability,trend_per_shot,trend_u,trend_U95\n".to_owned();
    for statistic in found {
        let or_empty =
            |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{:e},{},{},{},{},{},{}",
            statistic.quantity,
            statistic.channel,
            statistic.to.as_deref().unwrap_or_default(),
            statistic.estimator.unwrap_or_default(),
            statistic.unit,
            statistic.shots,
            statistic.mean,
            or_empty(statistic.standard_deviation),
            or_empty(statistic.mean_u),
            or_empty(statistic.repeatability),
            or_empty(statistic.trend.map(|trend| trend.value)),
            or_empty(statistic.trend.map(|trend| trend.u)),
            or_empty(statistic.trend.map(|trend| trend.expanded)),
        );
    }
    text
}
