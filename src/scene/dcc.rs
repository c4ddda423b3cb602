//! Reads a sensor from a digital calibration certificate (DCC).
//!
//! A DCC is XML by PTB's schema (<https://ptb.de/dcc>, 3.x), with quantities by the D-SI schema
//! (<https://ptb.de/si>). The sensitivity is the quantity in volts per newton with an expanded
//! uncertainty `U`; its standard uncertainty is `U/k`. What `calibrate --dcc` writes beside it,
//! such as the time constant and the scope's input, has a `refType` that begins with `hertzscope_`.

use roxmltree::{Document, Node};

use crate::quantity::{Dimension, Uncertain, parse};

/// Namespace of the certificate's elements.
pub const DCC_NAMESPACE: &str = "https://ptb.de/dcc";
/// Namespace of quantities.
pub const SI_NAMESPACE: &str = "https://ptb.de/si";
/// `refType` of the sensitivity.
pub const SENSITIVITY: &str = "hertzscope_sensitivity";
/// `refType` of the time constant.
pub const TIME_CONSTANT: &str = "hertzscope_timeConstant";
/// `refType` of the input's resistance.
pub const INPUT_RESISTANCE: &str = "hertzscope_inputResistance";
/// `refType` of the input's capacitance.
pub const INPUT_CAPACITANCE: &str = "hertzscope_inputCapacitance";
/// `refType` of the channel that was calibrated with the sensor as one.
pub const CHANNEL: &str = "hertzscope_channel";
/// `refType` of that channel's volts per division.
pub const RANGE: &str = "hertzscope_voltsPerDivision";
/// `refType` of the kind of body that the sensor sat in.
pub const HOST: &str = "hertzscope_host";

/// Why a certificate cannot be used as a sensor.
#[derive(Debug, PartialEq, Eq)]
pub struct Unusable {
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// The text found.
    pub found: String,
    /// The text expected.
    pub expected: &'static str,
}

/// Symbols of D-SI's prefixes.
const PREFIXES: [(&str, &str); 11] = [
    ("femto", "f"),
    ("pico", "p"),
    ("nano", "n"),
    ("micro", "u"),
    ("milli", "m"),
    ("centi", "c"),
    ("kilo", "k"),
    ("mega", "M"),
    ("giga", "G"),
    ("tera", "T"),
    ("peta", "P"),
];

/// Symbols of D-SI's units, of those that a sensor's certificate may contain.
const UNITS: [(&str, &str); 12] = [
    ("volt", "V"),
    ("newton", "N"),
    ("coulomb", "C"),
    ("second", "s"),
    ("ohm", "Ohm"),
    ("farad", "F"),
    ("ampere", "A"),
    ("metre", "m"),
    ("kilogram", "kg"),
    ("gram", "g"),
    ("kelvin", "K"),
    ("hertz", "Hz"),
];

/// A D-SI unit such as `\milli\volt\per\newton` as this program writes it, `mV*N^-1`; a text
/// without a backslash as it is; none for a unit that is not in the tables.
fn unit(text: &str) -> Option<String> {
    let text = text.trim();
    if !text.contains('\\') {
        return Some(text.to_owned());
    }
    let symbol = |table: &[(&str, &'static str)], word: &str| {
        table.iter().find(|(name, _)| *name == word).map(|(_, symbol)| *symbol)
    };
    let mut factors: Vec<(String, i32)> = Vec::new();
    let (mut prefix, mut sign) = ("", 1);
    for word in text.split('\\').skip(1).map(str::trim) {
        if word == "per" {
            sign = -1;
        } else if let Some(power) = word.strip_prefix("tothe") {
            let power: i32 = power.strip_prefix('{')?.strip_suffix('}')?.trim().parse().ok()?;
            factors.last_mut()?.1 *= power;
        } else if let Some(found) = symbol(&PREFIXES, word) {
            prefix = found;
        } else {
            factors.push((format!("{prefix}{}", symbol(&UNITS, word)?), sign));
            (prefix, sign) = ("", 1);
        }
    }
    let factors: Vec<String> =
        factors.iter().map(|(symbol, power)| format!("{symbol}^{power}")).collect();
    Some(factors.join("*"))
}

/// First child `name` of `node`.
fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|child| child.is_element() && child.tag_name().name() == name)
}

/// Value of a `si:real` if it is of `dimension` (unit).
fn value(real: Node<'_, '_>, dimension: Dimension) -> Option<f64> {
    let text = |name| real.children().find(|c| c.tag_name().name() == name)?.text();
    parse(&format!("{} {}", text("value")?.trim(), unit(text("unit")?)?), dimension).ok()
}

