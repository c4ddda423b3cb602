//! `hertzscope scenes`: what ships with the program.

use clap::Args;
use serde_json::json;

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

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if let Some(name) = &arguments.name {
        let text = data::instrument("scenes", name)
            .ok_or_else(|| SceneError::Unknown { name: name.clone(), shipped: Scene::names() })?;
        return super::print(text.trim_end());
    }
    let scenes = Scene::names().into_iter().map(Scene::load).collect::<Result<Vec<_>, _>>()?;
    if arguments.json {
        let list = scenes.iter().map(|s| json!({ "name": s.name, "title": s.title }));
        return super::print(&serde_json::to_string_pretty(&list.collect::<Vec<_>>())?);
    }
    let lines: Vec<String> =
        scenes.iter().map(|scene| format!("{:<22} {}", scene.name, scene.title)).collect();
    super::print(&lines.join("\n"))
}
