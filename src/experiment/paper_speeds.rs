//! Tables 1 and 2 as printed: `recordings/herbold-2009-tables.toml`, to stand beside what comes out
//! here.

use serde::Serialize;

use crate::data;
use crate::quantity::Dimension;
use crate::scene::Scene;
use crate::scene::document::Node;
use crate::scene::problem::Problem;
use crate::scene::table::{Key, Problems, TableReader, any, count, list_of, positive, table, text};

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

table! {
    /// The file.
    struct FileKeys<'a> {
        provenance: &'a Node = any(&[]),
        speed: Vec<TableReader<'a>> = list_of(&[RowKeys::KEYS, NUMBER]),
    }
}

table! {
    /// One of `[[speed]]`, beside its table.
    struct RowKeys<'a> {
        scene: String = text().required(),
        experiment: f64 = positive(Dimension::SPEED).required(),
        numerics: f64 = positive(Dimension::SPEED).required(),
    }
}

/// Which of the paper's tables a row is of.
const NUMBER: &[Key] = &[count(1, 2).required().named("table", "")];

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
    let rows = TableReader::of(&root, "", &[FileKeys::KEYS], &problems).map(|table| {
        let rows = FileKeys::read(&table).speed.unwrap_or_default();
        rows.iter().filter_map(speed).collect()
    });
    problems.finish(rows)
}

fn speed(row: &TableReader<'_>) -> Option<PaperSpeed> {
    let keys = RowKeys::read(row);
    Some(PaperSpeed {
        scene: keys.scene?,
        table: row.get(NUMBER.first()?)?,
        experiment_m_per_s: keys.experiment?,
        numerics_m_per_s: keys.numerics?,
    })
}
