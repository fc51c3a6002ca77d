//! Direction of the input axis from turns about an axis that is square to it.
//!
//! The input axis stands nearly along the inner axis of the table. The outer axis is square to the inner one, and its
//! direction in the plate is (cos β, −sin β, 0) at the inner angle β. With the input axis along (θ_y, −θ_x, 1), for small
//! tilts θ_x and θ_y about the plate's axes, y = y₀ + K·Ω_in + K·Ω_out·(θ_y cos β + θ_x sin β).

use super::blocks::TURN_ARCSEC;
use super::design::is_linearly_independent;
use super::noise::Rows;
use super::steps::{Step, Steps};
use crate::message::{Note, note};
use crate::numeric::reml::{self, Combination};
use nalgebra::{DMatrix, DVector};

/// Least share of the turning by which a tilt must show. Sines of readings about zero are noise and no inner angle.
const LEAST_SHARE: f64 = 0.01;

/// Columns that may move the output beside its offset: two tilts, their changes with temperature, the inner axis.
const CANDIDATES: usize = 5;
/// The changes of the tilts among them.
const OF_TEMPERATURE: [usize; 2] = [2, 3];
/// The inner axis among them.
const OF_INNER_RATE: usize = 4;

/// Tilts of the input axis of a channel.
#[derive(Debug, Clone)]
pub struct Alignment {
    /// Channel.
    pub channel: String,
    /// Tilts about x and y of the plate, rad; why one is not shown.
    pub tilts: [Result<Combination, Note>; 2],
    /// Changes of the tilts with temperature, rad/degC; why one is not shown.
    pub changes: [Result<Combination, Note>; 2],
    /// Output per rate about the inner axis, where the test turned about it.
    pub factor: Option<Combination>,
}

/// Evaluates a channel: what the turns do not show says why. `vertical` is the Earth rate along the outer axis, deg/h, and
/// `squareness` the standard uncertainty of the right angle between the axes of the table, rad. With `over_temperature` the tilts are
/// those at the mean temperature, beside their changes with it.
pub fn evaluate(
    steps: &Steps,
    channel: &str,
    gyro: usize,
    vertical: f64,
    squareness: f64,
    over_temperature: bool,
) -> Alignment {
    fit(steps, channel, gyro, vertical, squareness, over_temperature).unwrap_or_else(|why| Alignment {
        channel: channel.to_owned(),
        tilts: [Err(why.clone()), Err(why.clone())],
        changes: [Err(why.clone()), Err(why)],
        factor: None,
    })
}

/// Mean temperature of steps, degC; not a number where that of one is not known.
fn mean_temperature(rows: &[&Step]) -> f64 {
    rows.iter().map(|s| s.temperature).sum::<f64>() / rows.len() as f64
}

fn fit(
    steps: &Steps,
    channel: &str,
    gyro: usize,
    vertical: f64,
    squareness: f64,
    over_temperature: bool,
) -> Result<Alignment, Note> {
    // A step is one row: the Earth's horizontal rotation averages out over whole turns and not within one, and at rest it
    // depends on where the outer axis stopped.
    let largest = steps.list.iter().map(|s| s.outer.abs()).filter(|r| r.is_finite()).fold(0.0, f64::max);
    let rows: Vec<&Step> = steps
        .list
        .iter()
        .filter(|s| s.outer.abs() > 0.05 * largest && s.outer.is_finite())
        .filter(|s| s.gyro.get(gyro).is_some_and(|g| g.is_finite()))
        .collect();
    let n = rows.len();
    if n == 0 {
        return Err(note!("known.no_outer_turns"));
    }
    let angle = |s: &Step| {
        let at = s.parts.iter().map(|p| 0.5 * (p.angle.0 + p.angle.1)).sum::<f64>() / s.parts.len() as f64;
        at * 2.0 * std::f64::consts::PI / TURN_ARCSEC
    };
    if rows.iter().any(|s| !angle(s).is_finite()) {
        return Err(note!("known.angle_not_recorded"));
    }
    let outer = |s: &Step| s.outer + vertical;
    let column = |f: &dyn Fn(&Step) -> f64| DVector::from_iterator(n, rows.iter().map(|s| f(s)));
    let mut columns = vec![column(&|_| 1.0)];
    let warmer = |s: &Step| s.temperature - mean_temperature(&rows);
    let candidates = [
        column(&|s| outer(s) * angle(s).sin()),
        column(&|s| outer(s) * angle(s).cos()),
        column(&|s| outer(s) * angle(s).sin() * warmer(s)),
        column(&|s| outer(s) * angle(s).cos() * warmer(s)),
        column(&|s| s.rate),
    ];
    let turning = column(&outer).norm();
    let mut at = [None; CANDIDATES];
    let mut y = column(&|s| s.gyro[gyro]);
    for (k, c) in candidates.into_iter().enumerate() {
        // An unknown that few rows cannot bear: what little the inner axis turns then counts with the nominal factor.
        let of_temperature = OF_TEMPERATURE.contains(&k);
        let shows = match k {
            OF_INNER_RATE => true,
            _ if of_temperature => over_temperature && n > columns.len() + 1,
            _ => c.norm() > LEAST_SHARE * turning,
        };
        if k == OF_INNER_RATE && n < columns.len() + 3 {
            y -= c;
        } else if shows && is_linearly_independent(&c, &columns) {
            at[k] = Some(columns.len());
            columns.push(c);
        }
    }
    let of_inner = || note!("known.no_inner_angle");
    if at[0].is_none() && at[1].is_none() {
        return Err(of_inner());
    }
    // A row more than there are unknowns: nothing else shows the scatter of the turns.
    let few = || note!("known.few_outer_turns", n, least = columns.len() + 1);
    if n <= columns.len() {
        return Err(few());
    }
    let x = DMatrix::from_columns(&columns);
    let grid = Rows {
        mid_s: rows.iter().map(|s| 0.5 * (s.from_s + s.to_s)).collect(),
        length_s: rows.iter().map(|s| s.to_s - s.from_s).collect(),
        step: (0..n).collect(),
    };
    let components = [grid.white()];
    // Axes that are not square add the same share of the outer rate at every inner angle: common to all rows, it goes out
    // between angles that stand opposite, and stays where they do not.
    let common = column(&outer) * squareness;
    let fixed = &common * common.transpose()
        + DMatrix::identity(n, n) * (1e-12 * y.variance()).max(f64::MIN_POSITIVE);
    let fit = reml::fit(&y, &x, &fixed, &components).ok_or_else(few)?;
    let of = |k: usize| at[k].map(|column| fit.coefficient(column));
    let tilt = |k: usize| of(k).ok_or_else(of_inner);
    let change = |k: usize| of(k).ok_or_else(|| note!("known.no_temperatures_of_turns"));
    Ok(Alignment {
        channel: channel.to_owned(),
        tilts: [tilt(0), tilt(1)],
        changes: OF_TEMPERATURE.map(change),
        factor: of(OF_INNER_RATE),
    })
}
