//! Direction of the input axis from turns about an axis that is square to it.
//!
//! The input axis stands nearly along the inner axis of the table. The outer axis is square to the inner one, and its
//! direction in the plate is (cos β, −sin β, 0) at the inner angle β. With the input axis along (θ_y, −θ_x, 1), for small
//! tilts θ_x and θ_y about the plate's axes, y = y₀ + K·Ω_in + K·Ω_out·(θ_y cos β + θ_x sin β).

use super::Setup;
use super::blocks::TURN_ARCSEC;
use super::combine::spread;
use super::model::stands_out;
use super::noise::Rows;
use super::steps::{Step, Steps};
use crate::estimate::Estimate;
use crate::numeric::reml::{self, Combination};
use crate::text::Note;
use nalgebra::{DMatrix, DVector};

/// Ids that this evaluation gives.
pub const IDS: &[&str] = &["misalignment_x", "misalignment_y"];

/// Tilts of the input axis of a channel.
#[derive(Debug, Clone)]
pub struct Alignment {
    /// Channel.
    pub channel: String,
    /// Tilts about x and y of the plate, rad; `None` for one that the inner angles of the test do not show.
    pub tilts: [Option<Combination>; 2],
    /// Output per rate about the inner axis, where the test turned about it.
    pub factor: Option<Combination>,
}

/// Evaluates a channel; `None` when the other axis was not turned about, or the inner angle was not recorded. `vertical`
/// is the Earth rate along the outer axis, deg/h.
pub fn evaluate(steps: &Steps, gyros: &[String], channel: usize, vertical: f64) -> Option<Alignment> {
    // A step is one row: the Earth's horizontal rotation averages out over whole turns and not within one, and at rest it
    // depends on where the outer axis stopped.
    let largest = steps.list.iter().map(|s| s.outer.abs()).filter(|r| r.is_finite()).fold(0.0, f64::max);
    let rows: Vec<&Step> = steps
        .list
        .iter()
        .filter(|s| s.outer.abs() > 0.05 * largest && s.outer.is_finite())
        .filter(|s| s.gyro.get(channel).is_some_and(|g| g.is_finite()))
        .collect();
    let n = rows.len();
    if n < 5 {
        return None;
    }
    let angle = |s: &Step| {
        let at = s.parts.iter().map(|p| 0.5 * (p.angle.0 + p.angle.1)).sum::<f64>() / s.parts.len() as f64;
        at * 2.0 * std::f64::consts::PI / TURN_ARCSEC
    };
    let outer = |s: &Step| s.outer + vertical;
    let column = |f: &dyn Fn(&Step) -> f64| DVector::from_iterator(n, rows.iter().map(|s| f(s)));
    let mut columns = vec![column(&|_| 1.0)];
    let candidates =
        [column(&|s| outer(s) * angle(s).sin()), column(&|s| outer(s) * angle(s).cos()), column(&|s| s.rate)];
    let mut at = [None; 3];
    for (k, c) in candidates.into_iter().enumerate() {
        if stands_out(&c, &columns) {
            at[k] = Some(columns.len());
            columns.push(c);
        }
    }
    if at[0].is_none() && at[1].is_none() {
        return None;
    }
    let x = DMatrix::from_columns(&columns);
    let y = column(&|s| s.gyro[channel]);
    let grid = Rows {
        mid_s: rows.iter().map(|s| 0.5 * (s.from_s + s.to_s)).collect(),
        length_s: rows.iter().map(|s| s.to_s - s.from_s).collect(),
        step: (0..n).collect(),
    };
    let components = [grid.white()];
    let fixed = DMatrix::identity(n, n) * (1e-12 * y.variance()).max(f64::MIN_POSITIVE);
    let fit = reml::fit(&y, &x, &fixed, &components)?;
    let of = |k: usize| at[k].map(|column| fit.coefficient(column));
    Some(Alignment { channel: gyros.get(channel)?.clone(), tilts: [of(0), of(1)], factor: of(2) })
}

impl Alignment {
    /// The estimate of one id; `None` for an id that is not given here. The squareness of the axes of the table enters
    /// by `alignment_uncertainty`.
    pub fn estimate(&self, id: &'static str, unit: &'static str, setup: &Setup) -> Option<Estimate> {
        let which = IDS.iter().position(|known| *known == id)?;
        let method = "outer_axis_turns";
        Some(match &self.tilts[which] {
            Some(tilt) => {
                let others =
                    [1e3 * setup.alignment_uncertainty_rad, 1e3 * setup.rate_uncertainty * tilt.value.abs()];
                Estimate::measured(
                    id,
                    &self.channel,
                    1e3 * tilt.value,
                    unit,
                    spread(tilt, 1e3, &others),
                    method,
                )
            }
            None => Estimate::not_identifiable(id, &self.channel, None, unit, method)
                .note(Note::new("known.no_inner_angle")),
        })
    }
}
