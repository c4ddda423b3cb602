//! A plan as data.

use std::path::PathBuf;

use serde::Serialize;

use crate::quantity::Uncertain;
use crate::scene::document::SourceLocation;
use crate::sensor::Load;

/// How a speed was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeedMethod {
    /// As a speed.
    Speed,
    /// As a height.
    Height,
    /// As the time between two gates.
    GateTime,
    /// As the time until the striker comes back.
    FlightTime,
}

/// One impact of a plan.
#[derive(Debug, Clone)]
pub struct PlannedImpact {
    /// File or folder of its recording, or the address of a scope that is to record it.
    pub recording: PathBuf,
    /// Where the plan names it.
    pub place: SourceLocation,
    /// Channel.
    pub channel: String,
    /// Number of the shot.
    pub shot: u32,
    /// Which of the strikers, from 0.
    pub striker: usize,
    /// Speed before the contact, by what it was measured.
    pub incoming: (SpeedMethod, Uncertain),
    /// Speed after it.
    pub rebound: (SpeedMethod, Uncertain),
    /// First and last time to integrate, if not to be found (s).
    pub window: Option<[f64; 2]>,
}

/// Entries of the certificate that do not enter the calculation.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Particulars {
    /// One line about the calibration.
    pub title: String,
    /// The calibrated sensor.
    pub item: String,
    /// Name of the sensor's file.
    pub sensor: String,
    /// Kind of body that the plate sat in, as scenes call it.
    pub host: Option<String>,
    /// Day of the measurement, as typed.
    pub date: Option<String>,
    /// Who measured.
    pub laboratory: Option<String>,
    /// Whom it was for.
    pub customer: Option<String>,
    /// Temperature of the room (K).
    #[serde(rename = "temperature_k")]
    pub temperature: Option<f64>,
    /// Traceability of the mass.
    #[serde(rename = "traceability_mass")]
    pub mass_traceability: Option<String>,
    /// Traceability of the speed.
    #[serde(rename = "traceability_speed")]
    pub speed_traceability: Option<String>,
    /// Traceability of the voltage.
    #[serde(rename = "traceability_voltage")]
    pub voltage_traceability: Option<String>,
}

/// A checked plan.
#[derive(Debug, Clone)]
pub struct CalibrationPlan {
    /// The file.
    pub file: PathBuf,
    /// The file as typed.
    pub text: String,
    /// For the certificate.
    pub particulars: Particulars,
    /// The scope's gain, true over shown; none where sensor and scope are calibrated as one chain.
    pub gain: Option<Uncertain>,
    /// The scope's input, the sensor's load unless there is a charge amplifier.
    pub load: Load,
    /// Gain of a charge amplifier between sensor and scope (V/C).
    pub charge_amplifier: Option<f64>,
    /// Relative standard uncertainty that all speeds share (1).
    pub speed_scale_u: f64,
    /// Distance of the gates (m).
    pub gate_distance: Option<Uncertain>,
    /// Acceleration of free fall (m/s^2).
    pub gravity: Uncertain,
    /// Time constant, if it is not to be read off the records (s).
    pub tau: Option<Uncertain>,
    /// Mass above the plate over all that is set in motion (1).
    pub above: Uncertain,
    /// Name and mass of each striker (kg).
    pub strikers: Vec<(String, Uncertain)>,
    /// The impacts.
    pub impacts: Vec<PlannedImpact>,
    /// Seed of the Monte-Carlo part.
    pub seed: u64,
    /// Its draws.
    pub draws: u64,
}
