//! Stretches of a recording cut into rows: outputs with the time that they were averaged over.

use super::setup::Stated;
use crate::rate_table::blocks::{Block, Blocks};
use crate::rate_table::noise::Rows;
use nalgebra::DVector;

/// Rows of all stretches together.
const TOTAL_ROWS: usize = 160;

/// Rows of one stretch at least: what happens within it tells its noise.
const LEAST_PARTS: usize = 6;

/// Rows of one stretch at least where there are many.
const LEAST_OF_MANY: usize = 2;

/// A file of the recording with its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct FileSpan {
    /// Name.
    pub name: String,
    /// Phase that a manifest gives it.
    pub phase: Option<String>,
    /// First and last row, counted from 1.
    pub rows: (u64, u64),
}

/// A stretch: blocks from the first to before the end.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Phase, name of the file, or nothing.
    pub name: String,
    /// Position in the list that states it.
    pub stated: usize,
    /// Its blocks.
    pub blocks: (usize, usize),
}

/// Start and end of a block, s from the start of the recording.
pub fn span_s(blocks: &Blocks, block: &Block) -> (f64, f64) {
    let end = block.first_index + u64::from(block.samples);
    (block.first_index as f64 * blocks.interval_s, end as f64 * blocks.interval_s)
}

/// True when a block belongs to a file.
pub fn within(block: &Block, file: &FileSpan) -> bool {
    block.first_row >= file.rows.0 && block.first_row <= file.rows.1
}

/// Finds stated stretches, in the order of the recording: each file of a phase is one.
pub fn find_stated(blocks: &Blocks, list: &[Stated], files: &[FileSpan]) -> Vec<Stretch> {
    let mut found = Vec::new();
    for (stated, s) in list.iter().enumerate() {
        let all = FileSpan { name: String::new(), phase: None, rows: (0, u64::MAX) };
        let places: Vec<&FileSpan> = match &s.phase {
            Some(_) => files.iter().filter(|f| f.phase == s.phase).collect(),
            None => vec![&all],
        };
        for place in places {
            let inside = |b: &Block| {
                let (from, to) = span_s(blocks, b);
                within(b, place)
                    && s.from_s.is_none_or(|f| from >= f - 1e-9)
                    && s.to_s.is_none_or(|t| to <= t + 1e-9)
            };
            let Some(start) = blocks.list.iter().position(inside) else { continue };
            let count = blocks.list.iter().skip(start).take_while(|b| inside(b)).count();
            let name = s.phase.clone().unwrap_or_default();
            found.push(Stretch { name, stated, blocks: (start, start + count) });
        }
    }
    found.sort_by_key(|s| s.blocks);
    found
}

/// A stretch without its first time; `None` when too little is left.
pub fn settled(
    blocks: &Blocks,
    (from, to): (usize, usize),
    settling_s: f64,
    least_s: f64,
) -> Option<(usize, usize)> {
    let list = blocks.list.get(from..to)?;
    let begins = span_s(blocks, list.first()?).0;
    let kept = list.iter().position(|b| span_s(blocks, b).0 >= begins + settling_s - 1e-9)?;
    let length: f64 = list.iter().skip(kept).map(|b| f64::from(b.samples)).sum::<f64>() * blocks.interval_s;
    (length >= least_s && from + kept < to).then_some((from + kept, to))
}

/// Rows of a channel over stretches.
pub struct Cut {
    /// Outputs, deg/h.
    pub y: DVector<f64>,
    /// When they were measured.
    pub rows: Rows,
    /// The stretch of each, or the interval that its stretch belongs to.
    pub of: Vec<usize>,
    /// Temperatures, degC; NaN without one.
    pub temperature: Vec<f64>,
    /// Means of the channels kept beside; NaN without one.
    pub beside: Vec<Vec<f64>>,
    /// Rates of the table, deg/h; NaN without one.
    pub table_rate: Vec<f64>,
}

/// Number of stretches that the rows are of.
pub fn stretches(cut: &Cut) -> usize {
    cut.rows.step.last().map_or(0, |last| last + 1)
}

