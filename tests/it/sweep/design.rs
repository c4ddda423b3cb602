//! Designs: every combination once, every stratum once, and random numbers that are what they are
//! said to be.

use hertzscope::scene::grid::{Design, number, typed};

use super::folder;

fn design(text: &str) -> Design {
    let folder = folder(text);
    Design::load(&folder.path().join("grid.toml")).expect("a sweep")
}

/// Numbers at path `place` of all runs, in SI units.
fn values(design: &Design, place: usize) -> Vec<f64> {
    let value =
        |run: u64| number("striker.speed", &design.run(run).values[place]).expect("a number").0;
    (0..design.count()).map(value).collect()
}

fn sampled(kind: &str, count: usize, over: &str) -> Design {
    design(&format!(
        "scene = \"magnet-0.61g\"\nseed = 5\n[{kind}]\ncount = {count}\n[{kind}.over]\nstriker.speed = {over}\nstriker.mass = {{ from = \"1 g\", to = \"2 g\" }}\n"
    ))
}

#[test]
fn a_grid_has_every_combination_once() {
    let design = design(
        r#"
        scene = "magnet-0.61g"
        [grid]
        "chain.segments.2.repeat" = { from = 2, to = 4, count = 3 }
        effects.gravity.acceleration = { from = "1 m/s^2", to = "100 m/s^2", count = 3, spacing = "logarithmic" }
        striker.material = ["alumina", "ptfe"]
        "#,
    );
    let run = |index| design.run(index).values.iter().map(typed).collect::<Vec<_>>().join(" ");
    let all: Vec<String> = (0..design.count()).map(run).collect();
    assert_eq!(all.len(), 18);
    assert_eq!(all[..3], ["2 1e0 m/s^2 alumina", "2 1e0 m/s^2 ptfe", "2 1e1 m/s^2 alumina"]);
    assert_eq!(all[17], "4 1e2 m/s^2 ptfe");
    let mut distinct = all.clone();
    distinct.sort();
    distinct.dedup();
    assert_eq!(distinct.len(), 18);
}

#[test]
fn a_latin_hypercube_has_every_stratum_once() {
    let design = sampled("latin_hypercube", 500, "{ from = \"1 m/s\", to = \"3 m/s\" }");
    for (place, low, width) in [(0, 1e-3, 1e-3), (1, 1.0, 2.0)] {
        let stratum = |value: f64| (500.0 * (value - low) / width).floor() as usize;
        let mut strata: Vec<usize> = values(&design, place).into_iter().map(stratum).collect();
        let drawn = strata.clone();
        strata.sort_unstable();
        assert_eq!(strata, (0..500).collect::<Vec<_>>());
        assert_ne!(drawn, strata, "in an order that is drawn");
    }
    // Orders of their own: the rank correlation of 500 pairs is below 0.15 but once in a thousand
    // times.
    let [a, b] = [0, 1].map(|place| values(&design, place));
    let mean = |v: &[f64]| v.iter().sum::<f64>() / 500.0;
    let centred = |v: &[f64]| v.iter().map(|x| x - mean(v)).collect::<Vec<_>>();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (a, b) = (centred(&a), centred(&b));
    assert!((dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt()).abs() < 0.15);
}

/// Means and variances of 4000 draws lie within four standard errors of what the laws say.
#[test]
fn random_numbers_follow_their_laws() {
    let moments = |over: &str, of: fn(f64) -> f64| {
        let values = values(&sampled("random", 4000, over), 1);
        let values: Vec<f64> = values.into_iter().map(of).collect();
        let mean = values.iter().sum::<f64>() / 4000.0;
        (mean, values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 4000.0)
    };
    let near = |found: (f64, f64), mean: f64, variance: f64, kurtosis: f64| {
        let error = 4.0 / 4000_f64.sqrt();
        assert!((found.0 - mean).abs() < error * variance.sqrt(), "{found:?}");
        assert!((found.1 / variance - 1.0).abs() < error * (kurtosis - 1.0).sqrt(), "{found:?}");
    };
    let even = |width: f64| width * width / 12.0;
    near(moments("{ from = \"1 m/s\", to = \"3 m/s\" }", |v| v), 2.0, even(2.0), 1.8);
    let logarithmic = "{ from = \"1 m/s\", to = \"100 m/s\", spacing = \"logarithmic\" }";
    near(moments(logarithmic, f64::ln), 10_f64.ln(), even(100_f64.ln()), 1.8);
    near(moments("{ mean = \"2 m/s\", deviation = \"5 %\" }", |v| v), 2.0, 0.01, 3.0);
    near(moments("{ mean = \"2 m/s\", deviation = \"10 cm/s\" }", |v| v), 2.0, 0.01, 3.0);
    // Whole numbers from 1 to 6: a die.
    near(moments("{ from = 1, to = 6 }", |v| v), 3.5, 35.0 / 12.0, 1.731);
}

/// A run's values and its seed follow from its number, and its seed from its values alone.
#[test]
fn more_points_leave_the_first_alone() {
    let over = "{ from = \"1 m/s\", to = \"3 m/s\" }";
    let (few, many) = (sampled("random", 10, over), sampled("random", 1000, over));
    let shown = |design: &Design, run: u64| {
        let run = design.run(run);
        (run.values.iter().map(typed).collect::<Vec<_>>(), run.seed)
    };
    assert!((0..10).all(|run| shown(&few, run) == shown(&many, run)));
    let grid = |speeds: &str| {
        design(&format!("scene = \"magnet-0.61g\"\n[grid]\nstriker.speed = {speeds}\n"))
    };
    let (one, three) = (grid("[\"2 m/s\"]"), grid("[\"1 m/s\", \"2 m/s\", \"3 m/s\"]"));
    assert_eq!(shown(&one, 0), shown(&three, 1));
    assert_ne!(shown(&three, 0).1, shown(&three, 1).1);
}

