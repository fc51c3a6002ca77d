//! A test of sensitivity to the supply, done in a fraction of a second: for what is asked of the program rather than of a
//! result.

use super::shared::shared_input;
use super::{Said, sagnac, shipped};
use std::path::Path;

/// Limits on what the test measures.
const LIMITS: &str = "format = \"limits/1\"\n[limits]\nid = \"quick\"\ntitle = \"Quick\"\nrevision = \"A\"\n\
    [[limit]]\nmeasurand = \"supply_sensitivity\"\nmax_abs = \"0.2 deg/h/V\"\n";

/// The files of the test, by their paths.
pub struct Quick {
    pub procedure: String,
    pub recording: String,
    pub limits: String,
}

impl Quick {
    /// The unit that passes or the one that fails, as `pass` or `fail`; their recordings state no serial number.
    pub fn new(end: &str) -> Quick {
        Quick {
            procedure: shipped("procedures/supply-sensitivity.toml"),
            recording: shared_input(&format!("supply-{end}.csv"), || recording(end)),
            limits: shared_input("supply-limits.toml", || LIMITS.to_owned()),
        }
    }

    /// The command line of unit SN-1, without its `--out`.
    pub fn args(&self) -> [&str; 7] {
        ["run", &self.procedure, &self.recording, "--limits", &self.limits, "--serial", "SN-1"]
    }

    /// Runs it in a folder.
    pub fn run(&self, folder: &Path, more: &[&str]) -> Said {
        sagnac(folder, &[&self.args()[..], more].concat())
    }
}

/// The text of a sample without its line that states the serial number.
pub fn recording(end: &str) -> String {
    let path = shipped(&format!("samples/supply-sensitivity-{end}.csv"));
    let text = std::fs::read_to_string(path).unwrap();
    let (stated, rest) = text.split_once('\n').unwrap();
    assert!(stated.starts_with("# serial: "), "{stated}");
    rest.to_owned()
}