/// Expanded uncertainty over the coverage factor of a `si:real`, by D-SI 2.2 or by the older
/// `expandedUnc`, in the unit of its value.
fn standard_uncertainty(real: Node<'_, '_>) -> Option<f64> {
    let number = |node: Node<'_, '_>, name: &str| -> Option<f64> {
        node.children().find(|c| c.tag_name().name() == name)?.text()?.trim().parse().ok()
    };
    let find = |name| real.descendants().find(|node| node.tag_name().name() == name);
    let (expanded, factor) = match (find("expandedMU"), find("expandedUnc")) {
        (Some(node), _) => (number(node, "valueExpandedMU")?, number(node, "coverageFactor")?),
        (None, Some(node)) => (number(node, "uncertainty")?, number(node, "coverageFactor")?),
        (None, None) => return None,
    };
    Some(expanded / factor).filter(|u| u.is_finite() && *u >= 0.0)
}

/// A quantity of `dimension` with the standard uncertainty `U/k`.
fn quantity(real: Node<'_, '_>, dimension: Dimension) -> Option<Uncertain> {
    let of_value = value(real, dimension)?;
    let typed: f64 =
        real.children().find(|c| c.tag_name().name() == "value")?.text()?.trim().parse().ok()?;
    Some(Uncertain::normal(of_value, standard_uncertainty(real)? * (of_value / typed).abs()))
}

/// Whether `node`, or an element around it, has `kind` among its `refType`s.
fn is_kind(node: Node<'_, '_>, kind: &str) -> bool {
    let kinds = |node: Node<'_, '_>| node.attribute("refType").map(str::to_owned);
    node.ancestors().filter_map(kinds).any(|all| all.split_whitespace().any(|one| one == kind))
}

/// A certificate that was read.
struct Certificate<'a> {
    document: &'a Document<'a>,
}

impl<'a> Certificate<'a> {
    fn root(&self) -> Node<'a, 'a> {
        self.document.root_element()
    }

    /// Says that `found` is at the start of `node` instead of `expected`.
    fn unusable(&self, node: Node<'_, '_>, found: String, expected: &'static str) -> Unusable {
        let place = self.document.text_pos_at(node.range().start);
        Unusable { line: place.row as usize, column: place.col as usize, found, expected }
    }

    /// All real numbers with a unit among the results.
    fn reals(&self) -> impl Iterator<Item = Node<'a, 'a>> {
        let is_result =
            |node: &Node<'_, '_>| node.has_tag_name((DCC_NAMESPACE, "measurementResults"));
        let results = self.root().children().filter(is_result);
        let is_real = |node: &Node<'_, '_>| node.has_tag_name((SI_NAMESPACE, "real"));
        results.flat_map(move |node| node.descendants().filter(is_real))
    }

    /// The quantities of `dimension` with an expanded uncertainty; if some are of `kind`, those.
    fn quantities(&self, dimension: Dimension, kind: &str) -> Vec<(Node<'a, 'a>, Uncertain)> {
        let found = self.reals().filter_map(|real| Some((real, quantity(real, dimension)?)));
        let found: Vec<_> = found.collect();
        let named: Vec<_> =
            found.iter().filter(|(real, _)| is_kind(*real, kind)).copied().collect();
        if named.is_empty() { found } else { named }
    }

    /// The one sensitivity.
    fn sensitivity(&self) -> Result<(Node<'a, 'a>, Uncertain), Unusable> {
        let found = self.quantities(Dimension::VOLTAGE_PER_FORCE, SENSITIVITY);
        let [(place, sensitivity)] = found.as_slice() else {
            let of_charge =
                self.reals().any(|real| value(real, Dimension::CHARGE_PER_FORCE).is_some());
            let found = match found.len() {
                0 if of_charge => "a charge sensitivity (C/N)".to_owned(),
                0 => "no sensitivity in V/N with an expanded uncertainty".to_owned(),
                count => format!("{count} sensitivities in V/N with expanded uncertainties"),
            };
            let expected = "one in V/N; write a sensor's file with the sensitivity that is meant (hertzscope list sensors)";
            return Err(self.unusable(self.root(), found, expected));
        };
        if sensitivity.value <= 0.0 || !sensitivity.is_known() {
            let Uncertain { value, u, .. } = sensitivity;
            let found = format!("a sensitivity of {value} ± {u} V/N (k = 1)");
            let expected = "one above zero, known better than to its own size";
            return Err(self.unusable(*place, found, expected));
        }
        Ok((*place, *sensitivity))
    }

    /// Data of the condition of a `kind`.
    fn condition(&self, kind: &str) -> Option<Node<'a, 'a>> {
        let is_it = |node: &Node<'_, '_>| {
            node.has_tag_name((DCC_NAMESPACE, "influenceCondition"))
                && node.attribute("refType") == Some(kind)
        };
        child(self.root().descendants().find(is_it)?, "data")
    }

    /// The number in a condition (unit).
    fn number(&self, kind: &str, dimension: Dimension) -> Option<f64> {
        let is_real = |node: &Node<'_, '_>| node.has_tag_name((SI_NAMESPACE, "real"));
        value(self.condition(kind)?.descendants().find(is_real)?, dimension)
    }

