//! The tie between the clocks of two files from what both record: the angle of a table against the integral of a rate,
//! a rate twice, or one temperature twice.

use crate::column_inference::InferredColumn;
use crate::stamp_column::Stamps;
use crate::turns::{TURN_ARCSEC, unwrap_turns};
use crate::{IngestError, IngestErrorKind, Source};
use sagnac_core::message::{Note, note};
use sagnac_core::numeric::clock_tie::{ClockTie, Following, NoTie, Timed, tie};
use sagnac_core::recording::Role;
use sagnac_core::units::{Affine, Unit};
use std::ops::ControlFlow;

/// Offsets that are searched on either side, s. Clocks without dates are taken to have started within this time.
const RANGE_S: f64 = 60.0;

/// Share of the shorter record that is searched at most on either side.
const RANGE_SHARE: f64 = 0.125;

/// A tie found from the data.
pub(crate) struct EstimatedTie {
    /// Time that is added to stamps of the second file, s.
    pub shift_s: f64,
    /// Time of the recording at which offset and rate are uncorrelated, s.
    pub about_s: f64,
    /// Offset and rate with their uncertainty.
    pub tie: ClockTie,
    /// What both record.
    pub by: Note,
}

/// A quantity in one file.
struct Recorded {
    times_s: Vec<f64>,
    values: Vec<f64>,
}

/// Finds the tie. `between_s`: time that dates add to the stamps of the second file, where both clocks state dates.
///
/// # Errors
/// Files that record nothing in common, or nothing that ties their clocks.
pub(crate) fn estimate(
    source: &Source,
    stamps: &Stamps,
    second: &Source,
    its: &Stamps,
    between_s: Option<f64>,
) -> Result<EstimatedTie, IngestError> {
    let refused = |note: Note| {
        IngestError::new(IngestErrorKind::TimeBase, second.path(), note).hint("ingest.beside.hint_offset")
    };
    let mut best: Option<EstimatedTie> = None;
    let mut why = note!("ingest.beside.nothing_common");
    for (own, other, by) in pairs(source, second) {
        let (mut fast, mut slow) = (record(source, stamps, own)?, record(second, its, other)?);
        let (Some(&first), Some(&begins)) = (fast.times_s.first(), slow.times_s.first()) else { continue };
        let centre = between_s.map_or(first, |between| begins + between);
        fast.times_s.iter_mut().for_each(|t| *t -= centre);
        slow.times_s.iter_mut().for_each(|t| *t -= begins);
        if by == Common::Angle {
            integrate(&mut fast);
            unwrap_turns(&mut slow.values, TURN_ARCSEC);
        }
        let length = |of: &Recorded| of.times_s.last().zip(of.times_s.first()).map_or(0.0, |(b, a)| b - a);
        let range_s = RANGE_S.min(RANGE_SHARE * length(&fast).min(length(&slow)));
        let timed = |of: &Recorded| -> (Vec<f64>, Vec<f64>) { (of.times_s.clone(), of.values.clone()) };
        let (fast, slow) = (timed(&fast), timed(&slow));
        let found = tie(
            Timed { times_s: &fast.0, values: &fast.1 },
            Timed { times_s: &slow.0, values: &slow.1 },
            range_s,
            by.following(),
        );
        match found {
            Ok(tie) if best.as_ref().is_none_or(|b| tie.offset_sd_s < b.tie.offset_sd_s) => {
                let shift_s = centre - begins + tie.offset_s - tie.rate * tie.reference_s;
                let about_s = centre + tie.reference_s + tie.offset_s;
                best = Some(EstimatedTie { shift_s, about_s, tie, by: by.note() });
            }
            Ok(_) => {}
            Err(reason) => why = refusal(reason, by.note()),
        }
    }
    best.ok_or_else(|| refused(why))
}

/// What two files have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Common {
    Angle,
    Rate,
    Temperature,
}

