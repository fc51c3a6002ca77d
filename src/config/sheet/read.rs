//! A sheet file, with every problem at its place.

use super::tables::{RowKeys, SHEET_FILE, SheetTables};
use super::{SheetFile, SheetRow};
use crate::config::diagnostics::Problems;
use crate::config::read_tables::checked;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::config::text_file::{self, Wording};
use crate::i18n::note;
use crate::units::Unit;
use std::path::Path;

/// Messages for a sheet file that cannot be read at all.
const READ_MESSAGES: Wording = Wording { unreadable: "sheet_file.unreadable", folder: "sheet_file.folder" };

/// Reads a sheet file.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(path: &Path) -> Result<SheetFile, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &READ_MESSAGES)?)
}

/// Reads a sheet file from its bytes; `name` stands in diagnostics.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8]) -> Result<SheetFile, Problems> {
    let (sheet, problems) = checked(&text_file::source(name, bytes)?, &SHEET_FILE, build);
    sheet.ok_or(problems)
}

fn build(root: &Section, reader: &mut Reader<'_>) -> SheetFile {
    let tables = SheetTables::read(root);
    let rows = tables.rows.into_iter().filter_map(|keys| row(keys, reader)).collect();
    SheetFile { title: tables.title, rows }
}

fn row(keys: RowKeys, reader: &mut Reader<'_>) -> Option<SheetRow> {
    let measurand = keys.measurand?;
    let own = Unit::parse(measurand.unit).ok();
    if let (Some(unit), Some(own)) = (&keys.unit, &own)
        && !unit.same_dimension(own)
    {
        let message = note!("sheet_file.dimension", unit = unit.text(), id = measurand.id);
        let help = note!("sheet_file.help.dimension", unit = own.text());
        reader.error(&keys.section.span_of("unit"), message, Some(help));
    }
    let RowKeys { channel, phase, name, unit, footnote, .. } = keys;
    Some(SheetRow { measurand, channel, phase, name, unit, footnote })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_in_their_order_and_a_foreign_unit_is_refused() {
        let text = "format = \"sheet/1\"\n[[row]]\nmeasurand = \"bias_instability\"\nname = { en = \"BI\", ru = \"НС\" }\n\
                    [[row]]\nmeasurand = \"angle_random_walk\"\nunit = \"deg/h/sqrt(Hz)\"\nfootnote = \"at rest\"\n";
        let sheet = parse("s.toml", text.as_bytes()).unwrap_or_else(|_| panic!("it is right"));
        let ids: Vec<&str> = sheet.rows.iter().map(|r| r.measurand.id).collect();
        assert_eq!(ids, ["bias_instability", "angle_random_walk"]);
        assert_eq!(sheet.rows[1].unit.as_ref().map(Unit::text), Some("deg/h/sqrt(Hz)"));
        let wrong = text.replace("deg/h/sqrt(Hz)", "V");
        let problems = parse("s.toml", wrong.as_bytes()).unwrap_err();
        assert_eq!(problems.list.first().map(|p| p.line), Some(7));
    }
}
