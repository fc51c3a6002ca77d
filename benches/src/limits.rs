//! Bare kernels that figures of speed are compared with: good plain code on one core, without checks, intervals or figures.

use super::TAU0_S;
use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use sagnac_fft::real_forward;
use std::f64::consts::PI;
use std::path::Path;

/// Samples of a segment of the Welch spectrum.
const SEGMENT: usize = 1 << 16;
/// Terms of the Allan deviation that are summed for all averaging times before the next ones.
const BLOCK: usize = 1 << 13;
/// Rows that are decoded at once.
const BATCH: usize = 1 << 15;

/// Every number of a text of plain decimals; their sum.
#[must_use]
pub fn parse(text: &[u8]) -> f64 {
    const POWERS: [f64; 10] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9];
    let header = text.iter().position(|b| *b == b'\n').unwrap_or(0) + 1;
    let (mut sum, mut digits, mut decimals, mut negative, mut after) = (0.0, 0u64, 0usize, false, false);
    for byte in &text[header..] {
        match byte {
            b'0'..=b'9' => {
                digits = 10 * digits + u64::from(byte - b'0');
                decimals += usize::from(after);
            }
            b'.' => after = true,
            b'-' => negative = true,
            _ => {
                let value = digits as f64 / POWERS[decimals];
                sum += if negative { -value } else { value };
                (digits, decimals, negative, after) = (0, 0, false, false);
            }
        }
    }
    sum
}

/// Overlapping Allan deviations at ten averaging times a decade.
#[must_use]
pub fn allan(rate: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let phase: Vec<f64> = std::iter::once(0.0)
        .chain(rate.iter().map(|y| {
            sum += y * TAU0_S;
            sum
        }))
        .collect();
    let largest = rate.len() / 3;
    let mut times: Vec<usize> = (0..80).map(|i| 10f64.powf(f64::from(i) / 10.0).round() as usize).collect();
    times.dedup();
    times.retain(|m| *m <= largest);
    let mut squares = vec![0.0; times.len()];
    for begin in (0..phase.len()).step_by(BLOCK) {
        for (m, total) in times.iter().zip(&mut squares) {
            let end = (begin + BLOCK).min((phase.len()).saturating_sub(2 * m));
            if begin >= end {
                continue;
            }
            let (first, middle, last) =
                (&phase[begin..end], &phase[begin + m..end + m], &phase[begin + 2 * m..end + 2 * m]);
            let terms = first.iter().zip(middle).zip(last);
            *total += terms.map(|((a, b), c)| (c - 2.0 * b + a).powi(2)).sum::<f64>();
        }
    }
    let deviation = |(m, square): (&usize, &f64)| {
        let (tau_s, terms) = (*m as f64 * TAU0_S, (phase.len() - 2 * m) as f64);
        (square / (2.0 * tau_s * tau_s * terms)).sqrt()
    };
    times.iter().zip(&squares).map(deviation).collect()
}

/// Mean powers of segments under a Hann window that overlap by half; shorter ones where there are few samples.
#[must_use]
pub fn welch(rate: &[f64]) -> Vec<f64> {
    let segment = SEGMENT.min(rate.len());
    let plan = real_forward(segment);
    let (mut input, mut output) = (plan.make_input_vec(), plan.make_output_vec());
    let window: Vec<f64> =
        (0..segment).map(|i| 0.5 - 0.5 * (2.0 * PI * i as f64 / segment as f64).cos()).collect();
    let mut powers = vec![0.0; output.len()];
    for begin in (0..=rate.len() - segment).step_by((segment / 2).max(1)) {
        let samples = rate[begin..begin + segment].iter().zip(&window);
        input.iter_mut().zip(samples).for_each(|(x, (y, w))| *x = y * w);
        if plan.process(&mut input, &mut output).is_err() {
            break;
        }
        powers.iter_mut().zip(&output).for_each(|(p, v)| *p += v.norm_sqr());
    }
    powers
}

/// Every value of the columns of doubles of a Parquet file; their sum.
///
/// # Errors
/// An error of a file that cannot be read.
pub fn decode(path: &Path) -> Result<f64, ParquetError> {
    let reader = SerializedFileReader::new(std::fs::File::open(path)?)?;
    let (mut values, mut levels, mut sum) = (Vec::with_capacity(BATCH), vec![], 0.0);
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        for column in 0..group.num_columns() {
            let ColumnReader::DoubleColumnReader(mut column) = group.get_column_reader(column)? else {
                continue;
            };
            loop {
                values.clear();
                levels.clear();
                let (rows, ..) = column.read_records(BATCH, Some(&mut levels), None, &mut values)?;
                if rows == 0 {
                    break;
                }
                sum += values.iter().sum::<f64>();
            }
        }
    }
    Ok(sum)
}

/// Densities of first-order processes of so many correlation times at as many frequencies as a record has bands with their
/// places: sines, products and a quotient each; their sum.
#[must_use]
pub fn densities(times: usize) -> f64 {
    const PLACES: usize = 3000;
    let mut sum = 0.0;
    for time in 0..times {
        let rho = (-1.0 / (1.0 + time as f64)).exp();
        for place in 1..=PLACES {
            let (sin, cos) = (PI * place as f64 / (PLACES + 1) as f64).sin_cos();
            let (re, im) = (1.0 - rho * cos, rho * sin);
            sum += re / (re * re + im * im);
        }
    }
    sum
}

/// White noise and a random walk of so many samples, by the polar method from a plain generator; the last value.
#[must_use]
pub fn noise(samples: usize) -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let (mut walk, mut last) = (0.0, 0.0);
    for _ in 0..samples {
        let (a, b) = loop {
            let (u, v) = (uniform(), uniform());
            let s: f64 = u * u + v * v;
            if s > 0.0 && s < 1.0 {
                let scale = (-2.0 * s.ln() / s).sqrt();
                break (u * scale, v * scale);
            }
        };
        walk += 1e-3 * a;
        last = walk + b;
    }
    last
}
