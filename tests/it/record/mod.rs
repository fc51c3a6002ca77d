//! A bench is recorded: whole tests on emulated instruments in accelerated time, and what goes wrong in them.

mod ends;
mod links;
mod refused;
mod twin;
mod whole;

use crate::support::shared::shared_input;
use crate::support::{Said, sagnac, sagnac_as_typed};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tempfile::{TempDir, tempdir};
use twin::{Trouble, Twin, Unit};

/// The unit at rest, as `sagnac simulate` makes it, with a scale factor that depends on the temperature.
fn unit(per_degree_ppm: f64) -> Unit {
    let model = "[recording]\nsample_rate_hz = 2\ncolumns = [\"time_s\", \"rate_deg_h\"]\n[noise]\nN_deg_rt_h = 0.004\n\
        B_deg_h = 0.002\n[bias]\nvalue_deg_h = 2.0\n[simulation]\nduration_s = 4000\nseed = 61\n";
    let text = shared_input("emulated-gyro.csv", || {
        let dir = tempdir().unwrap();
        fs::write(dir.path().join("model.toml"), model).unwrap();
        let said = sagnac(dir.path(), &["simulate", "model.toml", "--out", "s.csv"]);
        assert_eq!(said.code, 0, "{said:?}");
        fs::read_to_string(dir.path().join("s.csv")).unwrap()
    });
    let text = fs::read_to_string(text).unwrap();
    let rows = text.lines().filter_map(|line| line.split(',').nth(1)?.parse().ok());
    Unit { simulated: rows.collect(), error_ppm: 60.0, per_degree_ppm }
}

/// Rates at the temperature that there is, then at rest.
const SHORT: &str = "format = \"schedule/1\"\n[[step]]\ndo = \"table_rates\"\nrates_deg_s = [20.0, -20.0]\ndwell_s = 30.0\ncount = 2\n\
    [[step]]\ndo = \"hold\"\nduration_h = 0.02\n";

/// A folder with a bench.
struct Bench {
    dir: TempDir,
    twin: Twin,
}

impl Bench {
    fn new(unit: Unit, troubles: &[(f64, Trouble)], part: &str, schedule: &str) -> Bench {
        let (dir, twin) = (tempdir().unwrap(), Twin::new(unit, troubles));
        fs::write(dir.path().join("bench.toml"), twin.bench(part)).unwrap();
        fs::write(dir.path().join("schedule.toml"), schedule).unwrap();
        Bench { dir, twin }
    }

    fn folder(&self) -> &Path {
        self.dir.path()
    }

    fn at(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn args(&self) -> [&str; 8] {
        ["record", "bench.toml", "--schedule", "schedule.toml", "--out", "rec", "--twin", &self.twin.clock]
    }

    fn record(&self) -> Said {
        sagnac_as_typed(self.folder(), &self.args(), &[])
    }

    fn events(&self) -> Vec<Value> {
        let text = fs::read_to_string(self.at("rec/events.jsonl")).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    fn event(&self, name: &str) -> Vec<Value> {
        self.events().into_iter().filter(|event| event["event"] == name).collect()
    }

    /// Table, chamber and supply are as they are left when nobody looks after them.
    #[track_caller]
    fn is_safe(&self) {
        // A command that is not answered may still be on its way.
        let began = Instant::now();
        while self.twin.volts() != 0.0 && began.elapsed() < Duration::from_secs(5) {
            std::thread::sleep(Duration::from_millis(2));
        }
        assert_eq!((self.twin.demand(), self.twin.volts()), (0.0, 0.0));
        assert_eq!(self.twin.commands("table").last().map(String::as_str), Some(":MODE:OFF 1"));
        assert_eq!(self.twin.commands("chamber").last().map(String::as_str), Some("STOP"));
    }
}
