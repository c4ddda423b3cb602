//! Wrong addresses, and what is no scope.

use std::process::Command;

fn refused(arguments: &[&str]) -> String {
    let mut hertzscope = Command::new(env!("CARGO_BIN_EXE_hertzscope"));
    let output = hertzscope.args(arguments).output().expect("a program");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    String::from_utf8(output.stderr).expect("text")
}

#[test]
fn wrong_addresses_say_what_to_type() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("day.mcap");
    let file = file.to_str().expect("a path");
    for (address, words) in [
        ("tcp://scope", "names no host with a port: type e.g. tcp://127.0.0.1:5025"),
        ("magnet-0.61g", "names no host with a port"),
        ("serial:/dev/nowhere", "No such file or directory"),
        ("serial:/dev/null", "cannot be opened"),
        ("/dev/usbtmc_nowhere", "no such device file"),
        ("USB0::0xFFFF::0x0001::INSTR", "no such instrument on USB"),
        ("USB0::tek::INSTR", "names no maker and model: type e.g. /dev/usbtmc0"),
    ] {
        let told = refused(&["acquire", address, "-o", file]);
        assert!(told.contains(words), "{told}");
    }
    assert!(refused(&["acquire", "tcp://127.0.0.1:1", "-o", "day.csv"]).contains(".mcap"));
    assert!(refused(&["compare", "tcp://scope", "magnet-0.61g"]).contains("type e.g. tcp://"));
    let told = refused(&["compare", "tcp://127.0.0.1:1", "magnet-0.61g"]);
    assert!(told.contains("cannot be opened: Connection refused"), "{told}");
    assert!(!std::path::Path::new(file).exists());
}
