//! The changes of a sample.

use crate::support::pairs::Pair;

/// What is done to a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// As it is: the documented verdict.
    None,
    /// The first tenth of the rows is missing.
    CutStart,
    /// The last tenth of the rows is missing.
    CutEnd,
    /// Every stamp is 12 345 s later.
    ShiftClock,
    /// Two files, one after the other.
    Split,
    /// The columns stand in reverse order.
    ReverseColumns,
    /// The rate in deg/s or rad/s, by name, header and procedure.
    OtherUnits,
    /// Pairs of rows averaged.
    Resample,
    /// The influence rests at its first value; of one that only the procedure tells, what it does to the output is gone.
    SilenceInfluence,
    /// The recording of a unit under the serial number of another.
    OtherUnit,
}

impl Change {
    /// All of them.
    pub const ALL: [Change; 10] = [
        Change::None,
        Change::CutStart,
        Change::CutEnd,
        Change::ShiftClock,
        Change::Split,
        Change::ReverseColumns,
        Change::OtherUnits,
        Change::Resample,
        Change::SilenceInfluence,
        Change::OtherUnit,
    ];
}

/// A changed sample.
pub struct Made {
    /// Texts of the files, in order.
    pub files: Vec<String>,
    /// Text of the procedure.
    pub procedure: String,
    /// Another serial number.
    pub serial: Option<String>,
}

/// A sample in parts.
struct Sample<'a> {
    comments: Vec<&'a str>,
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Sample<'_> {
    fn read(text: &str) -> Sample<'_> {
        let (comments, lines): (Vec<&str>, Vec<&str>) = text.lines().partition(|l| l.starts_with('#'));
        let fields = |l: &&str| l.split(',').map(str::to_owned).collect::<Vec<String>>();
        let mut lines = lines.iter().map(fields);
        let header = lines.next().unwrap();
        Sample { comments, header, rows: lines.collect() }
    }

    fn text(&self, rows: &[Vec<String>]) -> String {
        let comments = self.comments.iter().map(|c| (*c).to_owned());
        let lines = comments.chain([self.header.join(",")]).chain(rows.iter().map(|r| r.join(",")));
        lines.map(|l| l + "\n").collect()
    }

    fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|h| h == name)
    }

    fn map(&mut self, column: usize, of: impl Fn(f64) -> String) {
        for row in &mut self.rows {
            if let Some(field) = row.get_mut(column)
                && let Ok(value) = field.parse::<f64>()
            {
                *field = of(value);
            }
        }
    }
}

/// Makes a change; `None` where it does not apply to a sample.
pub fn make(change: Change, pair: &Pair, text: &str, procedure: &str) -> Option<Made> {
    let mut sample = Sample::read(text);
    let mut procedure = procedure.to_owned();
    let mut serial = None;
    let n = sample.rows.len();
    match change {
        Change::None => {}
        Change::CutStart => drop(sample.rows.drain(..n / 10)),
        Change::CutEnd => sample.rows.truncate(n - n / 10),
        Change::ShiftClock => {
            let time = sample.column("time_s")?;
            sample.map(time, |t| format!("{:.6}", t + 12_345.0));
        }
        Change::Split => {
            let (first, second) = sample.rows.split_at(n / 2);
            let files = vec![sample.text(first), sample.text(second)];
            return Some(Made { files, procedure, serial });
        }
        Change::ReverseColumns => {
            sample.header.reverse();
            // A row with a missing field at its end keeps it there.
            let width = sample.header.len();
            sample.rows.iter_mut().filter(|r| r.len() == width).for_each(|r| r.reverse());
        }
        Change::OtherUnits => {
            let rate = sample.column("rate_deg_h")?;
            let (name, unit, factor) = if pair.code == 0 {
                ("rate_deg_s", "deg/s", 1.0 / 3600.0)
            } else {
                ("rate_rad_s", "rad/s", RAD)
            };
            sample.header[rate] = name.to_owned();
            sample.map(rate, |v| format!("{:.12e}", v * factor));
            let (from, to) = procedure.split_once("column = \"rate_deg_h\"")?;
            procedure =
                format!("{from}column = \"{name}\"{}", to.replacen("\"deg/h\"", &format!("\"{unit}\""), 1));
        }
        Change::Resample => {
            let mean = |pair: &[Vec<String>]| {
                let of = |c: usize| pair.iter().map(|r| r.get(c)?.parse::<f64>().ok()).sum::<Option<f64>>();
                (0..sample.header.len())
                    .map(|c| of(c).map_or(String::new(), |s| format!("{:.8}", s / pair.len() as f64)))
                    .collect::<Vec<String>>()
            };
            sample.rows = sample.rows.chunks_exact(2).map(mean).collect();
        }
        Change::SilenceInfluence => {
            if let Some(interval_s) = pair.schedule_s {
                silence_the_output(&mut sample, interval_s)?;
            } else {
                let column = sample.column(pair.influence?)?;
                let first = sample.rows.first()?.get(column)?.clone();
                sample.rows.iter_mut().for_each(|r| r[column].clone_from(&first));
            }
        }
        Change::OtherUnit => {
            // Without a stated serial number nothing tells units apart.
            sample.comments.first()?;
            serial = Some("SN-9999".to_owned());
        }
    }
    let files = vec![sample.text(&sample.rows)];
    Some(Made { files, procedure, serial })
}

/// Puts white noise as strong as that of the first interval, about its mean, in place of the output.
fn silence_the_output(sample: &mut Sample<'_>, interval_s: f64) -> Option<()> {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    let (time, rate) = (sample.column("time_s")?, sample.column("rate_deg_h")?);
    let number = |r: &[String], c: usize| r.get(c)?.parse::<f64>().ok();
    let rest: Vec<f64> = sample
        .rows
        .iter()
        .take_while(|r| number(r, time).is_some_and(|t| t < interval_s))
        .filter_map(|r| number(r, rate))
        .collect();
    let n = rest.len() as f64;
    let mean = rest.iter().sum::<f64>() / n;
    let sigma = (rest.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(7);
    for r in &mut sample.rows {
        let z: f64 = StandardNormal.sample(&mut rng);
        r[rate] = format!("{:.4}", mean + sigma * z);
    }
    Some(())
}

/// deg/h in rad/s.
const RAD: f64 = std::f64::consts::PI / 180.0 / 3600.0;
