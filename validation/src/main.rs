//! The `touchstone` command line.

// An error on the command line is a message, not a panic.
#![deny(clippy::unwrap_used)]

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
