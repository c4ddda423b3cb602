//! The document of all commands, from the table itself.

use std::fmt::Write as _;

use super::command::GROUPS;
use super::row::{CommandRow, Support};

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
    text
}

fn write_row(row: &CommandRow, text: &mut String) {
    let access = row.setting.access();
    let (directions, here, about) = match row.support {
        Support::Alias(of) => ("", "alias", format!("as `{of}`")),
        standing => {
            let directions = match (access.sets, access.asks) {
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
