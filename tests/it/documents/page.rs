//! Pages, and the blocks between their fences.

use std::path::Path;

/// A page of documentation.
pub struct Page {
    /// Its path from the checkout's root.
    pub name: String,
    pub text: String,
}

/// What stands between two fences.
pub struct Block {
    /// What stands behind the first fence.
    pub info: String,
    pub text: String,
    /// Line of the first fence, counted from 1.
    pub line: usize,
}

/// The README and all pages of `docs/`, by name.
pub fn pages(root: &Path) -> Vec<Page> {
    let mut names = vec!["README.md".to_owned()];
    let mut folders = vec!["docs".to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root.join(&folder)).expect("a folder") {
            let entry = entry.expect("an entry");
            let name = format!("{folder}/{}", entry.file_name().display());
            if entry.path().is_dir() {
                folders.push(name);
            } else if entry.path().extension().is_some_and(|extension| extension == "md") {
                names.push(name);
            }
        }
    }
    names.sort();
    let page = |name: String| {
        let text = std::fs::read_to_string(root.join(&name)).expect("a page");
        Page { name, text }
    };
    names.into_iter().map(page).collect()
}

impl Page {
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        let mut open: Option<Block> = None;
        for (index, line) in self.text.lines().enumerate() {
            match (line.strip_prefix("```"), &mut open) {
                (Some(info), None) => {
                    let (info, text) = (info.to_owned(), String::new());
                    open = Some(Block { info, text, line: index + 1 });
                }
                (Some(_), Some(_)) => blocks.extend(open.take()),
                (None, Some(block)) => block.text.extend([line, "\n"]),
                (None, None) => {}
            }
        }
        assert!(open.is_none(), "{}: a block without an end", self.name);
        blocks
    }

    /// Targets of links to files, without their anchors.
    pub fn links(&self) -> impl Iterator<Item = &str> {
        let targets = self.text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        let files = targets.filter(|target| !target.contains("://") && !target.starts_with('#'));
        files.map(|target| target.split('#').next().unwrap_or(target))
    }
}

impl Block {
    /// Its commands, without the comments behind them.
    pub fn commands(&self) -> Box<dyn Iterator<Item = &str> + '_> {
        if self.info == "console" {
            return Box::new(self.answers().into_iter().map(|(command, _)| command));
        }
        let shell = self.info.split_whitespace().next() == Some("sh");
        let lines = self.text.lines().filter(move |_| shell);
        let lines = lines.map(|line| line.split("  #").next().unwrap_or(line).trim());
        Box::new(lines.filter(|line| !line.is_empty() && !line.starts_with('#')))
    }

    /// Commands and what is shown of their answers.
    pub fn answers(&self) -> Vec<(&str, &str)> {
        let parts = self.text.strip_prefix("$ ").expect("a command behind `$`").split("\n$ ");
        parts.map(|part| part.split_once('\n').unwrap_or((part, ""))).collect()
    }
}
