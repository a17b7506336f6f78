//! What a bench ran on, as far as the system tells.

use std::fs;

use serde::Serialize;

/// The computer and how busy it was.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Model of the processor; null where the system does not say.
    pub cpu: Option<String>,
    /// Threads that can run at once.
    pub threads: usize,
    /// Processes that wanted to run, on average over the minute before the bench. Well above 0,
    /// times are not to be trusted.
    pub load_average: Option<f64>,
}

impl Machine {
    /// The machine as it is now.
    pub fn now() -> Self {
        Self {
            cpu: value_of("/proc/cpuinfo", "model name"),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            load_average: fs::read_to_string("/proc/loadavg")
                .ok()
                .and_then(|text| text.split_whitespace().next()?.parse().ok()),
        }
    }
}

/// Largest memory this process has used at once, in bytes; `None` where the system does not say.
pub fn peak_memory_bytes() -> Option<u64> {
    let kib: u64 = value_of("/proc/self/status", "VmHWM")?
        .strip_suffix("kB")?
        .trim()
        .parse()
        .ok()?;
    Some(kib * 1024)
}

/// The first value of a key in a file of `key : value` lines.
fn value_of(file: &str, key: &str) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let value = text.lines().find_map(|line| {
        let (name, value) = line.split_once(':')?;
        (name.trim() == key).then(|| value.trim().to_owned())
    });
    value.filter(|value| !value.is_empty())
}
