//! `hertzscope scenes`: what ships with the program.

use clap::Args;
use serde::Serialize;

use crate::data;
use crate::scene::{Scene, SceneError};

/// List the included scenes, or print one as a template
#[derive(Debug, Args)]
pub struct Arguments {
    /// Print this scene's file
    name: Option<String>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

/// A scene of the list.
#[derive(Serialize)]
struct Titled<'a> {
    name: &'a str,
    title: &'a str,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if let Some(name) = &arguments.name {
        let text = data::instrument("scenes", name)
            .ok_or_else(|| SceneError::Unknown { name: name.clone(), shipped: Scene::names() })?;
        return super::print(text.trim_end());
    }
    let scenes = Scene::names().into_iter().map(Scene::load).collect::<Result<Vec<_>, _>>()?;
    let list: Vec<Titled<'_>> =
        scenes.iter().map(|scene| Titled { name: &scene.name, title: &scene.title }).collect();
    super::show(&list, arguments.json, |list| {
        let lines = list.iter().map(|row| format!("{:<22} {}", row.name, row.title));
        lines.collect::<Vec<_>>().join("\n")
    })
}
