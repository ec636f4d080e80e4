//! The program `nephos`: see `nephos help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    nephos::cli::main()
}
