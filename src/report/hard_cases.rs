//! The catalogue of hard cases as a page of text: one line a case.

use super::plot::{Axis, COLOURS, Plot, Series, Sheet, Stroke};
use super::table::{self, RowTable};
use super::text::hanging_indent;
use crate::studies::hard_cases::CaseResult;

/// Most decades of the picture's abscissa.
const MAX_DECADES: i32 = 8;

/// How near each case comes to its bound, as a picture.
pub fn hard_cases_picture(findings: &[CaseResult]) -> Sheet {
    let rows = || findings.iter().enumerate().map(|(row, finding)| (row as f64, finding));
    let points: Vec<(f64, f64)> =
        rows().filter_map(|(row, finding)| Some((share(finding)?, row))).collect();
    let label = "figure over bound; at the left end: that or less; refused cases have none";
    let x = Axis::powers(label, points.iter().map(|point| point.0).chain([1.0]), MAX_DECADES);
    let mut plot = Plot::of_rows(x, findings.iter().map(|finding| finding.case.to_owned()));
    plot.beside = rows().map(|(row, finding)| (row, finding.verdict.word().to_owned())).collect();
    plot.lines = vec![Series::new("figure", points, COLOURS[0], Stroke::Dots)];
    plot.marks = vec![(1.0, "bound".to_owned())];
    Sheet::rows("Hard cases: the tightest figure of each over its bound", plot)
}

/// The tightest figure of a case over its bound (1).
fn share(finding: &CaseResult) -> Option<f64> {
    finding.found.zip(finding.limit).map(|(found, limit)| found / limit)
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent < 0.1 { "< 0.1 %".to_owned() } else { format!("{percent:.1} %") }
}

/// The table of hard cases, a row for each.
pub fn hard_cases_table(findings: &[CaseResult]) -> RowTable {
    let heading = ["case", "checks", "figure", "bound", "figure/bound", "verdict"]
        .map(str::to_owned)
        .to_vec();
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.1e}"));
    let row = |finding: &CaseResult| {
        vec![
            finding.case.to_owned(),
            finding.checks.to_string(),
            number(finding.found),
            number(finding.limit),
            share(finding).map_or("-".to_owned(), percent),
            finding.verdict.word().to_owned(),
        ]
    };
    let rows: Vec<Vec<String>> = std::iter::once(heading).chain(findings.iter().map(row)).collect();
    let mut lines = table::lines(&rows, &[0, 5]).into_iter();
    let head = lines.by_ref().take(1).collect();
    let count = |word: &str| findings.iter().filter(|f| f.verdict.word() == word).count();
    let foot = format!(
        "{} cases: {} right, {} refused with a named cause, {} wrong",
        findings.len(),
        count("right"),
        count("refused"),
        count("wrong"),
    );
    RowTable { head, rows: lines.collect(), foot }
}

/// The page that `hard-cases` prints; with what makes each case hard, its bound and its tightest
/// figure where `why` is true.
pub fn hard_cases(findings: &[CaseResult], why: bool) -> String {
    let RowTable { head: mut lines, rows, foot } = hard_cases_table(findings);
    for (finding, line) in findings.iter().zip(rows) {
        lines.push(line);
        let texts = [("why", finding.why), ("bound", finding.bound), ("figure", &finding.figure)];
        for (label, text) in texts.into_iter().filter(|_| why) {
            lines.extend(hanging_indent(&format!("    {label:<7} "), text));
        }
    }
    let hint = if why { "" } else { " (--why says what makes each hard)" };
    lines.push(format!("{foot}{hint}"));
    lines.join("\n")
}