    /// The words in a condition.
    fn words(&self, kind: &str) -> Option<String> {
        let is_content = |node: &Node<'_, '_>| node.has_tag_name((DCC_NAMESPACE, "content"));
        Some(quoted(self.condition(kind)?.descendants().find(is_content)?.text()?))
    }

    /// The conditions of use as lines of a sensor's file.
    fn conditions(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let resistance = self.number(INPUT_RESISTANCE, Dimension::RESISTANCE);
        let capacitance = self.number(INPUT_CAPACITANCE, Dimension::CAPACITANCE);
        if let Some((resistance, capacitance)) = resistance.zip(capacitance) {
            lines.push(format!("input_resistance = \"{resistance} Ohm\""));
            lines.push(format!("input_capacitance = \"{capacitance} F\""));
        }
        let chain = self.words(CHANNEL).zip(self.number(RANGE, Dimension::VOLTAGE));
        if let Some((channel, range)) = chain {
            let range = format!("range = \"{range} V/div\"");
            lines.push(format!("in_chain = true\nchannel = \"{channel}\"\n{range}"));
        }
        lines.extend(self.words(HOST).map(|host| format!("calibrated_host = \"{host}\"")));
        let core =
            child(self.root(), "administrativeData").and_then(|node| child(node, "coreData"));
        let number = core.and_then(|core| child(core, "uniqueIdentifier")?.text());
        lines.extend(number.map(|number| format!("certificate = \"{}\"", quoted(number))));
        lines
    }
}

/// The certificate `xml` as the text of a sensor's file.
///
/// # Errors
/// [`Unusable`]: no XML, no certificate, or no single sensitivity with its uncertainty and a time
/// constant.
pub fn sensor_text(xml: &str) -> Result<String, Unusable> {
    let document = Document::parse(xml).map_err(|error| {
        let place = error.pos();
        let (line, column) = (place.row as usize, place.col as usize);
        Unusable { line, column, found: error.to_string(), expected: "XML" }
    })?;
    let certificate = Certificate { document: &document };
    let root = certificate.root();
    if !root.has_tag_name((DCC_NAMESPACE, "digitalCalibrationCertificate")) {
        let found = format!("an element {}", root.tag_name().name());
        let expected = "a digital calibration certificate by https://ptb.de/dcc";
        return Err(certificate.unusable(root, found, expected));
    }
    let (place, sensitivity) = certificate.sensitivity()?;
    let relative = |quantity: &Uncertain| quantity.u / quantity.value;
    let sensitivity_lines = format!(
        "sensitivity = \"{} V/N\"\nsensitivity_u = {:e}\n",
        sensitivity.value,
        relative(&sensitivity)
    );
    let times = certificate.quantities(Dimension::TIME, TIME_CONSTANT);
    let [(_, tau)] = times.as_slice() else {
        let found = format!(
            "{} time constants beside {}",
            times.len(),
            sensitivity_lines.trim().replace('\n', ", ")
        );
        let expected =
            "one in s with an expanded uncertainty; write these two into a sensor's file, and tau";
        return Err(certificate.unusable(place, found, expected));
    };
    let tau = format!("tau = \"{} s\"\ntau_u = {:e}\n", tau.value, relative(tau));
    Ok(sensitivity_lines + &tau + &certificate.conditions().join("\n") + "\n")
}

/// Text between the quotes of TOML.
fn quoted(text: &str) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    text.replace(['"', '\\'], "'").replace(char::is_control, " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Units as the D-SI guide writes them (D-SI 2.0, section 3).
    #[test]
    fn units_of_the_dsi_are_read() {
        for (text, dimension, si) in [
            (r"\volt\newton\tothe{-1}", Dimension::VOLTAGE_PER_FORCE, 1.0),
            (r"\milli\volt\per\newton", Dimension::VOLTAGE_PER_FORCE, 1e-3),
            (r"\micro\second", Dimension::TIME, 1e-6),
            (r"\mega\ohm", Dimension::RESISTANCE, 1e6),
            (r"\metre\second\tothe{-2}", Dimension::ACCELERATION, 1.0),
            (r"\pico\coulomb\per\newton", Dimension::CHARGE_PER_FORCE, 1e-12),
            ("mV/N", Dimension::VOLTAGE_PER_FORCE, 1e-3),
        ] {
            let unit = unit(text).expect(text);
            assert_eq!(parse(&format!("1 {unit}"), dimension), Ok(si), "{text}: {unit}");
        }
        assert_eq!(unit(r"\furlong"), None);
        assert_eq!(unit(r"\volt\tothe{x}"), None);
    }

    #[test]
    fn what_is_no_certificate_is_named_with_its_place() {
        let found = |text: &str| sensor_text(text).expect_err(text);
        assert_eq!(found("<a>").line, 1);
        assert!(found("\n<a/>").found.contains("an element a"));
        let empty = "<d:digitalCalibrationCertificate xmlns:d=\"https://ptb.de/dcc\"/>";
        assert!(found(empty).found.contains("no sensitivity in V/N"));
    }
}
