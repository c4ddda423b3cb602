//! The catalogue of hard cases as a page of text.

use crate::experiment::hard_cases::Finding;

/// Longest line (characters).
const WIDTH: usize = 100;

/// The page that `hard-cases` prints.
#[must_use]
pub fn hard_cases(findings: &[Finding]) -> String {
    let mut lines = Vec::new();
    for finding in findings {
        lines.push(format!("{:<8} {}", finding.verdict.word(), finding.case));
        for (label, text) in
            [("why", finding.why), ("bound", finding.bound), ("figure", finding.figure.as_str())]
        {
            for (number, part) in wrapped(text, WIDTH - 17).iter().enumerate() {
                let label = if number == 0 { label } else { "" };
                lines.push(format!("         {label:<7} {part}"));
            }
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

/// Lines of whole words, `width` characters at most where words allow.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let Some(line) = lines.last_mut() else { break };
        if line.is_empty() {
            word.clone_into(line);
        } else if line.chars().count() + 1 + word.chars().count() <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}
