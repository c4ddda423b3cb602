//! Numbers as the screen writes them: three digits, prefix and unit without a space, `500mV`,
//! `2.50ms`.

/// Prefixes and their powers of ten.
const PREFIXES: [(&str, i32); 9] =
    [("p", -12), ("n", -9), ("µ", -6), ("m", -3), ("", 0), ("k", 3), ("M", 6), ("G", 9), ("T", 12)];

/// `value` in `unit` to three digits.
pub fn readout(value: f64, unit: &str) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{:.2}{unit}", if value.is_finite() { 0.0 } else { value });
    }
    // What rounds up to the next power of ten has that one's prefix.
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    let fits = |(_, power): &&(&str, i32)| rounded.abs() >= 10f64.powi(*power) * (1.0 - 1e-9);
    let (prefix, power) = PREFIXES.iter().rev().find(fits).unwrap_or(&PREFIXES[0]);
    let scaled = rounded / 10f64.powi(*power);
    let decimals = match scaled.abs() + 1e-9 {
        size if size >= 100.0 => 0,
        size if size >= 10.0 => 1,
        _ => 2,
    };
    format!("{scaled:.decimals$}{prefix}{unit}")
}

#[cfg(test)]
mod tests {
    use super::readout;

    #[test]
    fn three_digits() {
        for (value, text) in [
            (1.0, "1.00V"),
            (0.5, "500mV"),
            (0.02, "20.0mV"),
            (2.5e-3, "2.50mV"),
            (0.99999, "1.00V"),
            (-4.56, "-4.56V"),
            (0.0, "0.00V"),
            (250e-6, "250µV"),
            (12_345.0, "12.3kV"),
        ] {
            assert_eq!(readout(value, "V"), text);
        }
    }
}
