//! Report of a calibration, as in `calibrate --json`: names and units are part of the interface.

use serde::Serialize;

/// A recording as evidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingEvidence {
    /// File or folder as the plan names it.
    pub recording: String,
    /// SHA-256 of the file, or over a folder's captures in order of name, in hexadecimal.
    pub sha256: String,
    /// Channel.
    pub channel: String,
    /// Shot.
    pub shot: u32,
    /// Vertical scale, probe included (V/div).
    pub volts_per_div: f64,
    /// Time base (s/div).
    pub seconds_per_div: f64,
    /// The probe's attenuation (1).
    pub probe: f64,
    /// The instrument, where the file tells.
    pub instrument: Option<String>,
}

/// One impact in the report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImpactReport {
    /// Number in the plan, from 1.
    pub number: usize,
    /// Its recording.
    #[serde(flatten)]
    pub evidence: RecordingEvidence,
    /// Whether it was used.
    pub used: bool,
    /// Why it was left out.
    pub excluded: Option<String>,
    /// The striker's name.
    pub striker: String,
    /// Momentum handed over (N s).
    pub momentum_n_s: Option<f64>,
    /// Integral of the voltage with its droop undone (V s).
    pub integral_v_s: Option<f64>,
    /// Sensitivity from this impact alone (V/N).
    pub sensitivity_v_per_n: Option<f64>,
    /// Its standard uncertainty from this impact's own inputs (V/N).
    pub own_u_v_per_n: Option<f64>,
    /// Sensitivity by the raw voltage's integral (V/N).
    pub naive_v_per_n: Option<f64>,
    /// Largest force (N).
    pub peak_force_n: Option<f64>,
    /// Baseline (V).
    pub baseline_v: Option<f64>,
    /// Its standard uncertainty (V).
    pub baseline_u_v: Option<f64>,
    /// Standard uncertainty of one sample (V).
    pub noise_v: Option<f64>,
    /// Start of the contact after the trigger (s).
    pub contact_s: Option<f64>,
    /// Its duration (s).
    pub duration_s: Option<f64>,
    /// First and last time of the integral (s).
    pub window_s: Option<[f64; 2]>,
    /// Share of the record before the contact (1).
    pub pre_trigger: Option<f64>,
}

/// One line of the budget.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BudgetReport {
    /// Its name.
    pub input: String,
    /// Its estimate (unit).
    pub value: f64,
    /// Its unit.
    pub unit: String,
    /// Its standard uncertainty (unit).
    pub u: f64,
    /// Its contribution to the sensitivity's uncertainty (V/N).
    pub contribution_v_per_n: f64,
    /// Its share of the variance (1).
    pub share: f64,
}

/// The Monte-Carlo part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MonteCarloReport {
    /// Number of draws.
    pub draws: usize,
    /// Seed.
    pub seed: u64,
    /// Mean (V/N).
    pub mean_v_per_n: f64,
    /// Standard deviation (V/N).
    pub u_v_per_n: f64,
    /// 95 % of the draws lie between (V/N).
    pub interval_95_v_per_n: [f64; 2],
    /// The same by the propagation of uncertainty of the same inputs (V/N).
    pub propagated_95_v_per_n: [f64; 2],
    /// Whether it confirms the propagation of uncertainty, JCGM 101 clause 8.
    pub agrees_with_gum: bool,
    /// Largest difference of the ends of both intervals (V/N).
    pub difference_v_per_n: f64,
    /// Difference that is tolerated (V/N).
    pub tolerance_v_per_n: f64,
}

/// Everything a calibration tells.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationReport {
    /// One line about it.
    pub title: String,
    /// The calibrated sensor.
    pub item: String,
    /// Name of the sensor's file.
    pub sensor: String,
    /// Kind of body that the plate sat in.
    pub host: Option<String>,
    /// Day of the measurement.
    pub date: Option<String>,
    /// Who measured.
    pub laboratory: Option<String>,
    /// For whom.
    pub customer: Option<String>,
    /// Temperature of the room (K).
    pub temperature_k: Option<f64>,
    /// Program and version.
    pub software: String,
    /// How it was done.
    pub method: String,
    /// SHA-256 of the plan, in hexadecimal.
    pub plan_sha256: String,
    /// Input resistance that the sensor was loaded with; none behind a charge amplifier (Ohm).
    pub input_resistance_ohm: Option<f64>,
    /// Input capacitance that the sensor was loaded with; none behind a charge amplifier (F).
    pub input_capacitance_f: Option<f64>,
    /// Gain of the charge amplifier behind the sensor (V/C).
    pub charge_amplifier_v_per_c: Option<f64>,
    /// Charge per force, where a charge amplifier tells it (C/N).
    pub charge_sensitivity_c_per_n: Option<f64>,
    /// Whether sensor and scope were calibrated as one: then the result holds for both together.
    pub in_chain: bool,
    /// Channel of that chain, where it is one.
    pub channel: Option<String>,
    /// Its vertical scale (V/div).
    pub range_v_per_div: Option<f64>,
    /// Traceability of masses.
    pub traceability_mass: Option<String>,
    /// Traceability of speeds.
    pub traceability_speed: Option<String>,
    /// Traceability of voltages.
    pub traceability_voltage: Option<String>,
    /// Sensitivity before any droop (V/N).
    pub sensitivity_v_per_n: f64,
    /// Its standard uncertainty (V/N).
    pub u_v_per_n: f64,
    /// Its effective degrees of freedom; none where they are infinite (1).
    pub effective_degrees_of_freedom: Option<f64>,
    /// Student's t for these and 95 % (1).
    pub coverage_factor: f64,
    /// Its expanded uncertainty for 95 % (V/N).
    #[serde(rename = "U95_v_per_n")]
    pub expanded_v_per_n: f64,
    /// The same over the sensitivity (1).
    #[serde(rename = "U95_relative")]
    pub expanded_relative: f64,
    /// 95 % interval of the propagated uncertainty (V/N).
    pub interval_95_v_per_n: [f64; 2],
    /// Time constant (s).
    pub tau_s: f64,
    /// Its standard uncertainty (s).
    pub tau_u_s: f64,
    /// Its expanded uncertainty for 95 % (s).
    #[serde(rename = "tau_U95_s")]
    pub tau_expanded_s: f64,
    /// Where it is from.
    pub tau_source: String,
    /// Lowest and highest peak force (N).
    pub force_range_n: [f64; 2],
    /// Levels of force.
    pub levels: usize,
    /// Change of the sensitivity over that range, over itself; none where it cannot be told (1).
    pub nonlinearity: Option<f64>,
    /// Its standard uncertainty (1).
    pub nonlinearity_u: Option<f64>,
    /// Its expanded uncertainty for 95 % (1).
    #[serde(rename = "nonlinearity_U95")]
    pub nonlinearity_expanded: Option<f64>,
    /// Sensitivity by the raw voltage's integral (V/N).
    pub naive_v_per_n: f64,
    /// Whether pulses are negative.
    pub negative_polarity: bool,
    /// Scatter of the impacts over what their inputs explain (1).
    pub birge_ratio: f64,
    /// All impacts.
    pub impacts: Vec<ImpactReport>,
    /// The uncertainty budget.
    pub budget: Vec<BudgetReport>,
    /// The Monte-Carlo part.
    pub monte_carlo: Option<MonteCarloReport>,
    /// What contradicts itself so far that nothing is certified.
    pub contradictions: Vec<String>,
    /// Notes for the user.
    pub notes: Vec<String>,
}
