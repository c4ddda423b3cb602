//! Calibrates a sensor by the plan and the recordings of a momentum test. Without the name of a
//! plan, the test is simulated.

#![allow(clippy::disallowed_macros, reason = "an example prints")]

use std::path::PathBuf;

use hertzscope::calibrate::{self, design::Designer};
use hertzscope::recording;
use hertzscope::recording::tek_csv::TableColumns;
use hertzscope::scene::plan;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let file = if let Some(file) = std::env::args().nth(1) {
        PathBuf::from(file)
    } else {
        let designer = Designer::new("pzt-5a-710pf", plan::lab::load(None)?, 1)?;
        let designs = designer.search(&mut |_| ())?;
        let test = designer.test(&designs[0])?;
        for (name, set) in &test.recordings {
            recording::write(&folder.path().join(name), set)?;
        }
        let file = folder.path().join("plan.toml");
        std::fs::write(&file, &test.plan)?;
        file
    };
    let report = calibrate::run(&plan::load(&file)?, &TableColumns::default())?;
    let found = &report.result;
    println!("{:.4} V/N, U = {:.4} V/N (95 %)", found.sensitivity, found.expanded);
    for contradiction in &report.contradictions {
        println!("not certified: {contradiction}");
    }
    Ok(())
}
