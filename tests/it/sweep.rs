//! Sweeps: what they run, that nothing is lost and nothing counted twice, and that the bytes are
//! the same whoever does the work.

mod design;
mod documented;
mod interrupted;
mod physics;
mod refused;
mod same_bytes;
mod tables;

use std::path::Path;

use assert_cmd::Command;

/// Forty runs that are quick: the striker has hardly left the first particle when they end.
const QUICK: &str = r#"
scene = "magnet-0.61g"
accuracy = 1e-2
watch = ["p2"]

[grid]
duration = "0.1 ms"
striker.speed = { from = "0.2 m/s", to = "0.6 m/s", count = 10 }
particles.ptfe_sphere.mass = ["0.1226 g", "0.13 g"]

[random]
count = 2

[random.over]
effects.magnet_preload.force = { from = "1 N", to = "10 N", spacing = "logarithmic" }
"#;

/// A folder with `text` as `grid.toml`.
fn folder(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("grid.toml"), text).expect("a sweep's file");
    folder
}

/// The program in `folder`, outside any Slurm job.
fn program(folder: &Path) -> std::process::Command {
    let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_hertzscope"));
    program.current_dir(folder);
    for name in ["ID", "MIN", "MAX", "COUNT"] {
        program.env_remove(format!("SLURM_ARRAY_TASK_{name}"));
    }
    program
}

/// Runs the program; its exit code, standard output and standard error.
fn told(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut program = Command::from_std(program(folder));
    let output = program.args(arguments).output().expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text in UTF-8");
    (output.status.code().expect("an exit code"), text(output.stdout), text(output.stderr))
}

/// What the program prints when all goes well.
fn done(folder: &Path, arguments: &[&str]) -> String {
    let (code, stdout, stderr) = told(folder, arguments);
    assert_eq!(code, 0, "{arguments:?}: {stderr}");
    stdout
}

fn read(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file)).expect("a file")
}

/// The column called `name` of a table without texts in quotes.
fn column(csv: &str, name: &str) -> Vec<String> {
    let mut lines = csv.lines();
    let mut heads = lines.next().expect("a heading").split(',');
    let place = heads.position(|head| head == name).expect(name);
    lines.map(|line| line.split(',').nth(place).expect("a cell").to_owned()).collect()
}

fn numbers(csv: &str, name: &str) -> Vec<f64> {
    column(csv, name).iter().map(|cell| cell.parse().expect("a number")).collect()
}
