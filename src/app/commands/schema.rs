//! `sward schema`.

use std::io::Write;

use crate::app::Failure;
use crate::run::Exit;
use crate::scene::json_schema;

/// Prints the JSON schema of a scene.
pub fn run(out: &mut impl Write) -> Result<Exit, Failure> {
    serde_json::to_writer_pretty(&mut *out, &json_schema())?;
    writeln!(out)?;
    Ok(Exit::Ok)
}