/// Values of the only path of a random design.
fn drawn(path: &str, over: &str) -> Vec<f64> {
    let design = design(&format!(
        "scene = \"magnet-0.61g\"\nseed = 3\n[random]\ncount = 2000\n[random.over]\n{path} = {over}\n"
    ));
    let value = |run: u64| number(path, &design.run(run).values[0]).expect("a number").0;
    (0..design.count()).map(value).collect()
}

/// Mean and standard deviation.
fn moments(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (mean, (square / count).sqrt())
}

/// Each of 201 numbers has the same probability, whichever end comes first: mean 200, standard
/// deviation sqrt((201^2 - 1)/12) = 58.02; 2000 draws are within 4 standard errors of them.
#[test]
fn whole_numbers_are_drawn_from_descending_ranges_too() {
    for over in ["{ from = 300, to = 100 }", "{ from = 100, to = 300 }"] {
        let values = drawn("frames", over);
        let (mean, deviation) = moments(&values);
        assert!((mean - 200.0).abs() < 5.2, "{over}: mean {mean}");
        assert!((deviation - 58.02).abs() < 3.7, "{over}: deviation {deviation}");
        let is_right = |value: &f64| value.fract() == 0.0 && (100.0..=300.0).contains(value);
        assert!(values.iter().all(is_right), "{over}");
        assert!(values.contains(&100.0) && values.contains(&300.0), "{over}: both ends");
    }
}

/// The logarithm of a number between 1 and 1000 is uniform: 1/3 of 2000 are in each decade, within
/// 4 standard errors.
#[test]
fn logarithmic_whole_numbers_are_whole() {
    for over in [
        "{ from = 2, to = 1999, spacing = \"logarithmic\" }",
        "{ from = 1999, to = 2, spacing = \"logarithmic\" }",
    ] {
        let values = drawn("frames", over);
        assert!(values.iter().all(|value| value.fract() == 0.0), "{over}");
        assert!(values.iter().all(|value| (2.0..=1999.0).contains(value)), "{over}");
        for decade in [2.0, 20.0, 200.0] {
            let inside = values.iter().filter(|v| (decade..10.0 * decade).contains(*v)).count();
            assert!((582..752).contains(&inside), "{over}: {inside} from {decade}");
        }
    }
}

/// The logarithm of 2 to 4 is divided at 3: 2 has ln(3/2)/ln(2) = 58.5 % of the draws, 3 the rest;
/// 2000 draws are within 4 standard errors of 1170.
#[test]
fn both_ends_of_a_logarithmic_range_are_drawn() {
    let values = drawn("frames", "{ from = 2, to = 3, spacing = \"logarithmic\" }");
    let [two, three] = [2.0, 3.0].map(|end| values.iter().filter(|value| **value == end).count());
    assert_eq!(two + three, 2000);
    assert!((1082..1258).contains(&two), "{two}");
}

/// As in `[uncertainty]`, `%` is a share of the value, with or without a unit.
#[test]
fn a_deviation_in_percent_is_a_share_of_the_mean() {
    let modulus = "{ mean = \"1.46 GPa\", deviation = \"1 %\" }";
    let (mean, deviation) = moments(&drawn("materials.ptfe.youngs_modulus", modulus));
    assert!((deviation / mean - 0.01).abs() < 0.0007, "{deviation} of {mean}");
    let ratio = "{ mean = 0.4, deviation = \"1 %\" }";
    let (mean, deviation) = moments(&drawn("materials.ptfe.poissons_ratio", ratio));
    assert!((mean - 0.4).abs() < 0.0004, "{mean}");
    assert!((deviation - 0.004).abs() < 0.0003, "{deviation}: 1 % of 0.4 is 0.004");
    let absolute = "{ mean = 0.4, deviation = 0.01 }";
    let (_, deviation) = moments(&drawn("materials.ptfe.poissons_ratio", absolute));
    assert!((deviation - 0.01).abs() < 0.0007, "{deviation}");
}

/// 20 °C is 293.15 K, a deviation of 2 °C is 2 K.
#[test]
fn a_deviation_in_degrees_is_a_difference() {
    let over = "{ mean = \"20 °C\", deviation = \"2 °C\" }";
    let (mean, deviation) = moments(&drawn("effects.magnet_preload.temperature", over));
    assert!((mean - 293.15).abs() < 0.2, "{mean}");
    assert!((deviation - 2.0).abs() < 0.13, "{deviation}");
}

/// A change of 5 °C is 5 K, in a range, in a list and in the table of results.
#[test]
fn a_change_in_degrees_is_a_difference() {
    let path = "effects.sensor_tolerance.temperature_change";
    for values in
        ["{ from = \"0 °C\", to = \"10 °C\", count = 3 }", "[\"0 °C\", \"5 °C\", \"10 K\"]"]
    {
        let design = design(&format!("scene = \"magnet-0.61g\"\n[grid]\n{path} = {values}\n"));
        let value = |run: u64| number(path, &design.run(run).values[0]).expect("a number").0;
        for (run, kelvin) in [(0, 0.0), (1, 5.0), (2, 10.0)] {
            assert!((value(run) - kelvin).abs() < 1e-9, "{values}: {}", value(run));
        }
    }
}
