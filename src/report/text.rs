//! Text wrapped to the width of a terminal.

/// Columns of such a terminal.
pub const TERMINAL_WIDTH: usize = 80;

/// Lines of whole words, `width` characters at most where words allow.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
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

/// The same as lines of a page: what comes first stands before the first of them, and the others as far in.
pub fn hanging_indent(first: &str, text: &str) -> Vec<String> {
    let indent = first.chars().count();
    let lines = wrapped(text, TERMINAL_WIDTH.saturating_sub(indent));
    let before = |number: usize| if number == 0 { first } else { "" };
    lines.iter().enumerate().map(|(i, line)| format!("{:indent$}{line}", before(i))).collect()
}
