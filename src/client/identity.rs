//! Who answers to `*IDN?`.

use crate::quantity::printable_line;
use crate::recording::InstrumentIdentity;

/// Longest part of a foreign reply to `*IDN?` that a message quotes (characters).
const MAX_QUOTED_IDENTITY: usize = 80;

/// Reads the reply to `*IDN?`, e.g. `TEKTRONIX,TDS 2014,0,CF:91.1CT FV:v4.12 TDS2CM:CMV:v1.04`.
///
/// # Errors
/// A message for the user: no oscilloscope of this family.
pub fn identity(reply: &str) -> Result<InstrumentIdentity, String> {
    let reply = printable_line(reply);
    let mut fields = reply.split(',');
    let (maker, model) = (fields.next().unwrap_or_default(), fields.next().unwrap_or_default());
    let model = model.replace(' ', "");
    let is_family = ["TDS", "TPS", "TBS"].iter().any(|family| model.starts_with(family));
    if maker != "TEKTRONIX" || !is_family {
        let start: String = reply.chars().take(MAX_QUOTED_IDENTITY).collect();
        return Err(format!(
            "found {start}, expected a Tektronix oscilloscope of the TDS2000 family"
        ));
    }
    let serial = fields.next().unwrap_or_default().to_owned();
    let firmware =
        fields.next().and_then(|rest| rest.split(' ').find(|word| word.starts_with("FV:")));
    Ok(InstrumentIdentity { model, serial, firmware: firmware.unwrap_or_default().to_owned() })
}
