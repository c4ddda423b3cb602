//! Tables 1 and 2 as printed: `recordings/herbold-2009-tables.toml`, to stand beside what comes out
//! here.

use serde::Serialize;

use crate::data;
use crate::quantity::Dimension;
use crate::scene::Scene;
use crate::scene::document::Node;
use crate::scene::problem::Problem;
use crate::scene::reader::{Bound, Problems, TableReader};

/// One row of the paper's Tables 1 and 2: speed of the leading pulse from particle 14 to 27.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PaperSpeed {
    /// Scene name.
    #[serde(skip)]
    pub scene: String,
    /// Table 1 or 2.
    pub table: u64,
    /// Measured (m/s).
    pub experiment_m_per_s: f64,
    /// Calculated, by an estimator that the paper does not name (m/s).
    pub numerics_m_per_s: f64,
}

/// The printed speed for `scene`, if it is one of the paper's, unchanged.
pub fn speed_of(scene: &Scene) -> Option<PaperSpeed> {
    let row = speeds().ok()?.into_iter().find(|row| row.scene == scene.name)?;
    // A file of the same name may say something else.
    let shipped = Scene::load(&row.scene).ok()?;
    (shipped.texts == scene.texts).then_some(row)
}

/// All rows.
///
/// # Errors
/// Every problem of the file, which would be this program's own mistake.
pub fn speeds() -> Result<Vec<PaperSpeed>, Vec<Problem>> {
    const FILE: &str = "herbold-2009-tables.toml";
    let bytes = data::recording(FILE).unwrap_or_default();
    let root = Node::parse(FILE, &String::from_utf8_lossy(bytes))?;
    let problems = Problems::default();
    let table = TableReader::of(&root, "", &problems);
    let rows = table.map_or_else(Vec::new, |root| {
        let _ = root.node("provenance");
        let rows = root.list("speed").into_iter().filter_map(|row| speed(&row)).collect();
        root.finish();
        rows
    });
    let problems = problems.into_sorted();
    if problems.is_empty() { Ok(rows) } else { Err(problems) }
}

fn speed(row: &TableReader<'_>) -> Option<PaperSpeed> {
    Some(PaperSpeed {
        scene: row.required_text("scene", "a scene's name")?.to_owned(),
        table: row.count("table", 1, 2)?,
        experiment_m_per_s: row.required("experiment", Dimension::SPEED, Bound::Positive)?,
        numerics_m_per_s: row.required("numerics", Dimension::SPEED, Bound::Positive)?,
    })
}
