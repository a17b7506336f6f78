//! The `sward` program; everything is in the library.

fn main() -> std::process::ExitCode {
    sward::app::main()
}
