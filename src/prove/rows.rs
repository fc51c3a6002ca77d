//! The rows of a proof: what is shown, what is concealed, and what is shown when the veil is lifted.

use super::order::ProofOrder;
use crate::claim::Claim;
use crate::config::model;
use crate::config::proof::{ClaimSource, Decoy, Part, ProofFile, Source};
use crate::config::text_file;
use crate::effect::{ClaimedMean, Column};
use crate::i18n::{Lang, Note, note};
use crate::ingest::ReadOptions;
use crate::noise::model::NoiseModel;
use crate::output::{sha256, sha256_of_file};
use crate::series::{Series, SeriesOptions, load_series};
use crate::simulate::{Order, Over, Rows, Simulation};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The rows of a proof.
pub(super) struct Prepared {
    /// The recording, as named in the proof.
    pub path: String,
    /// Its SHA-256.
    pub sha256: String,
    /// What the engine sees at first.
    pub shown: Series,
    /// Columns that are concealed.
    pub hidden: BTreeMap<String, Vec<f64>>,
    /// Disturbance added to the rate.
    pub added: Option<Added>,
    /// What it sees once the columns are shown; `None` where no column was concealed.
    pub unveiled: Option<Series>,
    /// What the claim is identified from, where that is other than what is shown.
    pub claim: Option<Series>,
}

/// Effects that were added to the rate.
pub(super) struct Added {
    /// Their kinds.
    pub kinds: Vec<String>,
    /// What they add, deg/h, a value a row.
    pub course: Vec<f64>,
}

/// Reads, conceals, adds.
///
/// # Errors
/// A note where the recording is not the one that is named, or lacks a column.
pub(super) fn prepare(order: &ProofOrder<'_>) -> Result<Prepared, Note> {
    let proof = order.proof;
    let (path, sha256, whole) = read(order, proof.rate.as_deref())?;
    let claim = match &proof.claim {
        ClaimSource::Model(_) => None,
        ClaimSource::Identified { part, rate } => {
            let from = match rate {
                Some(rate) => read(order, Some(rate))?.2,
                None => whole.clone(),
            };
            let mut from = cut(&from, *part);
            conceal(&mut from, &proof.hidden_columns)?;
            Some(from)
        }
    };
    let mut shown = cut(&whole, proof.part);
    if shown.time_s.len() < 2 || claim.as_ref().is_some_and(|c| c.time_s.len() < 2) {
        return Err("prove.error.no_rows".into());
    }
    let hidden = conceal(&mut shown, &proof.hidden_columns)?;
    let added = proof.added.as_deref().map(|p| add(p, &mut shown, proof.seed)).transpose()?;
    let unveiled = (!hidden.is_empty()).then(|| {
        let mut series = shown.clone();
        for (name, values) in &hidden {
            series.columns.insert(Column::of_name(name), values.clone());
        }
        let of = |name: &str| series.columns.get(&Column::of_name(name)).cloned();
        let decoys: Vec<(Column, Vec<f64>)> = proof
            .decoys
            .iter()
            .filter_map(|d| {
                Some((Column::of_name(&d.name), shifted(&of(&d.of)?, d, shown.sample_interval_s)))
            })
            .collect();
        series.columns.extend(decoys);
        series
    });
    if let Some(lost) = proof
        .decoys
        .iter()
        .find(|d| unveiled.as_ref().is_none_or(|u| !u.columns.contains_key(&Column::of_name(&d.name))))
    {
        return Err(note!("prove.error.no_column", column = lost.of.as_str()));
    }
    Ok(Prepared { path, sha256, shown, hidden, added, unveiled, claim })
}

/// The recording with one of its outputs as the rate: its path, its hash, its rows.
fn read(order: &ProofOrder<'_>, rate: Option<&str>) -> Result<(String, String, Series), Note> {
    let proof = order.proof;
    match &proof.source {
        Source::File { path, sha256: stated } => {
            let file = order.data.join(path);
            let found = sha256_of_file(&file)
                .ok_or_else(|| note!("prove.error.unreadable", path = file.display().to_string()))?;
            if found != *stated {
                let note = note!("prove.error.other_recording", path = file.display().to_string());
                return Err(note.with("stated", stated.as_str()).with("found", found));
            }
            Ok((path.clone(), found, averaged(load(file, proof, rate)?, proof.average)))
        }
        Source::Simulated { model: path, duration_s } => {
            let named = path.display().to_string();
            let bytes =
                text_file::read(path).map_err(|_| note!("prove.error.unreadable", path = named.as_str()))?;
            let file =
                model::parse(&named, &bytes).map_err(|p| note!("system.other", reason = p.say(Lang::En)))?;
            let over = Over::Duration { duration_s: *duration_s, start_s: 0.0, drivers: &file.drivers };
            let order = Order { claim: &file.claim, seed: proof.seed, over };
            let rows = Simulation::begin(order).and_then(Simulation::all).map_err(|e| e.note().clone())?;
            let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            Ok((name, sha256(&bytes), of_rows(rows, 1.0 / file.claim.sample_rate_hz)))
        }
    }
}

