//! The `hertzscope` command: everything is in the library, this only hands over.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(hertzscope::cli::main(std::env::args_os()))
}
