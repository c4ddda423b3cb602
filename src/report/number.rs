//! Numbers with their expanded uncertainty, to two digits of it.

use crate::quantity::engineering;

/// Decimals that show two digits of `u`.
pub(super) fn decimals(u: f64) -> usize {
    (1.0 - u.log10().floor()).clamp(0.0, 12.0) as usize
}

/// In the unit as it stands: `1.4601 ± 0.0023 GPa`.
pub(super) fn plus_minus(value: f64, expanded: f64, unit: &str) -> String {
    let decimals = decimals(expanded);
    format!("{value:.decimals$} ± {expanded:.decimals$} {unit}").trim_end().to_owned()
}

/// In the number's own prefix: `319 ± 12 mN`.
pub(super) fn with_expanded(value: f64, expanded: f64, unit: &str) -> String {
    let shown = engineering(value, unit, 6);
    let Some((number, prefixed)) = shown.split_once(' ') else { return shown };
    let Ok(mantissa) = number.parse::<f64>() else { return shown };
    if mantissa == 0.0 || !expanded.is_finite() {
        return engineering(value, unit, 4);
    }
    let scale = 10f64.powf((mantissa / value).log10().round());
    plus_minus(value * scale, expanded * scale, prefixed)
}
