//! Help, completions, manual pages, the list of scenes.

use clap::CommandFactory as _;

use super::{COULD_NOT, files, hertzscope, printed, refused, says, temporary};

/// Names of all commands.
fn subcommands() -> Vec<String> {
    let command = hertzscope::cli::Arguments::command();
    command.get_subcommands().map(|found| found.get_name().to_owned()).collect()
}

#[test]
fn every_subcommand_has_help() {
    let folder = temporary();
    let all = printed(folder.path(), &["--help"]);
    let command = hertzscope::cli::Arguments::command();
    assert!(command.get_subcommands().count() > 20);
    for found in command.get_subcommands() {
        let name = found.get_name();
        assert!(all.lines().any(|line| line.starts_with(&format!("  {name} "))), "{name}: {all}");
        let page = printed(folder.path(), &[name, "--help"]);
        says(&page, &[&format!("Usage: hertzscope {name}"), "Example:", "Exit code:"]);
        for argument in found.get_arguments().filter(|argument| !argument.is_hide_set()) {
            if let Some(long) = argument.get_long() {
                says(&page, &[&format!("--{long}")]);
            }
            let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
            assert!(!help.is_empty(), "{name} {}: no help", argument.get_id());
        }
        for line in page.lines() {
            assert!(line.chars().count() <= 100, "{name}: {line}");
        }
    }
    says(&printed(folder.path(), &["--version"]), &[env!("CARGO_PKG_VERSION")]);
    assert_eq!(files(folder.path()), [""; 0], "help leaves nothing behind");
}

#[test]
fn what_is_typed_wrong_is_refused() {
    let folder = temporary();
    for arguments in [
        &["fly"][..],
        &[],
        &["run", "--fast"],
        &["info"],
        &["convert", "a.mcap"],
        &["info", "a.mcap", "b.mcap"],
        &["completions", "tcl"],
        #[cfg(feature = "server")]
        &["serve", "--impact-every", "0s"],
        #[cfg(feature = "server")]
        &["serve", "--impact-every", "1e30 s"],
        #[cfg(feature = "server")]
        &["serve", "--fault", "nonsense"],
        #[cfg(feature = "server")]
        &["serve", "--port-mapper", "0"],
        &["run", "magnet-0.61g", "gravity-0.61g"],
    ] {
        let done = hertzscope(folder.path(), arguments);
        assert_eq!(done.code, COULD_NOT, "{arguments:?}");
        assert_eq!(done.stdout, "", "{arguments:?}");
        says(&done.stderr, &["--help"]);
    }
    assert_eq!(files(folder.path()), [""; 0]);
}

