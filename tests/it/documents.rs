//! Every example of the README and of `docs/` is executed, page by page from top to bottom, as a
//! reader would who types it in.
//!
//! What stands behind a block's fence says what it is:
//! - `toml FILE` is a file in the page's folder, used by a command of the page;
//! - `console` holds commands behind `$` and what they print; `...` stands for lines left out;
//! - `sh` holds commands that end well;
//! - `sh SCRIPT` holds lines of that script, which `tests/run --full` executes.

mod interactive;
mod page;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use page::{Block, Page, pages};

/// The test command of the README, which executes this file.
const THIS: &str = "tests/run";

/// Where the pages have a scope served; the tests serve it on a port that is free.
const SCOPE: &str = "127.0.0.1:5025";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A folder that looks like a checkout to those who only read from it.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let link = |name: &str| {
        std::os::unix::fs::symlink(root().join(name), folder.path().join(name)).expect("a link");
    };
    ["recordings", "docs"].into_iter().for_each(link);
    folder
}

/// What a command printed, on both streams, or how it failed.
fn printed(folder: &Path, command: &str) -> Result<String, String> {
    let command = command.replace("cargo run --release --", "hertzscope");
    if command.contains(SCOPE) {
        return interactive::with_scope(folder, |address| {
            let printed = printed(folder, &command.replace(SCOPE, address))?;
            Ok(printed.replace(address, SCOPE))
        });
    }
    let words: Vec<&str> = command.split_whitespace().take_while(|word| *word != "#").collect();
    match words[..] {
        [THIS, ..] => return Ok(String::new()),
        ["hertzscope", "serve", ref arguments @ ..] => {
            return interactive::served(folder, arguments);
        }
        ["hertzscope", "view", ref arguments @ ..] => {
            return interactive::viewed(folder, arguments);
        }
        _ => {}
    }
    let binary = PathBuf::from(env!("CARGO_BIN_EXE_hertzscope"));
    let mut path = vec![binary.parent().expect("its folder").to_owned()];
    path.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()));
    let output = Command::new("bash")
        .args(["-c", &format!("set -euo pipefail; exec 2>&1\n{command}")])
        .current_dir(folder)
        .env("PATH", std::env::join_paths(path).expect("a path"))
        .output()
        .expect("bash");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() { Ok(text) } else { Err(format!("{}:\n{text}", output.status)) }
}

/// Whether the lines shown were printed, in this order, with others where `...` stands.
fn shows(mut printed: &str, shown: &str) -> bool {
    let lines: Vec<&str> = shown.lines().collect();
    lines.split(|line| *line == "...").all(|part| {
        let part = part.join("\n");
        let found = printed.find(part.trim_matches('\n'));
        printed = found.map_or("", |at| &printed[at + part.trim_matches('\n').len()..]);
        found.is_some()
    })
}

/// What is wrong with a block, once its commands are executed.
fn problems(folder: &Path, block: &Block, page_name: &str) -> Vec<String> {
    let words: Vec<&str> = block.info.split_whitespace().collect();
    let mut wrong = Vec::new();
    match words[..] {
        ["toml", name] => std::fs::write(folder.join(name), &block.text).expect("a file"),
        ["console"] => {
            for (command, shown) in block.answers() {
                match printed(folder, command) {
                    Ok(printed) if shows(&printed, shown) => {}
                    Ok(printed) => {
                        wrong.push(format!("{command} shows\n{shown}\nand prints\n{printed}"));
                    }
                    Err(error) => wrong.push(format!("{command}: {error}")),
                }
            }
        }
        ["sh"] => {
            let failed =
                |command: &str| Some(format!("{command}: {}", printed(folder, command).err()?));
            wrong.extend(block.commands().filter_map(failed));
        }
        // Lines that another program executes as they stand here.
        ["python", script] => {
            let text = std::fs::read_to_string(root().join(script)).expect(script);
            let name = format!("\"{page_name}\"");
            if !text.contains(&name) {
                wrong.push(format!("{script} does not execute {name}"));
            }
        }
        ["sh", script] => {
            let text = std::fs::read_to_string(root().join(script)).expect(script);
            let missing = block.commands().filter(|command| !text.contains(command));
            wrong.extend(missing.map(|command| format!("{script} has no line {command}")));
        }
        _ => wrong.push(format!("found a block `{}`, expected one that is executed", block.info)),
    }
    wrong
}