fn load(file: PathBuf, proof: &ProofFile, rate: Option<&str>) -> Result<Series, Note> {
    let mut channels = proof.channels.clone();
    if !channels.is_empty()
        && let Some(id) = rate
    {
        // Of declared channels, the first output is the rate.
        let Some(at) = channels.iter().position(|c| c.id == id) else {
            return Err(note!("prove.error.no_column", column = id));
        };
        let chosen = channels.remove(at);
        channels.insert(0, chosen);
    }
    let options = SeriesOptions {
        read: ReadOptions::default(),
        rate: rate.filter(|_| channels.is_empty()).map(str::to_owned),
        unit: proof.unit.clone(),
        any_rate: false,
        channels,
        sample_rate_hz: proof.sample_rate_hz,
    };
    load_series(&[file], &options, &mut |_, _| {}).map_err(|e| e.note())
}

/// Means of so many consecutive rows; rows around a gap are left out.
fn averaged(series: Series, rows: usize) -> Series {
    if rows < 2 {
        return series;
    }
    let whole = |first: &usize| {
        let last = first + rows - 1;
        series.index.get(last).is_some_and(|i| i - series.index[*first] == (rows - 1) as u64)
    };
    // Every mean begins at a multiple of its length on the grid, so that the means have a grid of their own.
    let mut firsts = vec![];
    let mut next = 0;
    while next < series.index.len() {
        let offset = series.index[next] % rows as u64;
        if offset == 0 && whole(&next) {
            firsts.push(next);
            next += rows;
        } else {
            next += 1;
        }
    }
    let mean = |values: &[f64]| -> Vec<f64> {
        firsts.iter().map(|f| values[*f..f + rows].iter().sum::<f64>() / rows as f64).collect()
    };
    Series {
        time_s: mean(&series.time_s),
        rate_deg_h: mean(&series.rate_deg_h),
        columns: series.columns.iter().map(|(c, values)| (*c, mean(values))).collect(),
        index: firsts.iter().map(|f| series.index[*f] / rows as u64).collect(),
        sample_interval_s: series.sample_interval_s * rows as f64,
        ..series
    }
}

/// Simulated rows as a recording.
fn of_rows(rows: Rows, interval_s: f64) -> Series {
    let start = rows.time_s.first().copied().unwrap_or(0.0);
    Series {
        index: rows.time_s.iter().map(|t| ((t - start) / interval_s).round() as u64).collect(),
        time_s: rows.time_s,
        rate_deg_h: rows.rate_deg_h,
        columns: rows.columns,
        sample_interval_s: interval_s,
        ..Series::default()
    }
}

fn cut(series: &Series, part: Part) -> Series {
    series.between(part.from_s.unwrap_or(0.0), part.to_s.unwrap_or(f64::INFINITY))
}

/// Takes columns out.
fn conceal(series: &mut Series, names: &[String]) -> Result<BTreeMap<String, Vec<f64>>, Note> {
    let mut hidden = BTreeMap::new();
    for name in names {
        let Some(values) = series.columns.remove(&Column::of_name(name)) else {
            return Err(note!("prove.error.no_column", column = name.as_str()));
        };
        hidden.insert(name.clone(), values);
    }
    Ok(hidden)
}

/// Adds the effects of a model to the rate.
fn add(path: &Path, series: &mut Series, seed: u64) -> Result<Added, Note> {
    let file = model::load(path).map_err(|p| note!("system.other", reason = p.say(Lang::En)))?;
    let only = Claim {
        noise: NoiseModel::default(),
        quantization_lsb_arcsec: 0.0,
        mean: ClaimedMean::default(),
        sample_rate_hz: 1.0 / series.sample_interval_s,
        ..file
    };
    let order = Order { claim: &only, seed, over: Over::Like(series) };
    let rows = Simulation::begin(order).and_then(Simulation::all).map_err(|e| e.note().clone())?;
    let kinds: Vec<String> = only.effects.iter().map(|e| e.effect.kind().to_owned()).collect();
    let moved = rows.rate_deg_h.iter().any(|v| *v != 0.0);
    if rows.rate_deg_h.len() != series.rate_deg_h.len() || !moved {
        return Err(note!("prove.error.adds_nothing", kinds = kinds.join(", ")));
    }
    for (rate, more) in series.rate_deg_h.iter_mut().zip(&rows.rate_deg_h) {
        *rate += more;
    }
    Ok(Added { kinds, course: rows.rate_deg_h })
}

