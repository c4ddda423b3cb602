//! Text wrapped to the width of a terminal.

/// Columns of such a terminal.
pub const TERMINAL_WIDTH: usize = 80;

/// Narrowest column in which words are wrapped (characters).
const MIN_FOLDED: usize = 20;

/// Longest unit that is kept beside its number (characters).
const MAX_UNIT: usize = 5;

/// Lines of whole words, `width` characters at most where words allow; a number and its unit are
/// one word.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match words.last_mut() {
            Some(number)
                if number.ends_with(|c: char| c.is_ascii_digit())
                    && word.chars().count() <= MAX_UNIT =>
            {
                number.push(' ');
                number.push_str(word);
            }
            _ => words.push(word.to_owned()),
        }
    }
    let mut lines = vec![String::new()];
    for word in words {
        let Some(line) = lines.last_mut() else { break };
        if line.is_empty() {
            *line = word;
        } else if line.chars().count() + 1 + word.chars().count() <= width {
            line.push(' ');
            line.push_str(&word);
        } else {
            lines.push(word);
        }
    }
    lines
}

/// The same as lines of a page: what comes first stands before the first of them, and the others as
/// far in.
pub fn hanging_indent(first: &str, text: &str) -> Vec<String> {
    let indent = first.chars().count();
    let lines = wrapped(text, TERMINAL_WIDTH.saturating_sub(indent));
    let before = |number: usize| if number == 0 { first } else { "" };
    lines.iter().enumerate().map(|(i, line)| format!("{:indent$}{line}", before(i))).collect()
}

/// `text` with its labelled lines (`  note  words ...`) wrapped below their words where they are
/// wider than `width`; tables, and what is no label, stay as they are.
pub fn folded(text: &str, width: usize) -> String {
    text.split('\n').flat_map(|line| fold(line, width)).collect::<Vec<_>>().join("\n")
}

/// TOML with comments that end beyond `width` continued on lines of their own.
pub fn folded_comments(text: &str, width: usize) -> String {
    text.split('\n').flat_map(|line| fold_comment(line, width)).collect::<Vec<_>>().join("\n")
}

fn fold_comment(line: &str, width: usize) -> Vec<String> {
    let (before, comment) = match line.find(" # ") {
        Some(at) => (&line[..=at], &line[at + 3..]),
        None if line.starts_with("# ") => ("", &line[2..]),
        None => return vec![line.to_owned()],
    };
    let indent = before.chars().count();
    if line.chars().count() <= width || indent + MIN_FOLDED > width {
        return vec![line.to_owned()];
    }
    let lines = wrapped(comment, width - indent - 2);
    let before = |number: usize| if number == 0 { before } else { "" };
    lines.iter().enumerate().map(|(i, line)| format!("{:indent$}# {line}", before(i))).collect()
}

fn fold(line: &str, width: usize) -> Vec<String> {
    let whole = || vec![line.to_owned()];
    if line.chars().count() <= width {
        return whole();
    }
    let Some((label, words)) = line.strip_prefix("  ").and_then(|body| body.split_once("  "))
    else {
        return whole();
    };
    let words = words.trim_start();
    let is_label = label.chars().all(|c| c.is_ascii_lowercase() || c == ' ');
    let indent = line.chars().count() - words.chars().count();
    if !is_label || words.contains("  ") || indent + MIN_FOLDED > width {
        return whole();
    }
    let first: String = line.chars().take(indent).collect();
    let before = |number: usize| if number == 0 { first.as_str() } else { "" };
    let lines = wrapped(words, width - indent);
    lines.iter().enumerate().map(|(i, line)| format!("{:indent$}{line}", before(i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_continued_below() {
        let line = "probe = 1   # default; attenuation of the probe at the tip";
        let folded = folded_comments(line, 36);
        assert_eq!(
            folded,
            "probe = 1   # default; attenuation\n            # of the probe at the\n            # tip"
        );
        assert_eq!(folded_comments("# one two three four five six seven", 24).lines().count(), 2);
        assert_eq!(folded_comments("text = \"no comment here at all\"", 24).lines().count(), 1);
    }

    #[test]
    fn labelled_lines_are_wrapped_below_their_words() {
        let note = "  note    the striker's speed was drawn from the seed of the scene";
        let folded = folded(note, 40);
        assert_eq!(
            folded,
            "  note    the striker's speed was drawn\n          from the seed of the scene"
        );
        // Continued lines, tables, JSON and TOML.
        let continued = "              traces within 1 % of the largest value of the whole";
        assert_eq!(super::folded(continued, 40).lines().count(), 2);
        for kept in
            ["  a  1  2  3  4  5  6  7", "  \"key\": \"words and words\"", "key = \"x\"  # words"]
        {
            assert_eq!(super::folded(kept, 12), kept);
        }
    }
}
