//! What is measured in every frame, as rows of a CSV table.

use std::io::{self, Write};

use super::scenario::Frame;

/// Writes a row per frame.
pub struct Trace<W> {
    out: W,
    /// What went wrong first; nothing is written after it.
    failed: Option<io::Error>,
}

impl<W: Write> Trace<W> {
    /// Starts a table.
    pub fn new(mut out: W) -> Self {
        let head = writeln!(
            out,
            "scenario,time_s,tick,tiles_active,state_bytes,pushed_nodes,max_penetration_m,pinched,\
             over_push_m,max_length_strain,max_offset_m"
        );
        Self {
            out,
            failed: head.err(),
        }
    }

    /// Adds the row of one frame.
    pub fn frame(&mut self, scenario: &str, frame: &Frame<'_>) {
        if self.failed.is_some() {
            return;
        }
        let (meadow, measured) = (frame.meadow, frame.snapshot);
        let deepest = measured.depths_m.iter().copied().fold(0.0, f64::max);
        let row = writeln!(
            self.out,
            "{},{:.6},{},{},{},{},{deepest:e},{},{:e},{:e},{:e}",
            quoted(scenario),
            meadow.time_s(),
            meadow.ticks,
            meadow.tiles.len(),
            meadow.state_bytes(),
            measured.pushed_nodes,
            measured.pinched,
            measured.over_push_m,
            measured.max_strain,
            measured.max_offset_m
        );
        self.failed = row.err();
    }

    /// Ends the table.
    ///
    /// # Errors
    ///
    /// The first error of the writer.
    pub fn finish(mut self) -> io::Result<()> {
        match self.failed {
            Some(error) => Err(error),
            None => self.out.flush(),
        }
    }
}

/// A CSV field (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_that_need_it_are_quoted() {
        assert_eq!(quoted("ball"), "ball");
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
    }

    #[test]
    fn the_first_error_is_kept() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::StorageFull.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let error = Trace::new(Full).finish().expect_err("nothing fits");
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    }
}
