//! Statistics over shots as a table of text, and as a table for other programs.

use super::table;
use crate::measurement::statistics::ShotStatistic;
use crate::quantity::engineering;
use crate::table::{Column, Table};

/// The table that `arrivals` ends with.
pub fn statistics(found: &[ShotStatistic]) -> String {
    let heading =
        ["", "estimator", "shots", "mean", "st. dev.", "", "repeatability", "trend per shot", ""];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for statistic in found {
        let shown = |value: f64| engineering(value, &statistic.unit, 3);
        let or_none = |value: Option<f64>| value.map_or("-".to_owned(), shown);
        // A time after the trigger has no natural zero.
        let relative = statistic.standard_deviation.filter(|_| statistic.unit != "s");
        let relative = relative.map(|s| 100.0 * s / statistic.mean.abs());
        let trend = statistic.trend.map_or("-".to_owned(), |trend| {
            table::with_expanded(trend.value, trend.expanded, &statistic.unit)
        });
        rows.push(vec![
            match &statistic.to {
                Some(to) => format!("speed {} -> {to}", statistic.channel),
                None => format!("{} {}", statistic.quantity, statistic.channel),
            },
            statistic.estimator.unwrap_or_default().replace('_', " "),
            statistic.shots.to_string(),
            engineering(statistic.mean, &statistic.unit, 5),
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

/// The same as a table for other programs, one row for each quantity.
pub fn statistics_table(found: &[ShotStatistic]) -> Table {
    let words = ["quantity", "channel", "to", "estimator", "unit"].map(Column::text);
    let numbers = ["mean", "standard_deviation", "mean_u", "repeatability"].map(Column::number);
    let trend = ["trend_per_shot", "trend_u", "trend_U95"].map(Column::number);
    let mut columns = words.to_vec();
    columns.push(Column::count("shots"));
    columns.extend(numbers.into_iter().chain(trend));
    let row = |statistic: &ShotStatistic| {
        vec![
            statistic.quantity.into(),
            statistic.channel.as_str().into(),
            statistic.to.as_deref().into(),
            statistic.estimator.into(),
            statistic.unit.as_str().into(),
            (statistic.shots as u64).into(),
            statistic.mean.into(),
            statistic.standard_deviation.into(),
            statistic.mean_u.into(),
            statistic.repeatability.into(),
            statistic.trend.map(|trend| trend.value).into(),
            statistic.trend.map(|trend| trend.u).into(),
            statistic.trend.map(|trend| trend.expanded).into(),
        ]
    };
    Table { columns, rows: found.iter().map(row).collect() }
}
