//! The compensation tables beside a result.

use crate::output::MAX_RECORD_BYTES;
use sagnac_ingest::read_file;
use serde::Deserialize;
use std::path::Path;

/// A compensation table, as far as it is used here.
#[derive(Debug, Clone, Deserialize)]
pub struct Table {
    pub(super) channel: String,
    temperature_deg_c: Vec<f64>,
    bias_deg_h: Vec<f64>,
}

impl Table {
    /// The tables beside a result file, in the order of their names.
    pub(super) fn beside(file: &Path) -> Vec<Table> {
        let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut paths: Vec<_> =
            std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
        paths.retain(|p| p.file_name().is_some_and(|n| is_table(&n.to_string_lossy())));
        paths.sort();
        paths.iter().filter_map(|p| Table::of_bytes(&read_file(p, MAX_RECORD_BYTES).ok()?)).collect()
    }

    /// The tables among files by name, in the order of their names.
    pub(super) fn among(files: &[(String, String)]) -> Vec<Table> {
        let mut files: Vec<_> = files.iter().filter(|(name, _)| is_table(name)).collect();
        files.sort();
        files.iter().filter_map(|(_, text)| Table::of_bytes(text.as_bytes())).collect()
    }

    fn of_bytes(bytes: &[u8]) -> Option<Table> {
        serde_json::from_slice::<Table>(bytes).ok().filter(Table::is_sound)
    }

    fn is_sound(&self) -> bool {
        let rises = self.temperature_deg_c.windows(2).all(|w| w[0] < w[1]);
        let finite = self.temperature_deg_c.iter().chain(&self.bias_deg_h).all(|v| v.is_finite());
        self.temperature_deg_c.len() > 1
            && self.temperature_deg_c.len() == self.bias_deg_h.len()
            && rises
            && finite
    }

    /// Lowest and highest temperature, degC.
    pub(super) fn ends(&self) -> (f64, f64) {
        let t = &self.temperature_deg_c;
        (t.first().copied().unwrap_or(f64::NAN), t.last().copied().unwrap_or(f64::NAN))
    }

    /// The bias at a temperature of the range, on straight lines.
    pub(super) fn at(&self, temperature: f64) -> f64 {
        let t = &self.temperature_deg_c;
        let after = t.partition_point(|v| *v < temperature).clamp(1, t.len() - 1);
        let share = (temperature - t[after - 1]) / (t[after] - t[after - 1]);
        self.bias_deg_h[after - 1] + share * (self.bias_deg_h[after] - self.bias_deg_h[after - 1])
    }
}

/// Whether a file beside a result is a compensation table, by its name.
fn is_table(name: &str) -> bool {
    name.starts_with("compensation") && name.ends_with(".json")
}
