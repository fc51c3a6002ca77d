//! A sample as rows of text that can be spoilt, and a seeded source of chance.

use std::path::Path;

/// A recording as text.
#[derive(Clone)]
pub struct Recording {
    /// Lines before the header.
    pub comments: Vec<String>,
    /// Names of the columns.
    pub header: String,
    /// Fields of each row.
    pub rows: Vec<Vec<String>>,
    /// Sample interval, s.
    pub interval_s: f64,
}

/// Columns of a sample.
pub const TIME: usize = 0;
pub const RATE: usize = 1;
pub const TEMPERATURE: usize = 2;

impl Recording {
    pub fn sample(name: &str) -> Recording {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("samples/unit-{name}.csv"));
        let text = std::fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let mut comments = vec![];
        let header = loop {
            let line = lines.next().unwrap();
            if !line.starts_with('#') {
                break line.to_owned();
            }
            comments.push(line.to_owned());
        };
        let rows: Vec<Vec<String>> = lines.map(|l| l.split(',').map(str::to_owned).collect()).collect();
        let stamp = |i: usize| rows[i][TIME].parse::<f64>().unwrap();
        let interval_s = stamp(1) - stamp(0);
        Recording { comments, header, rows, interval_s }
    }

    /// The file with a separator of fields and an end of lines.
    pub fn text_with(&self, separator: &str, end: &str) -> String {
        let mut out = String::new();
        for line in self.comments.iter().chain([&self.header.replace(',', separator)]) {
            out += line;
            out += end;
        }
        for row in &self.rows {
            out += &row.join(separator);
            out += end;
        }
        out
    }

    pub fn text(&self) -> String {
        self.text_with(",", "\n")
    }

    pub fn bytes(&self) -> Vec<u8> {
        self.text().into_bytes()
    }

    /// Every number of a column in another form; what is no number stays.
    pub fn map(mut self, column: usize, change: impl Fn(usize, f64) -> f64) -> Recording {
        for (i, row) in self.rows.iter_mut().enumerate() {
            if let Ok(v) = row[column].parse::<f64>() {
                row[column] = plain(change(i, v));
            }
        }
        self
    }

    /// Every field of a column in another form.
    pub fn map_text(mut self, column: usize, change: impl Fn(usize, &str) -> String) -> Recording {
        for (i, row) in self.rows.iter_mut().enumerate() {
            row[column] = change(i, &row[column]);
        }
        self
    }

    /// Stamps made anew, without a gap.
    pub fn stamped_anew(self) -> Recording {
        let interval_s = self.interval_s;
        self.map_text(TIME, |i, _| plain(i as f64 * interval_s))
    }

    /// Rows in some hours.
    pub fn hours(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let row = |h: f64| ((h * 3600.0 / self.interval_s) as usize).min(self.rows.len());
        row(from)..row(to)
    }

    /// The row in the middle.
    pub fn middle(&self) -> usize {
        self.rows.len() / 2
    }

    pub fn number(&self, row: usize, column: usize) -> f64 {
        self.rows[row][column].parse().unwrap_or(f64::NAN)
    }
}

/// A number with ten digits and no exponent.
pub fn plain(v: f64) -> String {
    let decimals = (9 - v.abs().max(1e-12).log10().floor() as i32).clamp(0, 18) as usize;
    let text = format!("{v:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// splitmix64 (Steele, Lea and Flood 2014).
pub struct Chance(u64);

impl Chance {
    pub fn new(seed: u64) -> Chance {
        Chance(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform from 0 to 1.
    pub fn uniform(&mut self) -> f64 {
        self.bits() as f64 / u64::MAX as f64
    }

    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for i in (1..list.len()).rev() {
            list.swap(i, (self.bits() % (i as u64 + 1)) as usize);
        }
    }

    /// True with a probability, for each of some rows.
    pub fn picks(&mut self, rows: usize, probability: f64) -> Vec<bool> {
        (0..rows).map(|_| self.uniform() < probability).collect()
    }
}