/// The script asks the program with the words typed so far and the place of the one to be
/// completed, as bash has them in `COMP_CWORD`.
#[test]
fn completions_know_commands_scenes_and_recordings() {
    let folder = temporary();
    for shell in ["bash", "zsh", "fish"] {
        says(
            &printed(folder.path(), &["completions", shell]),
            &["HERTZSCOPE_COMPLETE", "hertzscope"],
        );
    }
    for file in ["day.mcap", "mine.toml", "notes.txt"] {
        std::fs::write(folder.path().join(file), "").expect("a file");
    }
    let offered = |words: &[&str]| {
        let mut asked = assert_cmd::Command::cargo_bin("hertzscope").expect("the program");
        asked.current_dir(folder.path()).env("HERTZSCOPE_COMPLETE", "bash");
        asked.env("_CLAP_COMPLETE_INDEX", words.len().to_string());
        asked.env("_CLAP_IFS", "\n").args(["--", "hertzscope"]).args(words);
        let output = asked.output().expect("the program runs").stdout;
        String::from_utf8(output).expect("text").lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let all = offered(&[""]);
    for command in subcommands() {
        assert!(all.contains(&command), "{command} in {all:?}");
    }
    assert_eq!(offered(&["run", "magnet-1"]), ["magnet-1.22g", "magnet-17.81g"]);
    assert_eq!(offered(&["run", "m"])[0], "mine.toml");
    assert_eq!(offered(&["arrivals", "d"]), ["day.mcap"]);
    assert_eq!(offered(&["arrivals", "m"]), [""; 0]);
    assert_eq!(offered(&["help", "g"]), ["gather", "grid"]);
    assert!(offered(&["calibrate", "--simulate", "pzt"]).contains(&"pzt-5a-710pf".to_owned()));
    assert!(offered(&["view", ""]).starts_with(&["day.mcap".to_owned(), "mine.toml".to_owned()]));
}

/// The annotated sweep is one: 3 speeds by 10 forces, 100 draws at each.
#[test]
fn the_annotated_sweep_runs() {
    let folder = temporary();
    let text = printed(folder.path(), &["help", "grid"]);
    std::fs::write(folder.path().join("grid.toml"), text).expect("a file");
    let page = printed(folder.path(), &["sweep", "grid.toml", "--json", "--quiet"]);
    let page: serde_json::Value = serde_json::from_str(&page).expect("JSON");
    assert_eq!(page["runs"], 3000, "{page}");
}

#[test]
fn manual_pages_are_printed_and_written() {
    let folder = temporary();
    let page = printed(folder.path(), &["man"]);
    says(&page, &[".TH hertzscope 1", "SYNOPSIS", "run"]);
    assert_eq!(printed(folder.path(), &["man", "--output", "pages"]), "");
    let pages = files(&folder.path().join("pages"));
    for command in subcommands() {
        assert!(pages.contains(&format!("hertzscope-{command}.1")), "{pages:?}");
    }
    let page =
        std::fs::read_to_string(folder.path().join("pages/hertzscope-run.1")).expect("a page");
    says(&page, &["accuracy"]);
    std::fs::write(folder.path().join("file"), "").expect("a file");
    says(&refused(folder.path(), &["man", "-o", "file"]), &["file"]);
}

#[test]
fn scenes_are_listed_and_printed() {
    let folder = temporary();
    let list = printed(folder.path(), &["scenes"]);
    for name in hertzscope::scene::Scene::names() {
        assert!(list.lines().any(|line| line.starts_with(&format!("{name} "))), "{name} in {list}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&printed(folder.path(), &["scenes", "--json"])).expect("JSON");
    let scenes = json.as_array().expect("a list");
    assert_eq!(scenes.len(), hertzscope::scene::Scene::names().len());
    assert!(scenes.iter().all(|s| s["name"].is_string() && s["title"].is_string()), "{json}");
    // What is printed is a scene to start from.
    let text = printed(folder.path(), &["scenes", "magnet-0.61g"]);
    let shipped = hertzscope::data::instrument("scenes", "magnet-0.61g").expect("it ships");
    assert_eq!(text.trim_end(), shipped.trim_end());
    std::fs::write(folder.path().join("mine.toml"), text).expect("a file");
    assert_eq!(printed(folder.path(), &["run", "mine.toml", "--accuracy", "1e-3", "--quiet"]), "");
    assert_eq!(files(folder.path()), ["mine.mcap", "mine.toml"]);
    says(&refused(folder.path(), &["scenes", "magnet-0.62g"]), &["`magnet-0.62g`", "magnet-0.61g"]);
}

/// Names, and what a person chooses by; each kind, and one file as it ships.
#[test]
fn what_ships_is_listed() {
    let folder = temporary();
    let list = |arguments: &[&str]| printed(folder.path(), &[&["list"], arguments].concat());
    let materials = list(&["materials"]);
    says(&materials, &["steel_52100", "E 210 GPa, nu 0.30, density 7810 kg/m^3", "polycarbonate"]);
    assert!(materials.lines().all(|line| line.chars().count() <= 80), "{materials}");
    for (kind, name) in [
        ("sensors", "pzt-5a-710pf"),
        ("strikers", "alumina-0.61g"),
        ("magnets", "herbold-ring"),
        ("scopes", "tds2014"),
        ("scenes", "magnet-0.61g"),
    ] {
        says(&list(&[kind]), &[name]);
        let json: Vec<serde_json::Value> =
            serde_json::from_str(&list(&[kind, "--json"])).expect("a list");
        assert!(json.iter().any(|entry| entry["name"] == name), "{json:?}");
    }
    says(&list(&["materials", "brass"]), &["source = ", "youngs_modulus = \"100 GPa\""]);
    says(&refused(folder.path(), &["list", "materials", "cheese"]), &["cheese", "brass"]);
}
