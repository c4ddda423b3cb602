//! Cases that are hard to integrate, each with its bound: the table of the command `hard-cases`.

use ratatui::Frame;

use super::list::{self, List};
use super::study;
use crate::report;
use crate::studies::hard_cases::{CaseResult, run_all};
use crate::tui::model::{Page, PageSpec, ScreenState};
use crate::tui::view::layout::ScreenLayout;

/// The page.
pub const PAGE: Page = Page(&PageSpec {
    name: "hard cases",
    key: 'h',
    help: "cases that are hard to integrate, each with its bound",
    keys: list::KEYS,
    hints: &[("?", "help"), ("Esc", "traces"), ("↑ ↓", "case"), ("y", "effects"), ("w", "save")],
    is_wide: true,
    rows: Some(|model| model.jobs.hard_cases.done().map_or(0, Vec::len)),
    opened: |model| {
        study::ask(model, |jobs| &mut jobs.hard_cases, |progress| Ok(run_all(progress)));
    },
    draw,
    ..PageSpec::PLAIN
});

fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let words = ("the hard cases", "press h twice to compute them");
    if let Some(cases) = study::done(&model.jobs.hard_cases, words, layout.page, frame) {
        list::draw(model, table(model, cases), layout.page, frame);
    }
}

fn table(model: &ScreenState, cases: &[CaseResult]) -> List {
    let mut list = List::from(report::hard_cases_table(cases));
    list.selected = cases.get(model.row).map_or_else(String::new, |case| {
        let [why, bound, figure] =
            [case.why, case.bound, &case.figure].map(|t| t.trim_end_matches('.'));
        format!("{}: {why}. Bound: {bound}. Figure: {figure}.", case.case)
    });
    list
}
