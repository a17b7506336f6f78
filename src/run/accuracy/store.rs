//! The points of a report as rows of a CSV file, each written as soon as it is measured, so that a
//! report that was interrupted goes on where it was.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// One method on one scene. Lengths are in metres.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Row {
    /// Hash of the program's version, the scene and the solver's settings: another one is another
    /// point.
    pub key: String,
    pub scene: String,
    pub method: String,
    pub family: String,
    pub substep_s: f64,
    /// Collide and relax on the cpu engine: median of the sub-steps in which a body was near grass.
    pub ms_per_substep: f64,
    /// The same over the length of a sub-step, in milliseconds per simulated second.
    pub ms_per_s: f64,
    /// Pose errors to the reference over touched plants; `None` if not finite.
    pub rms_m: Option<f64>,
    pub p95_m: Option<f64>,
    /// The same over the plants' lengths.
    pub rms_lengths: Option<f64>,
    pub p95_lengths: Option<f64>,
    pub imprint_iou: Option<f64>,
    pub side_flips: u64,
    pub touched_plants: u64,
    pub penetration_max_m: f64,
    pub penetration_p999_m: f64,
    pub penetration_rms_m: f64,
    /// Deepest middle of a segment whose ends are outside.
    pub penetration_middle_m: f64,
    /// Deepest node over what its collider promises: one texel, or 1 mm for a closed form.
    pub penetration_over_limit: f64,
    pub over_push_m: f64,
    pub strain: f64,
    /// Plants and frames with a value that is not finite.
    pub not_finite: u64,
    /// gpu − cpu; `None` without an adapter, or if its passes do not know the method.
    pub rounding_rms_m: Option<f64>,
    /// cpu in `f32` − the same in `f64`.
    pub precision_rms_m: Option<f64>,
    /// The same in `f64` − reference.
    pub method_rms_m: Option<f64>,
}

/// Columns in the order they are written, which are the keys of [`Row`].
const COLUMNS: [&str; 25] = [
    "key",
    "scene",
    "method",
    "family",
    "substep_s",
    "ms_per_substep",
    "ms_per_s",
    "rms_m",
    "p95_m",
    "rms_lengths",
    "p95_lengths",
    "imprint_iou",
    "side_flips",
    "touched_plants",
    "penetration_max_m",
    "penetration_p999_m",
    "penetration_rms_m",
    "penetration_middle_m",
    "penetration_over_limit",
    "over_push_m",
    "strain",
    "not_finite",
    "rounding_rms_m",
    "precision_rms_m",
    "method_rms_m",
];
/// How many of them are texts; the others are numbers.
const TEXTS: usize = 4;

impl Row {
    /// The row as a line without its end.
    fn line(&self) -> Result<String, serde_json::Error> {
        let value = serde_json::to_value(self)?;
        let field = |column: &&str| match &value[*column] {
            Value::Null => String::new(),
            Value::String(text) => text.replace([',', '\n', '\r'], "_"),
            number => number.to_string(),
        };
        let fields: Vec<String> = COLUMNS.iter().map(field).collect();
        Ok(fields.join(","))
    }

    /// Reads a line; `None` if it is not a whole row, as the last one of a report that was killed.
    fn parse(line: &str) -> Option<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        if fields.len() != COLUMNS.len() {
            return None;
        }
        let mut row = Map::new();
        for (n, (&column, &text)) in COLUMNS.iter().zip(&fields).enumerate() {
            let value = if n < TEXTS {
                Value::from(text)
            } else if text.is_empty() {
                Value::Null
            } else if let Ok(whole) = text.parse::<u64>() {
                Value::from(whole)
            } else {
                Value::from(text.parse::<f64>().ok()?)
            };
            row.insert(column.to_owned(), value);
        }
        serde_json::from_value(Value::Object(row)).ok()
    }
}

/// Rows by key, and the file they are kept in, if any.
#[derive(Debug, Default)]
pub struct Store {
    file: Option<File>,
    rows: BTreeMap<String, Row>,
    /// Lines of the file that are no rows, which are measured again.
    pub broken_lines: usize,
}

