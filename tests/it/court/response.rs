//! Outputs that follow what they are tested with late, and courses that were taken out: recordings of the shipped tests, changed.

use super::objections;
use crate::support::{measurand, result, sagnac, shipped};
use std::path::Path;

/// A recording: its header and its columns.
struct Columns {
    header: String,
    values: Vec<Vec<f64>>,
}

impl Columns {
    fn of(name: &str) -> Columns {
        let text = std::fs::read_to_string(shipped(&format!("samples/{name}.csv"))).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let header = lines.next().unwrap().to_owned();
        let mut values = vec![vec![]; header.split(',').count()];
        for line in lines {
            for (column, cell) in values.iter_mut().zip(line.split(',')) {
                column.push(cell.parse().unwrap());
            }
        }
        Columns { header, values }
    }

    fn output(&mut self) -> &mut Vec<f64> {
        let at =
            self.header.split(',').position(|name| name.starts_with("rate_") || name == "counts").unwrap();
        &mut self.values[at]
    }

    /// Checks that contradict a row of the shipped test of this recording.
    fn contradicted(&self, procedure: &str, id: &str) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        let mut text = format!("{}\n", self.header);
        for row in 0..self.values[0].len() {
            let cells: Vec<String> = self.values.iter().map(|column| column[row].to_string()).collect();
            text += &cells.join(",");
            text.push('\n');
        }
        std::fs::write(folder.path().join("r.csv"), text).unwrap();
        checks(folder.path(), procedure, id)
    }
}

fn checks(folder: &Path, procedure: &str, id: &str) -> Vec<String> {
    let procedure = shipped(&format!("procedures/{procedure}.toml"));
    let said = sagnac(folder, &["run", &procedure, "r.csv", "--serial", "J-1", "--out", "o", "--force"]);
    assert!(said.code != 2, "{said:?}");
    let found = result(&folder.join("o"));
    objections(measurand(&found, id)).iter().map(|check| (*check).to_owned()).collect()
}

/// Values behind a lag of first order of so many samples.
fn late(values: &[f64], samples: f64) -> Vec<f64> {
    let keep = (-1.0 / samples).exp();
    let mut followed = values[0];
    let next = |v: &f64| {
        followed = keep * followed + (1.0 - keep) * v;
        followed
    };
    values.iter().map(next).collect()
}

/// Values less their means over so many of them on either side, of which there are fewer at the ends.
fn without_slow_part(values: &[f64], half: usize) -> Vec<f64> {
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
    let about = |i: usize| &values[i.saturating_sub(half)..(i + half + 1).min(values.len())];
    let all = mean(values);
    values.iter().enumerate().map(|(i, v)| all + v - mean(about(i))).collect()
}

#[test]
fn an_output_that_follows_the_table_late_decides_no_scale_factor() {
    let mut steps = Columns::of("scale-factor-pass");
    assert!(steps.contradicted("scale-factor", "scale_factor").is_empty(), "as it was recorded");
    let values = late(steps.output(), 30.0);
    *steps.output() = values;
    assert_eq!(steps.contradicted("scale-factor", "scale_factor"), ["late_output"]);
}

#[test]
fn a_field_whose_effect_was_taken_out_by_running_means_decides_no_sensitivity() {
    let mut field = Columns::of("magnetic-sensitivity-fail");
    assert!(
        field.contradicted("magnetic-sensitivity", "magnetic_sensitivity").is_empty(),
        "as it was recorded"
    );
    let half = field.values[0].len() / 40;
    let values = without_slow_part(field.output(), half);
    *field.output() = values;
    assert_eq!(field.contradicted("magnetic-sensitivity", "magnetic_sensitivity"), ["response"]);
}

#[test]
fn a_bias_over_temperature_that_was_taken_out_by_running_means_decides_none() {
    let mut ramps = Columns::of("temperature-fail");
    let id = "bias_temperature_sensitivity";
    assert!(ramps.contradicted("temperature-ramp", id).is_empty(), "as it was recorded");
    let half = ramps.values[0].len() / 40;
    let values = without_slow_part(ramps.output(), half);
    *ramps.output() = values;
    assert_eq!(ramps.contradicted("temperature-ramp", id), ["slow_part_removed"]);
}
