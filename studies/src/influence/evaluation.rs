//! Simulated recordings evaluated as a run does, without the acceptance around it.

use crate::bench::influence::{Recorded, SHAKER, Series, Turns};
use crate::rate_table::evaluation::channels;
use sagnac::influence::comparison::{self, Beside, Comparison};
use sagnac::influence::cut::FileSpan;
use sagnac::influence::repeatability::{self, Repeatability};
use sagnac::influence::{ComparisonTest, RepeatabilityTest, Setting, intervals, runs};
use sagnac::rate_table::blocks::{Blocks, Collector};
use sagnac::recording::{Role, SampleBlock, Sink};

/// The blocks of a recording, and its level beside.
fn blocks(r: &Recorded, dt: f64) -> Blocks {
    let list = channels(&[Role::Rate, Role::Temperature, Role::MagneticField].map(|r| (r.id(), r)));
    let mut collector = Collector::new(&list, dt, None).beside(vec![2]);
    let mut start = 0;
    for i in 1..=r.time_s.len() {
        if i < r.time_s.len() && r.time_s[i] - r.time_s[i - 1] < 1.5 * dt {
            continue;
        }
        let level = if r.level.is_empty() { vec![0.0; i - start] } else { r.level[start..i].to_vec() };
        let values = [r.rate[start..i].to_vec(), r.temperature[start..i].to_vec(), level];
        let first_index = (r.time_s[start] / dt).round() as u64;
        collector.push(&SampleBlock {
            first_index,
            first_row: start as u64 + 1,
            time_s: r.time_s[start],
            continues: false,
            values: &values,
        });
        start = i;
    }
    collector.finish(dt)
}

/// Repeatability as it is found in a simulated series.
pub fn repeated(s: &Series, seed: u64) -> Repeatability {
    let blocks = blocks(&s.record(seed), s.dt);
    let test = RepeatabilityTest {
        settling_s: 10.0,
        minimum_run_s: 60.0,
        off_s: 60.0,
        fewest: 6,
        temperature: None,
        runs: vec![],
    };
    let files: [FileSpan; 0] = [];
    repeatability::evaluate(&blocks, &runs::find(&blocks, &test, &files), 0, 0.0).expect("runs")
}

/// Bias without and with an influence, as it is found in simulated intervals.
pub fn compared(t: &Turns, seed: u64) -> Comparison {
    let blocks = blocks(&t.record(seed), t.dt);
    let test = ComparisonTest {
        setting: if t.levels == SHAKER { Setting::vibration() } else { Setting::magnetic_field() },
        reference: t.levels[0],
        settling_s: 0.0,
        rate_settling_s: 0.0,
        minimum_interval_s: 10.0,
        alternations: 2,
        level_uncertainty: 0.0,
        temperature_difference_deg_c: 0.3,
        temperature_coefficient: None,
        declared: false,
        temperature: None,
        intervals: vec![],
        by_frequency: None,
    };
    let found = intervals::find(&blocks, &test, &["field".to_owned()], &[]);
    comparison::evaluate(&blocks, &found, &test, &Beside::default(), 0).expect("intervals")
}
