//! The program as a child process.

use std::process::{Command, Output, Stdio};

/// Runs it to its end.
pub fn sward(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sward"))
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts")
}

pub fn code(output: &Output) -> i32 {
    output.status.code().expect("no signal ended it")
}
