//! A short test of one coefficient with one figure: for what is asked of the program rather than of a result.

use super::shared::shared_input;
use super::synthetic::white;
use super::{Said, sagnac};
use std::path::Path;

const PROCEDURE: &str = "format = \"procedure/1\"\n[procedure]\nid = \"quick\"\ntitle = \"Quick\"\nrevision = \"A\"\n\
    [unit_under_test]\nserial_required = true\n\
    [[channel]]\nid = \"time\"\ncolumn = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n\
    [[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
    [conditions]\nminimum_duration = \"10 min\"\n[[measurand]]\nid = \"angle_random_walk\"\n[report]\nfigures = [\"rate\"]\n";

const LIMITS: &str = "format = \"limits/1\"\n[limits]\nid = \"quick\"\ntitle = \"Quick\"\nrevision = \"A\"\n\
    [[limit]]\nmeasurand = \"angle_random_walk\"\nmax = \"0.0025 deg/sqrt(h)\"\n";

/// The files of the test, by their paths.
pub struct Quick {
    pub procedure: String,
    pub recording: String,
    pub limits: String,
}

impl Quick {
    /// The unit that passes or the one that fails, as `pass` or `fail`; their recordings state no serial number.
    pub fn new(end: &str) -> Quick {
        // White noise of 0.1 deg/h at 1 Hz is an angle random walk of 0.1/60 deg/√h.
        let sigma_deg_h = if end == "pass" { 0.1 } else { 0.2 };
        let row = |i: u64| format!("{i},{:.5}\n", 12.5 + sigma_deg_h * white(1, i));
        let recording = || format!("time_s,rate_deg_h\n{}", (0..3000).map(row).collect::<String>());
        Quick {
            procedure: shared_input("quick.toml", || PROCEDURE.to_owned()),
            recording: shared_input(&format!("quick-{end}.csv"), recording),
            limits: shared_input("quick-limits.toml", || LIMITS.to_owned()),
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