impl Store {
    /// Rows in memory alone.
    pub fn in_memory() -> Self {
        Self::default()
    }

    /// Opens a file of rows. With `resume` the rows it has are kept, else it starts empty.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or written.
    pub fn open(path: &Path, resume: bool) -> io::Result<Self> {
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)?;
        let mut text = String::new();
        if resume {
            file.read_to_string(&mut text)?;
        }
        // A line without an end may have lost digits of its last number.
        let (whole, cut) = text.split_at(text.rfind('\n').map_or(0, |at| at + 1));
        let lines: Vec<&str> = whole.lines().filter(|line| *line != header()).collect();
        let rows: Vec<Row> = lines.iter().filter_map(|line| Row::parse(line)).collect();
        let mut store = Self {
            broken_lines: lines.len() - rows.len() + usize::from(!cut.is_empty()),
            rows: BTreeMap::new(),
            file: Some(file),
        };
        store.restart()?;
        for row in rows {
            store.add(row)?;
        }
        Ok(store)
    }

    fn restart(&mut self) -> io::Result<()> {
        if let Some(file) = &mut self.file {
            file.set_len(0)?;
            file.seek(SeekFrom::Start(0))?;
            writeln!(file, "{}", header())?;
        }
        Ok(())
    }

    /// Adds a row, and writes it at once.
    ///
    /// # Errors
    ///
    /// The file's.
    pub fn add(&mut self, row: Row) -> io::Result<()> {
        if let Some(file) = &mut self.file {
            let line = row.line().map_err(io::Error::other)?;
            file.write_all(format!("{line}\n").as_bytes())?;
        }
        self.rows.insert(row.key.clone(), row);
        Ok(())
    }

    pub fn get(&self, key: &str) -> Option<&Row> {
        self.rows.get(key)
    }
}

fn header() -> String {
    COLUMNS.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(key: &str) -> Row {
        Row {
            key: key.into(),
            scene: "roll".into(),
            method: "sweep-1/8".into(),
            family: "sweeps".into(),
            substep_s: 1.0 / 120.0,
            ms_per_substep: 0.1 + 0.2,
            rms_m: Some(1e-17),
            side_flips: 3,
            ..Row::default()
        }
    }

    #[test]
    fn the_columns_are_the_keys_of_a_row() {
        let value = serde_json::to_value(Row::default()).expect("a plain struct");
        let mut keys: Vec<_> = value.as_object().expect("an object").keys().collect();
        let mut columns: Vec<_> = COLUMNS.iter().collect();
        keys.sort();
        columns.sort();
        assert_eq!(
            keys.iter().map(|k| k.as_str()).collect::<Vec<_>>(),
            columns.iter().map(|c| **c).collect::<Vec<_>>()
        );
    }

    #[test]
    fn a_line_gives_the_same_row_and_half_a_line_none() {
        let line = row("a").line().expect("a plain struct");
        assert_eq!(Row::parse(&line), Some(row("a")));
        assert_eq!(Row::parse(&line[..line.len() / 2]), None);
    }

    #[test]
    fn a_killed_report_keeps_its_whole_rows() {
        let folder = std::env::temp_dir().join(format!("sward-store-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a writable temporary folder");
        let path = folder.join("points.csv");
        let mut store = Store::open(&path, false).expect("a writable file");
        store.add(row("a")).expect("a writable file");
        store.add(row("b")).expect("a writable file");
        drop(store);
        let text = std::fs::read_to_string(&path).expect("the file");
        // Cut within the row, and before its end of line alone.
        for cut in [9, 1] {
            std::fs::write(&path, &text[..text.len() - cut]).expect("a writable file");
            let store = Store::open(&path, true).expect("the file");
            assert_eq!(store.get("a"), Some(&row("a")));
            assert_eq!((store.get("b"), store.broken_lines), (None, 1));
        }
        let fresh = Store::open(&path, false).expect("the file");
        assert_eq!(fresh.get("a"), None);
        std::fs::remove_dir_all(&folder).expect("the test's own folder");
    }
}
