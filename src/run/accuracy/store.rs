//! The points of a report as rows of a CSV file, each written as soon as it is measured, so that a
//! report that was interrupted goes on where it was.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::Plan;

/// One method on one scene. Lengths are in metres.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(default)]
pub struct Row {
    /// Hash of the program, the scene, the solver's settings and the graphics device: another one is
    /// another point.
    pub key: String,
    /// Version and hash of the program that measured it.
    pub program: String,
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
    /// Why the device could not run the scene to its end; empty if it could, or was not asked.
    pub rounding_refused: String,
}

/// Columns in the order they are written, which are the keys of [`Row`].
const COLUMNS: [&str; 29] = [
    "key",
    "program",
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
    "rounding_refused",
];
/// Those of them that are texts; the others are numbers.
const TEXTS: [&str; 6] = [
    "key",
    "program",
    "scene",
    "method",
    "family",
    "rounding_refused",
];
/// Those without which a line tells nothing: every version of the file has them.
const NEEDED: [&str; 3] = ["key", "scene", "method"];

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

    /// Reads a line under these column names; `None` if it is not a whole row, as the last one of a
    /// report that was killed. Columns that a file of another version lacks are empty.
    fn parse(line: &str, columns: &[&str]) -> Option<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        if fields.len() != columns.len() {
            return None;
        }
        let mut row = Map::new();
        for (&column, &text) in columns.iter().zip(&fields) {
            let value = if TEXTS.contains(&column) {
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
#[derive(Clone, Debug, Default)]
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
    /// A file that cannot be read; one of something else (`InvalidData`).
    pub fn read(path: &Path) -> io::Result<Self> {
        let text = match fs::read_to_string(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            read => read?,
        };
        // A line without an end may have lost digits of its last number.
        let (whole, cut) = text.split_at(text.rfind('\n').map_or(0, |at| at + 1));
        let mut lines = whole.lines();
        let columns: Vec<&str> = lines
            .next()
            .map_or_else(Vec::new, |l| l.split(',').collect());
        let is_of_points = NEEDED.iter().all(|needed| columns.contains(needed));
        if !text.is_empty() && !is_of_points {
            let text = "it has other columns than a report's points";
            return Err(io::Error::new(io::ErrorKind::InvalidData, text));
        }
        let lines: Vec<&str> = lines.collect();
        let rows = lines.iter().filter_map(|line| Row::parse(line, &columns));
        let rows: Vec<Row> = rows.collect();
        Ok(Self {
            broken_lines: lines.len() - rows.len() + usize::from(!cut.is_empty()),
            rows,
        })
    }

    /// Scenes with the methods that a plan leaves out: a report of that plan would lose them. The noise
    /// floor of a scene that is left out counts as one of its methods.
    pub fn left_out_by(&self, plan: &Plan) -> BTreeMap<String, BTreeSet<String>> {
        let mut left_out: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for row in self.rows.iter().filter(|row| !plan.asks_for(row)) {
            let methods = left_out.entry(row.scene.clone()).or_default();
            methods.insert(row.method.clone());
        }
        left_out
    }

    /// Keeps the rows of these keys, and tells what the others were.
    pub fn keep(&mut self, keys: &BTreeSet<String>, program: &str) -> Dropped {
        let (kept, others): (Vec<Row>, Vec<Row>) = std::mem::take(&mut self.rows)
            .into_iter()
            .partition(|row| keys.contains(&row.key));
        self.rows = kept;
        let mut dropped = Dropped::default();
        for row in others {
            if row.program == program {
                dropped.of_other_input += 1;
            } else {
                *dropped.of_programs.entry(row.program).or_default() += 1;
            }
        }
        dropped
    }
}

/// Rows that no longer hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dropped {
    /// Rows by the program that measured them, where that is another one; the empty name is of a
    /// version that did not tell.
    pub of_programs: BTreeMap<String, usize>,
    /// Rows of this program, with another scene, setting or graphics device.
    pub of_other_input: usize,
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
            program: "0.1.0+1".into(),
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
        assert_eq!(Row::parse(&line, &COLUMNS), Some(row("a")));
        assert_eq!(Row::parse(&line[..line.len() / 2], &COLUMNS), None);
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
        assert_eq!(left_out["roll"], BTreeSet::from(["sweep-1/8".to_owned()]));
        let keys = BTreeSet::from(["b".to_owned()]);
        let dropped = stored.clone().keep(&keys, "0.1.0+2");
        assert_eq!(dropped.of_programs["0.1.0+1"], 1);
        assert_eq!(stored.keep(&keys, "0.1.0+1").of_other_input, 1);
        let store = Store::create(&path, stored).expect("the file");
        assert_eq!((store.get("a"), store.get("b")), (None, Some(&row("b"))));
        assert!(Stored::read(&path.with_extension("none")).is_ok());
        removed(&path);
    }

    #[test]
    fn files_of_other_versions_are_read_and_files_of_other_things_are_not() {
        let path = file("columns");
        let older = "key,scene,method,ms_per_s\nc,roll,default,1.5\n";
        fs::write(&path, older).expect("a writable file");
        let stored = Stored::read(&path).expect("the file");
        assert!(stored.left_out_by(&Plan::default())["roll"].contains("default"));
        for other in ["x,y\n1,2\n", "no end"] {
            fs::write(&path, other).expect("a writable file");
            let refused = Stored::read(&path).expect_err("no points");
            assert_eq!(refused.kind(), io::ErrorKind::InvalidData);
        }
        removed(&path);
    }
}
