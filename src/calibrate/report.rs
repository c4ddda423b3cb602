//! Report of a calibration, as in `calibrate --json`, and the calibrated sensor's file.

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::result::Calibration;
use crate::numeric::intervals::normal_share;
use crate::scene::hexadecimal;
use crate::scene::plan::{CalibrationPlan, DecisionRule, Particulars, Tolerance};

/// A calibration with what identifies it: the content of a certificate. Names and units in its JSON
/// are part of the interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationReport {
    /// What the plan says of item, laboratory and traceability.
    #[serde(flatten)]
    pub named: Particulars,
    /// Program and version.
    pub software: String,
    /// How it was done.
    pub method: &'static str,
    /// SHA-256 of the plan, in hexadecimal.
    pub plan_sha256: String,
    /// Input resistance that the sensor was loaded with; none behind a charge amplifier (Ohm).
    pub input_resistance_ohm: Option<f64>,
    /// Input capacitance that the sensor was loaded with; none behind a charge amplifier (F).
    pub input_capacitance_f: Option<f64>,
    /// Gain of the charge amplifier behind the sensor (V/C).
    pub charge_amplifier_v_per_c: Option<f64>,
    /// Charge per force, if a charge amplifier shows it (C/N).
    pub charge_sensitivity_c_per_n: Option<f64>,
    /// Whether sensor and scope were calibrated as one: then the result holds for both together.
    pub in_chain: bool,
    /// Channel of that chain, where it is one.
    pub channel: Option<String>,
    /// Its vertical scale (V/div).
    pub range_v_per_div: Option<f64>,
    /// The result.
    #[serde(flatten)]
    pub result: Calibration,
    /// What contradicts itself so far that nothing is certified.
    pub contradictions: Vec<String>,
}

impl CalibrationReport {
    /// The report of `result`, which was found by `plan`.
    pub fn new(plan: &CalibrationPlan, result: Calibration, contradictions: Vec<String>) -> Self {
        let evidence = result.impacts.first().and_then(|impact| impact.evidence.clone());
        let chain = evidence.filter(|_| plan.gain.is_none());
        let is_loaded = plan.charge_amplifier.is_none();
        Self {
            named: plan.particulars.clone(),
            software: concat!("hertzscope ", env!("CARGO_PKG_VERSION")).to_owned(),
            method: METHOD,
            plan_sha256: hexadecimal(&Sha256::digest(&plan.text)),
            input_resistance_ohm: is_loaded.then_some(plan.load.resistance),
            input_capacitance_f: is_loaded.then_some(plan.load.capacitance),
            charge_amplifier_v_per_c: plan.charge_amplifier,
            charge_sensitivity_c_per_n: plan.charge_amplifier.map(|gain| result.sensitivity / gain),
            in_chain: plan.gain.is_none(),
            channel: chain.as_ref().map(|proof| proof.channel.clone()),
            range_v_per_div: chain.map(|proof| proof.volts_per_div),
            result,
            contradictions,
        }
    }
}

/// A statement of conformity with a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Conformity {
    /// Nominal value, tolerance and rule.
    #[serde(flatten)]
    pub tolerance: Tolerance,
    /// Whether the sensitivity conforms.
    pub verdict: Verdict,
    /// Probability that the true sensitivity lies outside the tolerance, by a normal distribution
    /// (1).
    pub risk: f64,
}

/// Whether a value conforms by a decision rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It conforms.
    Pass,
    /// It does not.
    Fail,
    /// Its interval contains an end of the tolerance: neither is shown.
    NotShown,
}

impl CalibrationReport {
    /// The statement of conformity, if the plan has a tolerance.
    ///
    /// By a guard band the difference from the nominal value must be at most the tolerance less the
    /// expanded uncertainty; the risk of a wrong acceptance is then at most 2.5 %. By simple
    /// acceptance it must be at most the tolerance, with a risk of up to 50 %. Source:
    /// ILAC-G8:09/2019, 4.2.1 and 4.2.2.
    pub fn conformity(&self) -> Option<Conformity> {
        let tolerance = self.named.conformity?;
        let (off, limit) = (self.result.sensitivity - tolerance.nominal, tolerance.tolerance);
        let guard = match tolerance.rule {
            DecisionRule::GuardBand => self.result.expanded,
            DecisionRule::SimpleAcceptance => 0.0,
        };
        let verdict = if off.abs() + guard <= limit {
            Verdict::Pass
        } else if off.abs() > limit + guard {
            Verdict::Fail
        } else {
            Verdict::NotShown
        };
        let beyond = |end: f64| normal_share(end / self.result.u);
        let risk = beyond(-limit - off) + beyond(off - limit);
        Some(Conformity { tolerance, verdict, risk })
    }
}

/// The calibrated sensor as a file of `instruments/sensors`.
pub fn sensor_file(report: &CalibrationReport) -> String {
    let date = report.named.date.as_deref().unwrap_or("date not stated");
    let chain = report.channel.as_ref().zip(report.range_v_per_div);
    let chain = chain.map_or_else(String::new, |(channel, range)| {
        format!("in_chain = true\nchannel = \"{channel}\"\nrange = \"{range} V/div\"\n")
    });
    // Behind a charge amplifier neither cable nor input counts.
    let load = report.input_resistance_ohm.zip(report.input_capacitance_f);
    let load = load.map_or_else(String::new, |(resistance, capacitance)| {
        format!(
            "input_resistance = \"{resistance} Ohm\"\ninput_capacitance = \"{capacitance} F\"\n"
        )
    });
    let quoted = |text: &str| text.replace(['"', '\\', '\n'], "'");
    let host = |host: &String| format!("calibrated_host = \"{}\"\n", quoted(host));
    let host = report.named.host.as_ref().map_or_else(String::new, host);
    format!(
        "# {}\nsource = \"{}, {date}; {}; plan SHA-256 {}\"\n\
         sensitivity = \"{} V/N\"\nsensitivity_u = {:e}\ntau = \"{} s\"\ntau_u = {:e}\n\
         {load}{chain}{host}",
        report.named.item.replace('\n', " "),
        quoted(&report.named.title),
        report.software,
        report.plan_sha256,
        report.result.sensitivity,
        report.result.u / report.result.sensitivity,
        report.result.tau,
        report.result.tau_u / report.result.tau,
    )
}

/// How it is done, for the certificate.
pub const METHOD: &str = "linear momentum: integral of the droop-corrected voltage over the contact, divided by m (v_i + v_r) + m g (t2 - t1)";
