//! Every input of the fuzz targets' corpora through the targets themselves: what fuzzing has found
//! stays found, and the targets follow the program.

use std::path::Path;

#[path = "../../fuzz/targets/arguments.rs"]
mod arguments;
#[path = "../../fuzz/targets/csv.rs"]
mod csv;
#[path = "../../fuzz/desk.rs"]
mod desk;
#[path = "../../fuzz/targets/hislip.rs"]
mod hislip;
#[path = "../../fuzz/targets/isf.rs"]
mod isf;
#[path = "../../fuzz/targets/mcap.rs"]
mod mcap;
#[path = "../../fuzz/network.rs"]
pub mod network;
#[path = "../../fuzz/targets/reply.rs"]
mod reply;
#[path = "../../fuzz/targets/scpi.rs"]
mod scpi;
#[path = "../../fuzz/targets/set.rs"]
mod set;
#[path = "../../fuzz/targets/settings.rs"]
mod settings;
#[path = "../../fuzz/targets/vxi11.rs"]
mod vxi11;

/// The inputs of a target's corpus, each told by its name if the target fails on it.
fn replay(target: &str, run: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut inputs = 0;
    for entry in std::fs::read_dir(&folder).expect("a corpus") {
        let file = entry.expect("an entry").path();
        let bytes = std::fs::read(&file).expect("an input");
        let done = std::panic::catch_unwind(|| run(&bytes));
        assert!(done.is_ok(), "{}", file.display());
        inputs += 1;
    }
    assert!(inputs > 10, "{target}: {inputs} inputs");
}

#[test]
fn command_lines() {
    replay("arguments", arguments::run);
}

#[test]
fn scenes_plans_laboratories_and_sweeps() {
    replay("settings", settings::run);
}

#[test]
fn replies_of_a_scope() {
    replay("reply", reply::run);
}

#[test]
fn csv_files() {
    replay("csv", csv::run);
}

#[test]
fn hislip_connections() {
    replay("hislip", hislip::run);
}

#[test]
fn isf_files() {
    replay("isf", isf::run);
}

#[test]
fn recordings() {
    replay("mcap", mcap::run);
}

#[test]
fn commands() {
    replay("scpi", scpi::run);
}

#[test]
fn set_up_files() {
    replay("set", set::run);
}

#[test]
fn vxi11_connections() {
    replay("vxi11", vxi11::run);
}

/// The same with bytes changed, left out and joined: what fuzzing does, shorter.
#[test]
fn vxi11_connections_with_changed_bytes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/vxi11");
    let mut files: Vec<_> = std::fs::read_dir(folder).expect("a corpus").flatten().collect();
    files.sort_by_key(std::fs::DirEntry::path);
    let inputs: Vec<Vec<u8>> =
        files.iter().map(|file| std::fs::read(file.path()).expect("an input")).collect();
    let mut state = 1_u64;
    let mut draw = |below: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).expect("31 bits") % below
    };
    for _ in 0..3000 {
        let mut input = inputs[draw(inputs.len())].clone();
        let other = &inputs[draw(inputs.len())];
        input.truncate(input.len() - draw(input.len() / 2));
        input.extend_from_slice(&other[draw(other.len())..]);
        for _ in 0..draw(6) {
            let place = draw(input.len());
            input[place] = [0, 1, 8, 16, 128, 255, 10, draw(256) as u8][draw(8)];
        }
        vxi11::run(&input);
    }
}

/// Every target has its replay.
#[test]
fn no_target_is_left_out() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/targets");
    let names = std::fs::read_dir(folder).expect("targets").map(|entry| {
        entry.expect("an entry").path().file_stem().expect("a name").to_string_lossy().into_owned()
    });
    let mut names: Vec<String> = names.collect();
    names.sort();
    assert_eq!(
        names,
        ["arguments", "csv", "hislip", "isf", "mcap", "reply", "scpi", "set", "settings", "vxi11"]
    );
}
