//! A loss's coefficient for all contacts, and for some of them another one.

use std::fmt::Write as _;

use super::EndOfContact;

/// A coefficient of its own for the contacts between two kinds of bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactOverride {
    /// Names of the two bodies, in either order.
    pub between: [String; 2],
    /// The coefficient there (unit).
    pub value: f64,
}

/// A loss's coefficient contact by contact.
#[derive(Debug, Clone, PartialEq)]
pub struct LossSpec {
    /// The coefficient where nothing else is said (unit).
    pub value: f64,
    /// Where something else is said.
    pub overrides: Vec<ContactOverride>,
    /// What ends a contact; the same for all losses of a chain.
    pub end: EndOfContact,
}

impl LossSpec {
    /// The coefficient between the bodies so named (unit).
    pub fn between(&self, upper: &str, lower: &str) -> f64 {
        let own = self.overrides.iter().find(|o| {
            let [a, b] = &o.between;
            (a == upper && b == lower) || (a == lower && b == upper)
        });
        own.map_or(self.value, |own| own.value)
    }

    /// The settings in words: the coefficient called `name`, its `text`, and what ends a contact.
    pub fn summary(&self, name: &str, text: impl Fn(f64) -> String) -> String {
        let mut words = format!("{name} {}", text(self.value));
        for ContactOverride { between: [upper, lower], value } in &self.overrides {
            let _ = write!(words, ", between {upper} and {lower} {}", text(*value));
        }
        format!("{words}; a contact ends at {}", self.end.name().replace('_', " "))
    }
}