impl Common {
    /// Of two thermometers one may lag behind the other.
    fn following(self) -> Following {
        match self {
            Common::Angle | Common::Rate => Following::AtOnce,
            Common::Temperature => Following::MayLag,
        }
    }

    fn note(self) -> Note {
        match self {
            Common::Angle => note!("ingest.beside.common_angle"),
            Common::Rate => note!("ingest.beside.common_rate"),
            Common::Temperature => note!("ingest.beside.common_temperature"),
        }
    }
}

fn refusal(reason: NoTie, by: Note) -> Note {
    match reason {
        NoTie::TooFew => note!("ingest.beside.tie_too_few", by),
        NoTie::Unrelated => note!("ingest.beside.tie_unrelated", by),
        NoTie::Ambiguous => note!("ingest.beside.tie_ambiguous", by),
        NoTie::Lags => note!("ingest.beside.tie_lags", by),
    }
}

/// Columns of both files that record one quantity: rates with the angle or the rate of a table, temperatures with
/// temperatures.
fn pairs(source: &Source, second: &Source) -> Vec<(usize, usize, Common)> {
    let of = |source: &Source, role: Role| -> Vec<usize> {
        let like = |g: InferredColumn| g.role == role && g.unit_is_named;
        let columns = source.columns().iter().enumerate();
        columns.filter(|(_, c)| c.numeric && like(c.inferred())).map(|(i, _)| i).collect()
    };
    let each = |a: Role, b: Role, by: Common| -> Vec<(usize, usize, Common)> {
        let others = of(second, b);
        of(source, a).into_iter().flat_map(|i| others.iter().map(move |j| (i, *j, by))).collect()
    };
    // The sharpest first: what a table turns is known better than how fast, and both better than a temperature.
    [
        (Role::Rate, Role::TableAngle, Common::Angle),
        (Role::Rate, Role::TableRate, Common::Rate),
        (Role::Temperature, Role::Temperature, Common::Temperature),
    ]
    .into_iter()
    .map(|(own, other, by)| each(own, other, by))
    .find(|pairs| !pairs.is_empty())
    .unwrap_or_default()
}

/// Reads a column with its stamps; rows whose stamps do not increase are left out.
fn record(source: &Source, stamps: &Stamps, column: usize) -> Result<Recorded, IngestError> {
    let conversion = source.columns().get(column).map(|c| c.inferred()).and_then(|g| {
        let inside = Unit::parse(g.role.internal_unit()?).ok()?;
        let affine = g.unit.affine_to(&inside).ok()?;
        Some(Affine { factor: affine.factor * g.scale, offset: affine.offset })
    });
    let conversion = conversion.unwrap_or(Affine::IDENTITY);
    let mut unwrapper = stamps.unwrapper();
    let mut out = Recorded { times_s: Vec::new(), values: Vec::new() };
    source.read(&[stamps.column, column], &mut |block| {
        let [times, values] = block.columns.as_mut_slice() else { return ControlFlow::Break(()) };
        stamps.seconds(times, &mut unwrapper);
        for (t, v) in times.iter().zip(values.iter()).filter(|(t, v)| t.is_finite() && v.is_finite()) {
            if out.times_s.last().is_none_or(|last| t > last) {
                out.times_s.push(*t);
                out.values.push(conversion.apply(*v));
            }
        }
        ControlFlow::Continue(())
    })?;
    Ok(out)
}

/// Turns a rate in deg/h into the angle since the first sample, arcsec.
fn integrate(of: &mut Recorded) {
    let (mut angle, mut before): (f64, Option<(f64, f64)>) = (0.0, None);
    for (t, value) in of.times_s.iter().zip(&mut of.values) {
        let rate = *value;
        if let Some((t0, rate0)) = before {
            angle += 0.5 * (rate0 + rate) * (t - t0);
        }
        before = Some((*t, rate));
        *value = angle;
    }
}
