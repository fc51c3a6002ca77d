//! What the tests of the binary readers share: the values of the fixtures and reading a file whole.
#![allow(dead_code, reason = "each test file uses its own part")]

use sagnac::i18n::Localize;
use sagnac::ingest::{FieldFault, IngestError, ReadOptions, Source, open_with};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

pub fn fixture(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/binary/")).join(name)
}

pub fn time_s(i: usize) -> f64 {
    // The decimal that was written, not the product.
    format!("{:.3}", i as f64 * 0.005).parse().unwrap()
}

pub fn rate(i: usize) -> f64 {
    format!("{:.2}", (((i * 7919) % 1000) as f64 - 500.0) / 100.0).parse().unwrap()
}

pub fn temperature(i: usize) -> f64 {
    20.0 + (i % 7) as f64 / 8.0
}

pub fn columns(of: &[fn(usize) -> f64]) -> Vec<Vec<f64>> {
    of.iter().map(|f| (0..250).map(f).collect()).collect()
}

pub struct Read {
    pub names: Vec<String>,
    pub columns: Vec<Vec<f64>>,
    pub faults: Vec<FieldFault>,
    pub source: Source,
}

/// Every column of numbers of a file, read in one go.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Read, IngestError> {
    let source = open_with(path, options)?;
    let wanted: Vec<usize> = (0..source.columns().len()).filter(|i| source.columns()[*i].numeric).collect();
    let names = wanted.iter().map(|i| source.columns()[*i].name.clone()).collect();
    let mut columns = vec![Vec::new(); wanted.len()];
    let mut faults = Vec::new();
    let facts = source.read(&wanted, &mut |block| {
        assert_eq!(block.first_row as usize, columns[0].len() + 1);
        for (all, part) in columns.iter_mut().zip(&block.columns) {
            all.extend_from_slice(part);
        }
        faults.extend_from_slice(&block.faults);
        ControlFlow::Continue(())
    })?;
    assert_eq!(facts.unwrap().rows as usize, columns[0].len());
    // A single column comes out as it does among the others.
    for (slot, w) in wanted.iter().enumerate().take(3) {
        let mut one = Vec::new();
        source.read(&[*w], &mut |block| {
            one.extend_from_slice(&block.columns[0]);
            ControlFlow::Continue(())
        })?;
        let bits = |c: &[f64]| c.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&one), bits(&columns[slot]));
    }
    Ok(Read { names, columns, faults, source })
}

pub fn notes(source: &Source) -> String {
    source.notes().iter().map(|n| n.say(sagnac::i18n::Lang::En) + "\n").collect()
}

pub fn read_error(path: &Path, options: &ReadOptions) -> IngestError {
    read(path, options).err().expect("an error")
}
