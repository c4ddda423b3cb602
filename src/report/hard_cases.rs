//! The catalogue of hard cases as a page of text.

use super::text::hanging_indent;
use crate::studies::hard_cases::CaseResult;

/// The page that `hard-cases` prints.
pub fn hard_cases(findings: &[CaseResult]) -> String {
    let mut lines = Vec::new();
    for finding in findings {
        lines.push(format!("{:<8} {}", finding.verdict.word(), finding.case));
        for (label, text) in
            [("why", finding.why), ("bound", finding.bound), ("figure", finding.figure.as_str())]
        {
            lines.extend(hanging_indent(&format!("         {label:<7} "), text));
        }
    }
    let count = |word: &str| findings.iter().filter(|f| f.verdict.word() == word).count();
    lines.push(format!(
        "{} cases: {} right, {} refused with a named cause, {} wrong",
        findings.len(),
        count("right"),
        count("refused"),
        count("wrong")
    ));
    lines.join("\n")
}