/// A column that comes later, continued from its other end.
fn shifted(values: &[f64], decoy: &Decoy, interval_s: f64) -> Vec<f64> {
    let mut later = values.to_vec();
    let rows = (decoy.shift_s / interval_s).round() as usize;
    if let Some(rows) = rows.checked_rem(later.len()) {
        later.rotate_right(rows);
    }
    later
}

/// A recording as text with commas, in the shortest digits that give every number.
pub(super) fn text_of(series: &Series) -> String {
    let mut out = String::from("time_s,rate_deg_h");
    series.columns.keys().for_each(|c| {
        let _ = write!(out, ",{}", quoted(c.name()));
    });
    out.push('\n');
    for (row, (time, rate)) in series.time_s.iter().zip(&series.rate_deg_h).enumerate() {
        let _ = write!(out, "{time},{rate}");
        for values in series.columns.values() {
            let _ = write!(out, ",{}", values.get(row).copied().unwrap_or(f64::NAN));
        }
        out.push('\n');
    }
    out
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

/// The hash of a column: its values one a line.
pub(super) fn hash_of(values: &[f64]) -> String {
    let mut text = String::with_capacity(20 * values.len());
    for value in values {
        let _ = writeln!(text, "{value}");
    }
    sha256(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_is_written_with_every_digit() {
        let series = Series {
            time_s: vec![0.1 + 0.2, 1.0],
            rate_deg_h: vec![-1.0 / 3.0, 2e-9],
            columns: BTreeMap::from([(Column::of_name("a, b"), vec![20.0, 21.5])]),
            ..Series::default()
        };
        let text = text_of(&series);
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("time_s,rate_deg_h,\"a, b\""));
        let first: Vec<f64> = lines.next().unwrap().split(',').map(|f| f.parse().unwrap()).collect();
        assert_eq!(first, [0.1 + 0.2, -1.0 / 3.0, 20.0]);
    }

    #[test]
    fn a_decoy_holds_the_values_of_its_column_in_another_order() {
        let decoy = Decoy { name: "d".into(), of: "t".into(), shift_s: 4.0 };
        assert_eq!(shifted(&[1.0, 2.0, 3.0, 4.0], &decoy, 2.0), [3.0, 4.0, 1.0, 2.0]);
        assert_eq!(shifted(&[1.0, 2.0], &Decoy { shift_s: 7.0, ..decoy.clone() }, 1.0), [2.0, 1.0]);
        assert!(shifted(&[], &decoy, 1.0).is_empty());
    }

    #[test]
    fn means_leave_rows_around_a_gap_out() {
        let series = Series {
            time_s: vec![0.0, 1.0, 2.0, 3.0, 5.0, 6.0, 7.0],
            rate_deg_h: vec![0.0, 2.0, 4.0, 6.0, 10.0, 12.0, 14.0],
            index: vec![0, 1, 2, 3, 5, 6, 7],
            sample_interval_s: 1.0,
            ..Series::default()
        };
        let means = averaged(series.clone(), 2);
        assert_eq!(means.time_s, [0.5, 2.5, 6.5]);
        assert_eq!((means.rate_deg_h, means.index), (vec![1.0, 5.0, 13.0], vec![0, 1, 3]));
        assert_eq!(means.sample_interval_s, 2.0);
        assert_eq!(averaged(series.clone(), 1), series);
    }

    #[test]
    fn columns_are_taken_out_by_their_names() {
        let temperature = (Column::Temperature, vec![20.0, 21.0]);
        let mut series = Series { columns: BTreeMap::from([temperature]), ..Series::default() };
        let lost = conceal(&mut series, &["pressure".into()]).unwrap_err();
        assert_eq!(lost.id, "prove.error.no_column");
        let hidden = conceal(&mut series, &["temp_degC".into()]).unwrap();
        assert_eq!(hidden["temp_degC"], [20.0, 21.0]);
        assert!(series.columns.is_empty());
    }
}
