//! The points of a report as rows of a CSV file, each written as soon as it is measured, so that a
//! report that was interrupted goes on where it was.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{FLOOR, Plan};

/// One method on one scene. Lengths are in metres.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Row {
    /// Hash of the program, the scene, the solver's settings and the graphics device: another one is
    /// another point.
    pub key: String,
    pub scene: String,
    pub method: String,
    pub family: String,
    pub substep_s: f64,
    /// Time of collide and relax on the cpu engine over that of the default in the same frames, and
    /// the range it is known to; `None` where no body was near grass.
    pub times_default: Option<f64>,
    pub times_default_low: Option<f64>,
    pub times_default_high: Option<f64>,
    /// What the default took beside it, in milliseconds per simulated second.
    pub default_ms_per_s: f64,
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
const COLUMNS: [&str; 27] = [
    "key",
    "scene",
    "method",
    "family",
    "substep_s",
    "times_default",
    "times_default_low",
    "times_default_high",
    "default_ms_per_s",
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

/// What a file of rows holds, before it is opened for writing.
#[derive(Debug, Default)]
pub struct Stored {
    rows: Vec<Row>,
    /// Lines that are no rows, which are measured again.
    pub broken_lines: usize,
}

impl Stored {
    /// Reads a file of rows; one that is not there yet has none.
    ///
    /// # Errors
    ///
    /// A file that cannot be read.
    pub fn read(path: &Path) -> io::Result<Self> {
        let text = match fs::read_to_string(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            read => read?,
        };
        // A line without an end may have lost digits of its last number.
        let (whole, cut) = text.split_at(text.rfind('\n').map_or(0, |at| at + 1));
        let lines: Vec<&str> = whole.lines().filter(|line| *line != header()).collect();
        let rows: Vec<Row> = lines.iter().filter_map(|line| Row::parse(line)).collect();
        Ok(Self {
            broken_lines: lines.len() - rows.len() + usize::from(!cut.is_empty()),
            rows,
        })
    }

    /// Scenes with the methods that a plan leaves out: a report of that plan would lose them.
    pub fn left_out_by(&self, plan: &Plan) -> BTreeMap<String, Vec<String>> {
        let mut left_out: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for row in self.rows.iter().filter(|row| !plan.asks_for(row)) {
            let methods = left_out.entry(row.scene.clone()).or_default();
            if row.method != FLOOR && !methods.contains(&row.method) {
                methods.push(row.method.clone());
            }
        }
        left_out
    }

    /// Keeps the rows of these keys, and tells how many others there were.
    pub fn keep(&mut self, keys: &BTreeSet<String>) -> usize {
        let before = self.rows.len();
        self.rows.retain(|row| keys.contains(&row.key));
        before - self.rows.len()
    }
}

/// Rows by key, and the file they are kept in, if any.
#[derive(Debug, Default)]
pub struct Store {
    file: Option<File>,
    rows: BTreeMap<String, Row>,
}

impl Store {
    /// Rows in memory alone.
    pub fn in_memory() -> Self {
        Self::default()
    }

    /// Writes a file anew with the rows that were kept of it, and opens it for more.
    ///
    /// # Errors
    ///
    /// A file that cannot be written.
    pub fn create(path: &Path, kept: Stored) -> io::Result<Self> {
        let mut store = Self {
            rows: BTreeMap::new(),
            file: Some(File::create(path)?),
        };
        store.write_line(&header())?;
        for row in kept.rows {
            store.add(row)?;
        }
        Ok(store)
    }

    /// Adds a row, and writes it at once.
    ///
    /// # Errors
    ///
    /// The file's.
    pub fn add(&mut self, row: Row) -> io::Result<()> {
        self.write_line(&row.line().map_err(io::Error::other)?)?;
        self.rows.insert(row.key.clone(), row);
        Ok(())
    }

    fn write_line(&mut self, line: &str) -> io::Result<()> {
        match &mut self.file {
            Some(file) => file.write_all(format!("{line}\n").as_bytes()),
            None => Ok(()),
        }
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
            default_ms_per_s: 0.1 + 0.2,
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

    /// A file of this test's own.
    fn file(name: &str) -> std::path::PathBuf {
        let folder =
            std::env::temp_dir().join(format!("sward-store-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a writable temporary folder");
        folder.join("points.csv")
    }

    fn removed(path: &Path) {
        let folder = path.parent().expect("the test's own folder");
        fs::remove_dir_all(folder).expect("the test's own folder");
    }

    #[test]
    fn a_killed_report_keeps_its_whole_rows() {
        let path = file("killed");
        let mut store = Store::create(&path, Stored::default()).expect("a writable file");
        store.add(row("a")).expect("a writable file");
        store.add(row("b")).expect("a writable file");
        drop(store);
        let text = fs::read_to_string(&path).expect("the file");
        // Cut within the row, and before its end of line alone.
        for cut in [9, 1] {
            fs::write(&path, &text[..text.len() - cut]).expect("a writable file");
            let stored = Stored::read(&path).expect("the file");
            assert_eq!(stored.broken_lines, 1);
            let store = Store::create(&path, stored).expect("the file");
            assert_eq!(store.get("a"), Some(&row("a")));
            assert_eq!(store.get("b"), None);
        }
        removed(&path);
    }

    #[test]
    fn points_of_other_keys_go_and_points_outside_of_the_plan_are_named() {
        let path = file("keys");
        let mut store = Store::create(&path, Stored::default()).expect("a writable file");
        for key in ["a", "b"] {
            store.add(row(key)).expect("a writable file");
        }
        let mut stored = Stored::read(&path).expect("the file");
        let left_out = stored.left_out_by(&Plan::default());
        assert_eq!(left_out["roll"], ["sweep-1/8"]);
        assert_eq!(stored.keep(&BTreeSet::from(["b".to_owned()])), 1);
        let store = Store::create(&path, stored).expect("the file");
        assert_eq!((store.get("a"), store.get("b")), (None, Some(&row("b"))));
        assert!(Stored::read(&path.with_extension("none")).is_ok());
        removed(&path);
    }
}