impl Cut {
    /// The same with every stretch beginning where the one before ended. What a unit does while it is off belongs to its
    /// repeatability, and stamps that restart in every file do not tell how long that was.
    #[must_use]
    pub fn without_pauses(mut self) -> Cut {
        let mut ends = 0.0;
        let mut shift = 0.0;
        for i in 0..self.of.len() {
            let half = 0.5 * self.rows.length_s[i];
            if i == 0 || self.of[i] != self.of[i - 1] {
                shift = ends - (self.rows.mid_s[i] - half);
            }
            self.rows.mid_s[i] += shift;
            ends = self.rows.mid_s[i] + half;
        }
        self
    }
}

/// Cuts stretches into rows; `None` when they do not leave more rows than stretches.
pub fn cut(blocks: &Blocks, stretches: &[(usize, usize)], gyro: usize) -> Option<Cut> {
    cut_into(blocks, stretches, gyro, LEAST_PARTS)
}

/// Cuts stretches of which there are many: short ones into two rows at least, so that the time of a fit stays bounded.
pub fn cut_many(blocks: &Blocks, stretches: &[(usize, usize)], gyro: usize) -> Option<Cut> {
    let least = (TOTAL_ROWS / stretches.len().max(1)).clamp(LEAST_OF_MANY, LEAST_PARTS);
    cut_into(blocks, stretches, gyro, least)
}

fn cut_into(blocks: &Blocks, stretches: &[(usize, usize)], gyro: usize, least_parts: usize) -> Option<Cut> {
    let total: usize = stretches.iter().map(|s| s.1 - s.0).sum();
    let (mut y, mut of, mut temperature, mut table_rate) = (vec![], vec![], vec![], vec![]);
    let mut rows = Rows::default();
    let mut beside = vec![vec![]; blocks.list.first().map_or(0, |b| b.beside.len())];
    for (number, (from, to)) in stretches.iter().enumerate() {
        let length = to - from;
        let parts = (TOTAL_ROWS * length / total.max(1)).max(least_parts).min(length);
        for k in 0..parts {
            let list = &blocks.list[from + length * k / parts..from + length * (k + 1) / parts];
            let weighted = |value: &dyn Fn(&Block) -> f64| {
                let usable =
                    list.iter().map(|b| (value(b), f64::from(b.samples))).filter(|v| v.0.is_finite());
                usable.fold((0.0, 0.0), |(s, n), (v, w)| (s + v * w, n + w))
            };
            let (sum, n) = weighted(&|b| b.gyro.get(gyro).copied().unwrap_or(f64::NAN));
            let (Some(first), Some(last)) = (list.first(), list.last()) else { continue };
            if n == 0.0 {
                continue;
            }
            let (t, t_n) = weighted(&|b| b.temperature);
            y.push(sum / n);
            of.push(number);
            temperature.push(if t_n > 0.0 { t / t_n } else { f64::NAN });
            let (turned, turned_n) = weighted(&|b| b.table_rate);
            table_rate.push(if turned_n > 0.0 { turned / turned_n } else { f64::NAN });
            for (at, means) in beside.iter_mut().enumerate() {
                let (sum, n) = weighted(&|b| b.beside.get(at).copied().unwrap_or(f64::NAN));
                means.push(if n > 0.0 { sum / n } else { f64::NAN });
            }
            rows.mid_s.push(0.5 * (span_s(blocks, first).0 + span_s(blocks, last).1));
            rows.length_s.push(n * blocks.interval_s);
            rows.step.push(number);
        }
    }
    let whole = (0..stretches.len()).all(|s| of.contains(&s));
    (whole && y.len() > stretches.len()).then(|| Cut {
        y: DVector::from_vec(y),
        rows,
        of,
        temperature,
        beside,
        table_rate,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_do_not_matter_where_they_are_taken_out() {
        let runs = |starts: [f64; 3]| {
            let mut rows = Rows::default();
            for (step, start) in starts.into_iter().enumerate() {
                for k in 0..4 {
                    rows.mid_s.push(start + 25.0 + 50.0 * f64::from(k));
                    rows.length_s.push(50.0);
                    rows.step.push(step);
                }
            }
            let of = rows.step.clone();
            let (temperature, table_rate) = (vec![f64::NAN; 12], vec![f64::NAN; 12]);
            Cut { y: DVector::zeros(12), rows, of, temperature, beside: vec![], table_rate }
                .without_pauses()
                .rows
        };
        let apart = runs([60.0, 4000.0, 90_000.0]);
        assert_eq!(apart, runs([60.0, 320.0, 580.0]));
        assert_eq!((apart.mid_s[0], apart.mid_s[4]), (25.0, 225.0));
    }
}
