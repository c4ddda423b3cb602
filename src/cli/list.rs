//! `hertzscope list`: the instruments, materials and scenes that ship with the program.

use anyhow::anyhow;
use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::data;
use crate::report::text::hanging_indent;

/// List the included materials or instruments, or print one as a template
#[derive(Debug, Args)]
pub struct Arguments {
    /// What to list
    kind: Kind,
    /// Print this file
    name: Option<String>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

/// Kinds of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Elastic constants, density and yield strength; `material = "NAME"` of a particle, striker or
    /// wall
    Materials,
    /// Piezo plates; `model = "NAME"` of a sensor
    Sensors,
    /// Spheres that hit the chain; `model = "NAME"` of the striker
    Strikers,
    /// Rings and measured forces; `model = "NAME"` of `effects.magnet_preload`
    Magnets,
    /// Oscilloscopes; `model = "NAME"` of the scope
    Scopes,
    /// Scenes; `base = "NAME"`, and the argument of most commands
    Scenes,
}

impl Kind {
    /// Folder of the files.
    fn folder(self) -> &'static str {
        match self {
            Self::Materials => "materials",
            Self::Sensors => "sensors",
            Self::Strikers => "strikers",
            Self::Magnets => "magnets",
            Self::Scopes => "",
            Self::Scenes => "scenes",
        }
    }
}

/// What a file says of itself: its title, its first comment, or its source; and the keys that a
/// list of materials shows.
fn description(kind: Kind, text: &str) -> String {
    let value = |key: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(key)?.trim().strip_prefix('='));
        let value = line.map(|value| value.split(" #").next().unwrap_or(value));
        value.map(|value| value.trim().trim_matches('"').to_owned())
    };
    let comment = || text.lines().next()?.strip_prefix("# ").map(str::to_owned);
    if kind == Kind::Materials {
        let keys = [
            ("youngs_modulus", "E"),
            ("poissons_ratio", "nu"),
            ("density", "density"),
            ("yield_strength", "yields at"),
        ];
        let known = keys.iter().filter_map(|(key, short)| match value(key) {
            Some(value) => Some(format!("{short} {value}")),
            None => (*key == "yield_strength").then(|| "yield strength unknown".to_owned()),
        });
        return known.collect::<Vec<_>>().join(", ");
    }
    value("title").or_else(comment).or_else(|| value("source")).unwrap_or_default()
}

/// A file of the list.
#[derive(Serialize)]
struct Described<'a> {
    name: &'a str,
    description: String,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let folder = arguments.kind.folder();
    let names = data::instrument_names(folder);
    if let Some(name) = &arguments.name {
        let text = data::instrument(folder, name)
            .ok_or_else(|| anyhow!("no `{name}` ships; these do: {}", names.join(", ")))?;
        return super::print(text.trim_end());
    }
    let described = names.iter().filter_map(|name| {
        Some((name, description(arguments.kind, data::instrument(folder, name)?)))
    });
    let list: Vec<Described<'_>> =
        described.map(|(name, description)| Described { name, description }).collect();
    super::show(&list, arguments.json, |list| {
        let lines =
            list.iter().map(|row| hanging_indent(&format!("{:<22} ", row.name), &row.description));
        lines.collect::<Vec<_>>().concat().join("\n")
    })
}
