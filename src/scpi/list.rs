//! The document of all commands, from the table itself.

use std::fmt::Write as _;

use super::command::GROUPS;
use super::table::{CommandRow, Support};

/// Where the manual and what others saw differ or say nothing, and no instrument was at hand to
/// decide.
const UNDECIDED: &str = "
## What only an instrument could decide

Manual and sources leave these open or contradict each other; this is what the program does:

| Question | Here |
|---|---|
| `WFMPre?` and `WFMPre:<field>?` of a waveform that is not displayed: silence, or a reply of what does not depend on it, as a comment in qcodes suggests | no reply, events 2244 and 420, as the manual has it for `CURVe?` |
| `WFMPre:XZEro?` where `DATa:STARt` is above 1 | the time of the record's first point, not of the first that is sent |
| what `*TRG` does while `*DDT` is empty | it triggers, if the scope is ready |
| whether `*DDT?` answers as text or as a block | as text |
| `SELect:REF<x> ON` and `RECAll:WAVEform` of an empty memory | event 2244, and it stays off |
| `CURVe` with `DATa:STARt` above 1 into an empty memory | the points before it are at zero volts |
| `*ESE`, `*SRE`, `DESE` beyond 0 to 255 | event 222, and the register stays |
| what `TRIGger:MAIn:FREQuency?` counts | the period between the crossings in the record, to six digits; 9.9E37 where there are none |
| measurements of a stopped scan | over what was sampled; blank points count for nothing |
| `AUTOSet:SIGNAL?` | from the record that was on the screen: by crossings, by the share of samples near its ends, and by its root mean square |
";

/// The content of `docs/scpi-commands.md`.
pub fn markdown() -> String {
    let mut text = String::from(
        "# Remote commands\n\n\
         Made from the table in `src/scpi/command/`; `tests/it/scpi` fails when this file lags behind it\n\
         (`HERTZSCOPE_WRITE=1 cargo test --test it scpi` writes it anew).\n\n\
         Capitals are the shortest form of a word; every beginning between that and the whole word is taken. `set` and\n\
         `query` say which directions exist. A command *acts* as the manual says, is *accepted* (kept and told, without\n\
         effect on records), or is *refused* with an event; *own* commands act and are not Tektronix's: no real scope has them. Other headers have no reply and report event 113.\n",
    );
    for group in GROUPS {
        let _ = write!(
            text,
            "\n## {}\n\n| Command | Directions | Here | |\n|---|---|---|---|\n",
            group.title
        );
        for row in group.rows {
            write_row(row, &mut text);
        }
    }
    text.push_str(UNDECIDED);
    text
}

fn write_row(row: &CommandRow, text: &mut String) {
    let (directions, here, about) = match row.support {
        Support::Alias(of) => ("", "alias", format!("as `{of}`")),
        standing => {
            let directions = match (row.setting.is_command(), row.setting.is_query()) {
                (true, true) => "set, query",
                (true, false) => "set",
                _ => "query",
            };
            let here = match standing {
                Support::Implemented => "acts",
                Support::Extension => "own",
                Support::Stub => "accepted",
                _ => "refused",
            };
            (directions, here, row.about.to_owned())
        }
    };
    let _ = writeln!(text, "| `{}` | {directions} | {here} | {about} |", row.header);
}
