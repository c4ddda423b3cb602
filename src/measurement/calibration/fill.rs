//! Fills the words of a calibration's report, and writes the sensor's file.

use sha2::{Digest, Sha256};

use super::plausibility::contradictions;
use super::words::{
    BudgetReport, CalibrationReport, ImpactReport, MonteCarloReport, RecordingEvidence,
};
use crate::analysis::calibration::budget::BudgetLine;
use crate::analysis::calibration::{Calibration, ImpactResult};
use crate::numeric::intervals::NORMAL_95;
use crate::scene::hexadecimal;
use crate::scene::plan::{CalibrationPlan, Particulars};

/// Puts what was found into the report's words.
pub fn report(
    plan: &CalibrationPlan,
    found: &Calibration,
    evidence: Vec<RecordingEvidence>,
) -> CalibrationReport {
    let named: Particulars = plan.particulars.clone();
    let half = found.expanded();
    let chain = evidence.first().cloned().filter(|_| plan.gain.is_none());
    let chain = chain.as_ref();
    let is_loaded = plan.charge_amplifier.is_none();
    let impacts = found.impacts.iter().zip(&plan.impacts).zip(evidence);
    let striker = |index: usize| plan.strikers.get(index).map_or("", |(name, _)| name);
    CalibrationReport {
        title: named.title,
        item: named.item,
        sensor: named.sensor,
        host: named.host,
        date: named.date,
        laboratory: named.laboratory,
        customer: named.customer,
        temperature_k: named.temperature,
        software: concat!("hertzscope ", env!("CARGO_PKG_VERSION")).to_owned(),
        method: METHOD.to_owned(),
        plan_sha256: hexadecimal(&Sha256::digest(&plan.text)),
        input_resistance_ohm: is_loaded.then_some(plan.load.resistance),
        input_capacitance_f: is_loaded.then_some(plan.load.capacitance),
        charge_amplifier_v_per_c: plan.charge_amplifier,
        charge_sensitivity_c_per_n: plan.charge_amplifier.map(|gain| found.sensitivity / gain),
        in_chain: plan.gain.is_none(),
        channel: chain.map(|proof| proof.channel.clone()),
        range_v_per_div: chain.map(|proof| proof.volts_per_div),
        traceability_mass: named.mass_traceability,
        traceability_speed: named.speed_traceability,
        traceability_voltage: named.voltage_traceability,
        sensitivity_v_per_n: found.sensitivity,
        u_v_per_n: found.u,
        effective_degrees_of_freedom: Some(found.freedom).filter(|nu| nu.is_finite()),
        coverage_factor: found.coverage_factor(),
        expanded_v_per_n: half,
        expanded_relative: half / found.sensitivity,
        interval_95_v_per_n: [found.sensitivity - half, found.sensitivity + half],
        tau_s: found.tau,
        tau_u_s: found.tau_u,
        tau_expanded_s: NORMAL_95 * found.tau_u,
        tau_source: if found.tau_fitted { "read off the records" } else { "given" }.to_owned(),
        force_range_n: found.force_range,
        levels: found.levels,
        nonlinearity: found.nonlinearity.map(|n| n.change),
        nonlinearity_u: found.nonlinearity.map(|n| n.u),
        nonlinearity_expanded: found.nonlinearity.map(|n| n.expanded()),
        naive_v_per_n: found.naive,
        negative_polarity: found.negative,
        birge_ratio: found.birge_ratio,
        impacts: impacts
            .enumerate()
            .map(|(i, ((result, planned), proof))| {
                impact_report(i + 1, result, striker(planned.striker), proof)
            })
            .collect(),
        budget: found.budget.iter().map(budget_line).collect(),
        monte_carlo: found.monte_carlo.map(|m| MonteCarloReport {
            draws: m.draws,
            seed: m.seed,
            mean_v_per_n: m.mean,
            u_v_per_n: m.u,
            interval_95_v_per_n: m.interval_95,
            propagated_95_v_per_n: m.propagated_95,
            agrees_with_gum: m.agrees,
            difference_v_per_n: m.difference,
            tolerance_v_per_n: m.tolerance,
        }),
        contradictions: contradictions(plan, found),
        notes: found.notes.clone(),
    }
}

fn budget_line(line: &BudgetLine) -> BudgetReport {
    BudgetReport {
        input: line.name(),
        value: line.value,
        unit: line.unit.to_owned(),
        u: line.u,
        contribution_v_per_n: line.contribution,
        share: line.share,
    }
}

fn impact_report(
    number: usize,
    result: &ImpactResult,
    striker: &str,
    evidence: RecordingEvidence,
) -> ImpactReport {
    let impact = result.impact.as_ref();
    ImpactReport {
        number,
        evidence,
        used: result.exclusion.is_none(),
        excluded: result.exclusion.as_ref().map(ToString::to_string),
        striker: striker.to_owned(),
        momentum_n_s: result.momentum,
        integral_v_s: result.integral,
        sensitivity_v_per_n: result.sensitivity,
        own_u_v_per_n: result.own_uncertainty,
        naive_v_per_n: result.naive,
        peak_force_n: result.peak_force,
        baseline_v: impact.map(|i| i.baseline.level),
        baseline_u_v: impact.map(|i| i.baseline.uncertainty),
        noise_v: impact.map(|i| i.noise),
        contact_s: impact.map(|i| i.contact),
        duration_s: impact.map(|i| i.duration),
        window_s: impact.map(|i| i.window),
        pre_trigger: impact.map(|i| i.pre_trigger),
    }
}

/// The calibrated sensor as a file of `instruments/sensors`.
pub fn sensor_file(report: &CalibrationReport) -> String {
    let date = report.date.as_deref().unwrap_or("date not stated");
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
    let host = report.host.as_ref().map_or_else(String::new, host);
    format!(
        "# {}\nsource = \"{}, {date}; {}; plan SHA-256 {}\"\n\
         sensitivity = \"{} V/N\"\nsensitivity_u = {:e}\ntau = \"{} s\"\ntau_u = {:e}\n\
         {load}{chain}{host}",
        report.item.replace('\n', " "),
        quoted(&report.title),
        report.software,
        report.plan_sha256,
        report.sensitivity_v_per_n,
        report.u_v_per_n / report.sensitivity_v_per_n,
        report.tau_s,
        report.tau_u_s / report.tau_s,
    )
}

/// How it is done, for the certificate.
pub const METHOD: &str = "linear momentum: integral of the droop-corrected voltage over the contact, divided by m (v_i + v_r) + m g (t2 - t1)";
