//! The part of a recording that is used.

use super::length::{self, Length};
use crate::i18n::{Note, note};
use crate::series::Series;
use clap::Args;

/// Ends of the part of a recording that is used, from its start.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct PartArgs {
    /// Beginning of the part of the recording that is used, such as 2h [default: its start]
    #[arg(long, value_name = "LENGTH", value_parser = length::from_zero)]
    from: Option<Length>,
    /// End of that part [default: that of the recording]
    #[arg(long, value_name = "LENGTH", value_parser = length::above_zero)]
    to: Option<Length>,
}

impl PartArgs {
    /// True for a part that is all of the recording.
    pub fn is_whole(&self) -> bool {
        self.from.is_none() && self.to.is_none()
    }

    /// The part of a recording.
    ///
    /// # Errors
    /// A part without rows.
    pub fn of(&self, recording: Series) -> Result<Series, Note> {
        if self.is_whole() {
            return Ok(recording);
        }
        let from_s = self.from.map_or(0.0, |l| l.seconds);
        let part = recording.between(from_s, self.to.map_or(f64::INFINITY, |l| l.seconds));
        if part.time_s.is_empty() {
            let ends = (recording.time_s.first(), recording.time_s.last());
            let length_s = if let (Some(first), Some(last)) = ends { last - first } else { 0.0 };
            return Err(note!("part.error.empty", from_s, length_s));
        }
        Ok(part)
    }

    /// The remark that only a part was used; `None` where all was.
    pub fn remark(&self) -> Option<Note> {
        match (self.from.map(|l| l.seconds), self.to.map(|l| l.seconds)) {
            (None, None) => None,
            (from, None) => Some(note!("part.note.from", from_s = from.unwrap_or(0.0))),
            (from, Some(to_s)) => Some(note!("part.note.between", from_s = from.unwrap_or(0.0), to_s = to_s)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_holds_the_rows_between_its_ends() {
        let series = Series {
            time_s: (0..100).map(|i| 50.0 + f64::from(i)).collect(),
            rate_deg_h: (0..100).map(f64::from).collect(),
            index: (0..100).collect(),
            ..Series::default()
        };
        let length = |seconds: f64| Some(Length { seconds });
        let part = |from, to| PartArgs { from, to };
        let kept = part(length(10.0), length(20.0)).of(series.clone()).unwrap();
        assert_eq!((kept.rate_deg_h.first(), kept.rate_deg_h.last()), (Some(&10.0), Some(&19.0)));
        assert_eq!(part(length(90.0), None).of(series.clone()).unwrap().rate_deg_h.len(), 10);
        assert!(part(length(100.0), None).of(series.clone()).is_err());
        assert!(part(length(20.0), length(10.0)).of(series.clone()).is_err());
        assert!(part(None, None).is_whole() && part(None, None).remark().is_none());
        assert_eq!(part(None, None).of(series).unwrap().rate_deg_h.len(), 100);
    }
}
