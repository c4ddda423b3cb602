//! The paper, computed: its figures as sheets, their data as tables, the verdicts as a table and
//! as a report.

mod data;
mod figures;
mod words;

pub use words::{paper, paper_parts};

use super::plot::Sheet;
use crate::studies::paper::{Arrangement, Figure, ForceSignal, PaperStudy};
use crate::table::Table;

/// A picture of the study: file stem, caption, content.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperPicture {
    /// Stem of its files, `figure-04`.
    pub stem: String,
    /// Caption.
    pub caption: String,
    /// The picture.
    pub sheet: Sheet,
    /// Its data: file names and tables.
    pub data: Vec<(String, Table)>,
}

/// All pictures of a study.
pub fn paper_pictures(study: &PaperStudy) -> Vec<PaperPicture> {
    let mut pictures: Vec<PaperPicture> = study.figures.iter().map(figure_picture).collect();
    if let Some(tables) = &study.tables {
        pictures.push(PaperPicture {
            stem: "tables-1-2".to_owned(),
            caption: format!(
                "Tables 1 and 2: speeds from particle 14 to 27, and what one dashpot of {:.1} N s/m in every contact does to them",
                tables.dashpot
            ),
            sheet: figures::speeds(tables),
            data: vec![("tables-1-2.csv".to_owned(), data::speeds(tables))],
        });
    }
    if !study.viscosity.is_empty() {
        let signals: Vec<&ForceSignal> =
            study.viscosity.iter().map(|viscous| &viscous.signal).collect();
        let names = study.viscosity.iter().map(|v| format!("force_n_at_{}_n_s_per_m", v.dashpot));
        pictures.push(PaperPicture {
            stem: "viscosity".to_owned(),
            caption: "Incoming shock of Fig. 10 with a dashpot in every contact".to_owned(),
            sheet: figures::viscosity(&study.viscosity),
            data: vec![(
                "viscosity.csv".to_owned(),
                data::traces(&signals, &names.collect::<Vec<_>>()),
            )],
        });
    }
    pictures
}

fn figure_picture(figure: &Figure) -> PaperPicture {
    let stem = format!("figure-{:02}", figure.number);
    let caption = match figure.arrangement {
        Arrangement::Sensors => format!(
            "Fig. {}, panels (c) and (d), the calculated ones: {}. Panels (a) and (b) are measurements that the paper gives as pictures only",
            figure.number, figure.title
        ),
        _ => format!("Fig. {}: {}", figure.number, figure.title),
    };
    let sheet = match figure.arrangement {
        Arrangement::Dispersion => figures::dispersion(figure),
        Arrangement::Rows => figures::rows(figure),
        Arrangement::Far => figures::far(figure),
        Arrangement::Sensors => figures::sensors(figure),
    };
    PaperPicture { caption, sheet, data: data::of_figure(figure, &stem), stem }
}
