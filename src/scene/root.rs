//! The keys of a scene: the table that all others are below.

use super::bodies::{BodyKeys, ChainKeys, MaterialKeys, StrikerKeys, VelocityKeys};
use super::document::Node;
use super::drive::DriveKeys;
use super::effects::{EffectsKeys, LOSS_KEYS};
use super::motion_sensors::{AccelerometerKeys, StrainGaugeKeys, VibrometerKeys};
use super::oscilloscope::ModelKeys;
use super::panel::PanelKeys;
use super::sensors::{PlaceKeys, SensorKeys};
use super::table::{Bound, NamedTables, TableReader};
use super::table::{any, count, list_of, positive, quantity, table, table_of, tables_of, text};
use crate::quantity::Dimension;

/// Accuracy of a scene that names none: relative error of first-peak forces and times (1).
pub const DEFAULT_ACCURACY: f64 = 1e-6;
/// Tightest accuracy that double precision supports over a whole run (1).
pub const TIGHTEST_ACCURACY: f64 = 1e-11;
/// Largest accuracy that a scene may ask for (1).
pub const LOOSEST_ACCURACY: f64 = 0.1;
/// Largest seed that a scene may name: whole numbers up to here are exact however a file is read.
pub const MAX_SEED: u64 = (1 << 53) - 1;
/// Number of frames of a run.
pub const FRAMES: std::ops::RangeInclusive<u32> = 2..=50_000;
/// Limits of the accuracy of runs (1).
pub(super) const ACCURACY: Bound = Bound::Within(TIGHTEST_ACCURACY, LOOSEST_ACCURACY);

table! {
    /// The scene itself.
    pub struct RootKeys<'a> {
        /// scene to start from, included (`hertzscope list scenes`) or a .toml file;
        /// keys given here replace its keys
        base: &'a str = text(),
        title: &'a str = text(),
        /// how long the bench is watched after the striker's first contact
        duration: f64 = positive(Dimension::TIME).required(),
        /// how often in that time all contacts' forces and all bodies' displacements
        /// are kept, 2 to 50000
        frames: u32 = count(*FRAMES.start() as u64, *FRAMES.end() as u64).or("200"),
        /// relative error of first peaks and times
        accuracy: f64 = quantity(Dimension::NONE, ACCURACY).or("1e-6"),
        /// of all that is random: noise, sample clock, spreads
        seed: u64 = count(0, MAX_SEED).or("0"),
        particles: NamedTables<'a> = tables_of(&[BodyKeys::KEYS]),
        /// of a shipped name, e.g. [materials.ptfe], it changes only the numbers that it gives
        materials: NamedTables<'a> = tables_of(&[MaterialKeys::KEYS]),
        chain: TableReader<'a> = table_of(&[ChainKeys::KEYS])
            .required()
            .needs("[chain] with top, bottom and segments"),
        striker: TableReader<'a> = table_of(&[BodyKeys::KEYS, StrikerKeys::KEYS]),
        /// what moves a wall: a piezo stack or a shaker
        drive: TableReader<'a> = table_of(&[DriveKeys::KEYS]),
        /// instead of a striker, or beside it
        initial_velocities: Vec<TableReader<'a>> = list_of(&[VelocityKeys::KEYS]),
        sensors: NamedTables<'a> = tables_of(&[PlaceKeys::KEYS, SensorKeys::KEYS]),
        /// laser vibrometers, each under a name of your own
        vibrometers: NamedTables<'a> = tables_of(&[VibrometerKeys::KEYS]),
        accelerometers: NamedTables<'a> = tables_of(&[AccelerometerKeys::KEYS]),
        /// on rods at the ends
        strain_gauges: NamedTables<'a> = tables_of(&[StrainGaugeKeys::KEYS]),
        /// default: one with nothing at its inputs, for a chain alone
        scope: TableReader<'a> = table_of(&[PanelKeys::KEYS, ModelKeys::KEYS])
            .required()
            .needs("[scope] with model, time_base, trigger and channels"),
        effects: TableReader<'a> = table_of(&[EffectsKeys::KEYS, LOSS_KEYS]),
        uncertainty: &'a Node = any(&[]),
    }
}
