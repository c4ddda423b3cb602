//! A transcript a group of commands, byte for byte, on the wire: `transcripts/<group>.txt`.
//!
//! A change detector: the replies were written by this server. They show what a change does to
//! them, and are no reference, except where a transcript's head names one.
//!
//! `> ` is a message that is sent, `< ` the reply to the one before, with bytes that cannot be
//! printed escaped; a message without a reply is followed by none; `# ` is a comment. Every command
//! of the table is in the transcript of its group. `HERTZSCOPE_WRITE=1` writes the replies anew:
//! compare what has changed with what is known of the instrument. The comment at the head of a
//! transcript names the replies that were compared, and with what.

use std::fmt::Write as _;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use hertzscope::scpi::command::GROUPS;
use hertzscope::scpi::message::units;
use hertzscope::scpi::table::Support;
use hertzscope::scpi::tree;

use super::{Client, IDENTITY, Server};

fn file(title: &str) -> PathBuf {
    let name = title.split(" (").next().unwrap_or(title).to_lowercase();
    let name = name.replace(": ", "-").replace(' ', "-");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/server/transcripts");
    folder.join(format!("{name}.txt"))
}

/// The bytes that answer a message. An identity query behind it tells where they end: silence has
/// no other end. Another query would interrupt a wait: its line is read first.
fn reply(client: &mut Client, message: &str) -> Vec<u8> {
    if message == "*OPC?" {
        return client.ask(message).into_bytes();
    }
    client.send(format!("{message}\n*IDN?\n").as_bytes());
    let mut bytes = Vec::new();
    for _ in 0..=usize::from(message == "*IDN?") {
        let end = loop {
            let mut byte = [0];
            client.stream.read_exact(&mut byte).expect("a reply");
            bytes.push(byte[0]);
            if bytes.ends_with(IDENTITY.as_bytes()) {
                break bytes.len() - IDENTITY.len();
            }
        };
        if message != "*IDN?" || end > 0 {
            bytes.truncate(end);
        }
    }
    bytes
}

/// The transcript as it comes out, from the messages of the one that is there.
fn transcript(typed: &str) -> String {
    let server = Server::at_rest();
    let mut client = server.connect();
    let mut written = String::new();
    for line in typed.lines().filter(|line| !line.starts_with("< ")) {
        let _ = writeln!(written, "{line}");
        let Some(message) = line.strip_prefix("> ") else { continue };
        let bytes = reply(&mut client, message);
        if let Some(reply) = bytes.strip_suffix(b"\n") {
            let _ =
                writeln!(written, "< {}", reply.escape_ascii().to_string().replace("\\\"", "\""));
        } else {
            assert_eq!(bytes, b"", "{message}");
        }
    }
    written
}

/// Headers of the rows that the messages of a transcript reach.
fn reached(typed: &str) -> Vec<(&'static str, bool)> {
    let messages = typed.lines().filter_map(|line| line.strip_prefix("> "));
    let units = messages.flat_map(|message| units(message.as_bytes())).filter_map(Result::ok);
    let found =
        units.filter_map(|unit| Some((tree::find(&unit.header, 4)?.row.header, unit.is_query)));
    found.collect()
}

#[test]
fn every_group_has_its_transcript() {
    for group in GROUPS {
        let file = file(group.title);
        let typed = std::fs::read_to_string(&file).expect("a transcript");
        let reached = reached(&typed);
        for row in group.rows.iter().filter(|row| !matches!(row.support, Support::Alias(_))) {
            let setting = row.setting;
            for (exists, is_query) in [(setting.is_command(), false), (setting.is_query(), true)] {
                let seen = reached.contains(&(row.header, is_query));
                assert!(!exists || seen, "{}: {} is missing", file.display(), row.header);
            }
        }
        let found = transcript(&typed);
        if std::env::var_os("HERTZSCOPE_WRITE").is_some() {
            std::fs::write(&file, &found).expect("the transcript is written");
            continue;
        }
        for (number, (found, expected)) in (1..).zip(found.lines().zip(typed.lines())) {
            assert_eq!(found, expected, "{}, line {number}", file.display());
        }
        assert_eq!(found.lines().count(), typed.lines().count(), "{}", file.display());
    }
}
