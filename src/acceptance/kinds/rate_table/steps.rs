//! The steps of a test on a rate table as records and as a table.

use crate::rate_table::TableRun;
use crate::rate_table::scale_factor::ScaleFactor;
use crate::record::TableStepRecord;

/// The steps of a channel.
pub fn records(run: &TableRun, channel: &ScaleFactor, gyro: usize) -> Vec<TableStepRecord> {
    let ppm = 1e6 / (channel.factor * channel.full_scale).abs();
    channel
        .steps
        .iter()
        .filter_map(|r| {
            let step = run.steps.list.get(r.step)?;
            Some(TableStepRecord {
                channel: channel.channel.clone(),
                from_s: step.from_s,
                to_s: step.to_s,
                row: step.first_row,
                rate_deg_h: step.rate,
                turns: step.turns,
                temperature_deg_c: Some(step.temperature).filter(|t| t.is_finite()),
                approach: step.approach,
                cycle: step.cycle + 1,
                output_deg_h: *step.gyro.get(gyro)?,
                residual_deg_h: r.residual,
                standard_uncertainty_deg_h: r.standard,
                residual_ppm: r.residual * ppm,
            })
        })
        .collect()
}
