//! A data sheet against the results that it is of, where these are at hand.

use super::finding::Finding;
use super::folder::Folder;
use crate::acceptance::datasheet::{TestedUnit, datasheet, select};
use crate::i18n::note;
use crate::lot::tolerance::Promise;
use crate::output::sha256_of_file;
use crate::record::{DATASHEET_FORMAT, DataSheet, SheetQuantity, read};
use std::path::Path;

/// Makes a data sheet anew from its results and compares the numbers. Results that are not where they were are named.
pub(super) fn sheet(folder: &Folder) -> Vec<Finding> {
    let path = folder.record_file();
    let stated: DataSheet = match read::bytes(&path).and_then(|b| read::of_format(&b, DATASHEET_FORMAT)) {
        Ok(stated) => stated,
        Err(e) => return vec![Finding::Differs(e.note(&path))],
    };
    let mut units = vec![];
    for result in &stated.results {
        let path = Path::new(&result.path);
        // A file with another content is another result, not this one changed.
        let same = sha256_of_file(path).as_ref() == Some(&result.sha256);
        match TestedUnit::read(path).ok().filter(|_| same) {
            Some(unit) => units.push(unit),
            None => {
                let note = note!("verify.no_result_of_sheet", path = result.path.as_str());
                return vec![Finding::Unchecked(note)];
            }
        }
    }
    let bounds = stated.quantities.iter().flat_map(|q| &q.bounds).next();
    let promise = bounds.map(|b| Promise { proportion: b.proportion, confidence: b.confidence });
    let (Some(promise), Ok(selected)) = (promise, select(units)) else {
        return vec![Finding::Unchecked("verify.sheet_without_bounds".into())];
    };
    let made = datasheet(selected, promise, stated.made_at.clone());
    let mut differing: Vec<&str> = stated
        .quantities
        .iter()
        .filter(|own| !made.quantities.iter().any(|other| is_same(own, other)))
        .map(|q| q.id.as_str())
        .collect();
    let facts = [
        ("units", stated.units == made.units),
        ("lots", stated.lots == made.lots),
        ("model", stated.model == made.model),
        ("procedure", stated.procedure == made.procedure),
        ("conditions", stated.conditions == made.conditions),
        ("curves", stated.curves == made.curves),
        ("temperature_curves", stated.temperature_curves == made.temperature_curves),
        ("results", stated.results == made.results),
    ];
    differing.extend(facts.into_iter().filter(|(_, is_same)| !is_same).map(|(name, _)| name));
    match differing.as_slice() {
        [] => vec![Finding::Agrees(note!("verify.sheet", n = made.units))],
        names => vec![Finding::Differs(note!("verify.sheet_differs", names = names.join(", ")))],
    }
}

/// True for the same quantity with the same numbers; names and footnotes are those of a sheet file, which may also choose another unit.
fn is_same(stated: &SheetQuantity, made: &SheetQuantity) -> bool {
    let key = |q: &SheetQuantity| (q.id.clone(), q.channel.clone(), q.phase.clone());
    if key(stated) != key(made) {
        return false;
    }
    if stated.unit != made.unit {
        return stated.units == made.units && stated.values.len() == made.values.len();
    }
    let unnamed = SheetQuantity { name: None, footnote: None, notes: vec![], ..stated.clone() };
    unnamed == SheetQuantity { notes: vec![], ..made.clone() }
}
