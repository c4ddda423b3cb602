//! Rust's solvers and hertzscope, told scene by scene and setting by setting on standard input what
//! to run; an answer a line in JSON. `scene NAME` describes a scene for the other peers,
//! `run METHOD SETTING SECONDS NAME` solves it again and again for that long.

#[path = "../../../common/mod.rs"]
mod common;
mod problem;
mod solvers;

use std::collections::HashMap;
use std::io::BufRead as _;

use common::clock::time;
use common::ours::{self, Watching};
use common::scenes::Case;
use problem::Problem;
use serde_json::{Value, json};

fn main() {
    let mut problems: HashMap<String, Problem> = HashMap::new();
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("text on standard input");
        let words: Vec<&str> = line.split_whitespace().collect();
        let answer = match words[..] {
            ["scene", name] => known(&mut problems, name).to_json(),
            ["run", method, setting, seconds, name] => {
                let number = |text: &str| text.parse().expect("a number");
                let solved = match method.split_once('+') {
                    Some(own) => hertzscope(own, number(setting), number(seconds), &case(name)),
                    None => {
                        peer(method, number(setting), number(seconds), known(&mut problems, name))
                    }
                };
                solved.unwrap_or_else(|why| json!({ "failed": why }))
            }
            _ => {
                json!({ "failed": format!("found {line:?}, expected `scene NAME` or `run METHOD SETTING SECONDS NAME`") })
            }
        };
        println!("{answer}");
    }
}

fn case(name: &str) -> Case {
    Case::named(name).unwrap_or_else(|| panic!("found no scene {name}"))
}

fn known<'a>(problems: &'a mut HashMap<String, Problem>, name: &str) -> &'a Problem {
    problems.entry(name.to_owned()).or_insert_with(|| Problem::of(&case(name)))
}

/// hertzscope itself: METHOD is `rkn86+bare`, `velocity-verlet+recorded` and the like.
fn hertzscope(
    (name, watching): (&str, &str),
    setting: f64,
    seconds: f64,
    case: &Case,
) -> Result<Value, String> {
    let method = ours::method(name, setting, case).ok_or("found no such method")?;
    let watching = match watching {
        "bare" => Watching::Bare,
        "peaks" => Watching::Peaks,
        "sampled" => Watching::Sampled,
        "recorded" => Watching::Recorded,
        other => return Err(format!("found {other}, expected bare, peaks, sampled or recorded")),
    };
    let fail = |error: hertzscope::motion::IntegrateError| error.to_string();
    let peaks = ours::run(case, method, Watching::Peaks).map_err(fail)?;
    let cpu = time(seconds, || {
        std::hint::black_box(ours::run(case, method, watching).ok());
    });
    Ok(json!({ "cpu_s": cpu, "peaks_n": peaks }))
}

fn peer(method: &str, setting: f64, seconds: f64, problem: &Problem) -> Result<Value, String> {
    let states = solvers::solve(method, setting, problem)?;
    let cpu = time(seconds, || {
        std::hint::black_box(solvers::solve(method, setting, problem).ok());
    });
    Ok(json!({ "cpu_s": cpu, "states": states }))
}
