//! One side of a comparison.

use crate::measurement::metadata;
use crate::recording::{Shot, TraceSet};
use crate::scene::Scene;

/// One shot with what is known of the bench it was taken on.
#[derive(Debug, Clone, Copy)]
pub struct ComparedShot<'a> {
    /// Its name in reports.
    pub name: &'a str,
    /// The recording.
    pub set: &'a TraceSet,
    /// The shot.
    pub shot: &'a Shot,
    /// The scene, where known.
    pub scene: Option<&'a Scene>,
}

/// The scene behind a side: its own, or the one that travels with its recording.
pub(super) fn scene_of(side: ComparedShot<'_>) -> Option<Scene> {
    side.scene.cloned().or_else(|| metadata::scene_of(side.set, side.shot.number)?.ok())
}