fn page_problems(page: &Page) -> Vec<String> {
    let folder = folder();
    let blocks = page.blocks();
    let commands: String = blocks.iter().flat_map(Block::commands).collect();
    let mut wrong = Vec::new();
    for block in &blocks {
        let file = Path::new(&page.name).file_name().and_then(|name| name.to_str());
        let problems = problems(folder.path(), block, file.unwrap_or_default());
        wrong.extend(
            problems.into_iter().map(|what| format!("{}:{}: {what}", page.name, block.line)),
        );
        let file = block.info.strip_prefix("toml ");
        if file.is_some_and(|file| !commands.contains(file)) {
            wrong.push(format!("{}:{}: no command uses this file", page.name, block.line));
        }
    }
    wrong
}

#[test]
fn every_example_does_what_stands_there() {
    let pages = pages(root());
    let wrong: Vec<String> = std::thread::scope(|scope| {
        let work = |page| scope.spawn(move || page_problems(page));
        let working: Vec<_> = pages.iter().map(work).collect();
        working.into_iter().flat_map(|page| page.join().expect("a page")).collect()
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn every_link_leads_somewhere_and_every_page_is_linked() {
    let mut wrong = Vec::new();
    let mut linked = BTreeSet::new();
    for page in pages(root()) {
        let folder = root().join(&page.name).parent().expect("a folder").to_owned();
        for target in page.links() {
            match folder.join(target).canonicalize() {
                Ok(file) => _ = linked.insert(file),
                Err(error) => wrong.push(format!("{}: {target}: {error}", page.name)),
            }
        }
    }
    for page in pages(root()) {
        let file = root().join(&page.name).canonicalize().expect("a page");
        if page.name != "README.md" && !linked.contains(&file) {
            wrong.push(format!("{} is not linked", page.name));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_subcommand_stands_on_a_page() {
    let help = Command::new(env!("CARGO_BIN_EXE_hertzscope")).arg("help").output().expect("help");
    let help = String::from_utf8(help.stdout).expect("text");
    let names = help.lines().filter_map(|line| line.strip_prefix("  ")?.split_once("  "));
    let names: Vec<&str> = names.map(|(name, _)| name.trim()).filter(|n| !n.is_empty()).collect();
    assert!(names.contains(&"run") && names.len() > 20, "{names:?}");
    let text: String = pages(root()).into_iter().map(|page| page.text).collect();
    for name in names.into_iter().filter(|name| !name.starts_with('-') && *name != "help") {
        assert!(text.contains(&format!("hertzscope {name}")), "no page shows `hertzscope {name}`");
    }
}

#[test]
fn what_is_left_out_is_left_out_and_nothing_else() {
    let printed = "one\ntwo\nthree\nfour\n";
    assert!(
        shows(printed, "one\ntwo") && shows(printed, "one\n...\nfour") && shows(printed, "...")
    );
    assert!(shows(printed, "...\nthree\n...") && shows(printed, "two\n...\nfour\n"));
    assert!(!shows(printed, "one\nthree") && !shows(printed, "three\n...\none"));
}

/// Each program of `examples/`, which `cargo test` compiles, ends well and says something.
#[test]
fn every_program_of_the_library_s_examples_runs() {
    let sources = std::fs::read_dir(root().join("examples")).expect("a folder");
    let names: Vec<String> = sources
        .map(|entry| entry.expect("a file").path().file_stem().unwrap().to_string_lossy().into())
        .collect();
    assert!(names.len() >= 6, "{names:?}");
    let tests = std::env::current_exe().expect("a program");
    let folder = tests.ancestors().nth(2).expect("the profile's folder").join("examples");
    for name in names {
        let run = Command::new(folder.join(&name)).output().expect(&name);
        let errors = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success() && !run.stdout.is_empty(), "{name}: {errors}");
    }
}
