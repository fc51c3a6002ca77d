//! A data sheet with the rows that a sheet file chooses.

use crate::config::sheet::{SheetFile, SheetRow};
use crate::i18n::note;
use crate::record::{DataSheet, Message, SheetQuantity, SheetScale};
use crate::units::Unit;

/// Takes the rows of a sheet file: their order, names, units and footnotes. A row that no result has is said in the notes of the
/// sheet.
pub fn apply(sheet: &mut DataSheet, file: &SheetFile) {
    let all = std::mem::take(&mut sheet.quantities);
    for row in &file.rows {
        let mut found = all.iter().filter(|q| is_of(q, row)).cloned().peekable();
        if found.peek().is_none() {
            let channel = row.channel.clone().map(|c| format!(" ({c})")).unwrap_or_default();
            let note = note!("datasheet.note.no_row", id = row.measurand.id, channel);
            sheet.notes.push(Message::from(note));
        }
        for mut quantity in found {
            quantity.name.clone_from(&row.name);
            quantity.footnote.clone_from(&row.footnote);
            let converted = row.unit.as_ref().map(|unit| convert(&mut quantity, unit));
            if converted == Some(false) {
                let note = note!("datasheet.note.other_dimension", unit = quantity.unit.as_str());
                quantity.notes.push(Message::from(note));
            }
            sheet.quantities.push(quantity);
        }
    }
    sheet.title.clone_from(&file.title);
}

fn is_of(quantity: &SheetQuantity, row: &SheetRow) -> bool {
    quantity.id == row.measurand.id
        && row.channel.as_ref().is_none_or(|c| *c == quantity.channel)
        && (row.phase.is_none() || row.phase == quantity.phase)
}

/// Every number of a quantity in another unit; false where its own cannot be converted.
fn convert(quantity: &mut SheetQuantity, unit: &Unit) -> bool {
    let Some(factor) = Unit::parse(&quantity.unit).ok().and_then(|own| own.factor_to(unit).ok()) else {
        return false;
    };
    let to = |v: &mut f64| *v *= factor;
    if let Some(typical) = &mut quantity.typical {
        to(&mut typical.value);
        to(&mut typical.interval.low);
        to(&mut typical.interval.high);
    }
    // A spread of logarithms has no unit.
    if let Some(spread) = quantity.spread.as_mut().filter(|_| quantity.scale == SheetScale::Linear) {
        to(&mut spread.between_units);
        spread.between_lots.as_mut().map(to);
        to(&mut spread.measurement);
    }
    quantity.bounds.iter_mut().for_each(|b| to(&mut b.value));
    quantity.outlook.iter_mut().for_each(|o| to(&mut o.value));
    quantity.largest.iter_mut().for_each(|l| to(&mut l.value));
    if let Some(limit) = &mut quantity.limit {
        limit.min.as_mut().map(to);
        limit.max.as_mut().map(to);
    }
    for value in &mut quantity.values {
        value.value.as_mut().map(to);
        value.upper_limit.iter_mut().for_each(|u| to(&mut u.value));
        if let Some(interval) = &mut value.interval {
            to(&mut interval.low);
            to(&mut interval.high);
        }
    }
    unit.text().clone_into(&mut quantity.unit);
    true
}
