//! Propagation of uncertainty: every input's part in that of the sensitivity.
//!
//! `u^2 = sum of (c_i u_i)^2`, with the sensitivity coefficients `c_i` the derivatives at the
//! estimates. Inputs are independent of each other; what impacts share is one input. Source: JCGM
//! 100:2008, 5.1.2 and 5.1.3. Valid where the result is nearly linear over the uncertainties, which
//! the Monte Carlo part checks.

use super::model::{InputKind, MeasurementEquation};

/// One input's part.
#[derive(Debug, Clone, PartialEq)]
pub struct BudgetLine {
    /// Its name.
    pub kind: InputKind,
    /// Which one; empty where there is one only.
    pub which: String,
    /// Its estimate (unit).
    pub value: f64,
    /// Its standard uncertainty (unit).
    pub u: f64,
    /// Its unit.
    pub unit: &'static str,
    /// Change of the sensitivity with one standard uncertainty of it (V/N).
    pub contribution: f64,
    /// Its share of the variance (1).
    pub share: f64,
}

impl BudgetLine {
    /// Its name, as in a table.
    pub fn name(&self) -> String {
        self.kind.of(&self.which)
    }
}

/// The budget of `model`: all inputs that are uncertain.
pub fn propagate(model: &MeasurementEquation) -> Vec<BudgetLine> {
    let changes = model.contributions_to_sensitivity();
    let variance: f64 = changes.iter().map(|change| change * change).sum();
    let lines = model.inputs().iter().zip(changes).filter(|(input, _)| input.u > 0.0);
    lines
        .map(|(input, contribution)| BudgetLine {
            kind: input.kind,
            which: input.which.clone(),
            value: input.value,
            u: input.u,
            unit: input.unit,
            contribution,
            share: contribution * contribution / variance,
        })
        .collect()
}
