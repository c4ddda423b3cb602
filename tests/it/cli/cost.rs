//! `hertzscope cost`.

use hertzscope::scene::Scene;
use hertzscope::studies::cost::study;
use serde_json::Value;

use super::{files, printed, refused, says, temporary};

const POINT: [&str; 10] = [
    "method",
    "setting",
    "failed",
    "error_peak",
    "error_arrival",
    "error_trace",
    "error_energy",
    "force_evaluations",
    "wall_s_median",
    "wall_s_min",
];

fn list<'a>(study: &'a Value, key: &str) -> &'a Vec<Value> {
    study[key].as_array().expect("a list")
}

#[test]
fn the_study_is_for_people_for_scripts_and_for_the_recording() {
    let folder = temporary();
    let asked = ["cost", "momentum-test", "--quiet"];
    let page = printed(folder.path(), &asked);
    says(
        &page,
        &["what accuracy costs in time", "with checks", "least", "against time of one run"],
    );
    says(&page, &["dormand-prince-853", "velocity-verlet", "●"]);
    let other = printed(folder.path(), &[&asked[..], &["--evaluations"]].concat());
    says(&other, &["against evaluations of all contact forces"]);
    says(&page, &["one level of the scope", "one sample interval of the scope"]);
    assert!(page.lines().all(|line| line.chars().count() <= 80), "{page}");
    // Every method has a mark of its own.
    let rows = page.lines().skip_while(|line| !line.contains("observed order")).skip(1);
    let marks: Vec<&str> = rows
        .take_while(|row| !row.trim().is_empty())
        .filter_map(|row| row.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).nth(1))
        .collect();
    let mut own = marks.clone();
    own.sort_unstable();
    own.dedup();
    assert!(own.len() == marks.len() && marks.contains(&"g"), "{marks:?}");
    assert!(!marks.contains(&"?"), "{marks:?}");
    let written = [&asked[..], &["--json", "--plot", "cost.svg", "--record", "cost.mcap"]].concat();
    let study: Value = serde_json::from_str(&printed(folder.path(), &written)).expect("a study");
    let reference = study["reference"]["error"].as_f64().expect("a number");
    assert!(reference < 1e-13, "{reference:e}");
    for point in list(&study, "points") {
        let keys = point.as_object().expect("an object");
        assert!(POINT.iter().all(|key| keys.contains_key(*key)), "{keys:?}");
        // Failed ones, too, stand where they would cost something; a time that nobody has measured
        // is none.
        assert!(point["force_evaluations"].as_u64().is_some_and(|count| count > 0), "{point}");
        let wall = &point["wall_s_min"];
        assert!(wall.is_null() || wall.as_f64().is_some_and(|wall| wall > 0.0), "{point}");
    }
    for chosen in list(&study, "chosen") {
        let number = |key: &str| chosen[key].as_f64().unwrap_or(-1.0);
        assert!(number("wall_s_median") > 0.0, "{chosen}");
        assert!(number("wall_held_s_median") >= number("wall_s_median"), "{chosen}");
        let accuracy = number("accuracy");
        for error in ["error_peak", "error_arrival"] {
            assert!((0.0..=accuracy).contains(&number(error)), "{chosen}");
        }
        assert!(number("error_trace") >= 0.0, "{chosen}");
    }
    // Twice the longest stable step is tried, so that the edge is seen.
    assert!(list(&study, "points").iter().any(|point| point["failed"] == true));
    let verlet = &list(&study, "orders")[0];
    let order = verlet["observed"].as_f64().expect("a number");
    assert!(verlet["method"] == "velocity-verlet" && (order - 2.0).abs() < 0.2, "{verlet}");
    // Steps that `run` refuses are none to choose from, however well they did.
    let points = || list(&study, "points").iter();
    let longest = points().find(|point| point["method"] == "velocity-verlet").expect("a point");
    assert_eq!(longest["failed"], true, "{longest}");
    // Long lines are wrapped.
    let unwrapped = page.split_whitespace().collect::<Vec<_>>().join(" ");
    for order in list(&study, "orders") {
        let source = order["source"].as_str().expect("a publication").to_owned();
        says(&unwrapped, &[&source]);
    }
    assert_eq!(files(folder.path()), ["cost.mcap", "cost.svg"]);
    let svg = std::fs::read_to_string(folder.path().join("cost.svg")).expect("a picture");
    for point in list(&study, "points") {
        says(&svg, &[point["method"].as_str().expect("a name")]);
    }
    says(&svg, &["first peaks", "arrivals", "traces", "energy in motion", "order 8"]);
    says(
        &svg,
        &["<svg", "one level of the scope", "one sample interval", "1e\u{2212}3", "--accuracy"],
    );
    says(&printed(folder.path(), &["info", "cost.mcap"]), &["cost.json", "application/json"]);
    says(&refused(folder.path(), &["cost", "--record", "cost.csv"]), &["cost.csv", "cost.mcap"]);
    for asked in [["--plot", "no/cost.svg"], ["--record", "no/cost.mcap"]] {
        says(
            &refused(folder.path(), &["cost", asked[0], asked[1]]),
            &[asked[1], "a folder that exists"],
        );
    }
}

/// What `--accuracy` chooses is as accurate as asked, and takes at most twice the force evaluations
/// of the best of all methods, those with gradients counted one and a half times, for so much
/// longer they take (the table of fixed steps in docs/performance.md): of the coarsest setting of
/// each from which on it is accurate enough. Coarser ones than 1e-3 tell too little, and rounding
/// is not far below finer ones than 1e-9.
#[test]
fn the_choice_is_within_twice_the_best() {
    for name in ["linear-300-cells", "magnet-0.61g", "gravity-1.22g", "monatomic-vacuum"] {
        let scene = Scene::load(name).expect("a shipped scene");
        let study = study(&scene, 1, &mut |_| ()).expect("a study");
        let asked = study.chosen.iter().filter(|c| (0.9e-9..1.1e-3).contains(&c.accuracy));
        let mut told = 0;
        for chosen in asked {
            let weighed = |method: &str, count: u64| {
                count as f64 * if method.contains("force-gradient") { 1.5 } else { 1.0 }
            };
            let (accuracy, count) = (chosen.accuracy, chosen.force_evaluations);
            let points = study.accurate(accuracy);
            let best = points.map(|p| weighed(p.method, p.force_evaluations)).reduce(f64::min);
            let share = weighed(chosen.method, count) / best.expect("an accurate point");
            println!("{name} at {accuracy:e}: {count} of {best:?}, {share:.2}");
            assert!(chosen.error.expect("a number") <= accuracy, "{name}: {chosen:?}");
            assert!(share <= 2.0, "{name} at {accuracy:e}: {share}");
            told += 1;
        }
        assert_eq!(told, 7, "{name}");
    }
}
