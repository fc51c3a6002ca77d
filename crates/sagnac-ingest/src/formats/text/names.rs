//! Names over the data: found, or refused where they do not fit the rows.

use super::dialect::{Line, Sniffed};
use super::fields::Separator;
use super::header::{self, Above, Header};
use super::separator::{Looks, looks};
use super::stamps::Shape;
use crate::error::{IngestError, IngestErrorKind};
use sagnac_core::message::note;

impl Sniffed<'_> {
    /// Names and units above the data; refuses a header that does not fit.
    pub(super) fn header(&self, above: &[Line<'_>], data: &[&Line<'_>]) -> Result<Header, IngestError> {
        let options = &self.file.options.text;
        let (separator, fields) = (self.cut.separator, self.cut.fields);
        let cells = |l: &Line<'_>| separator.usual_cells(l.text, fields).len();
        let lines: Vec<Above<'_>> = above
            .iter()
            .map(|l| match self.comments.prefix_of(l.text) {
                Some(prefix) => {
                    let text = l.text.trim_ascii_start();
                    (l.number, text.get(prefix.len()..).unwrap_or_default().trim_ascii(), true)
                }
                None => (l.number, l.text, false),
            })
            .collect();
        let header = match options.header_line {
            Some(0) => Header::default(),
            stated => match header::find(&lines, separator, fields, stated) {
                header if header.names.is_some() => header,
                header => self.header_over_dates(&lines, data, stated).unwrap_or(header),
            },
        };
        let whole = |l: &&&Line<'_>| {
            let of = separator.usual_cells(l.text, fields);
            of.iter().all(|c| !c.contains(&b'.') && looks(c, b'.') == Looks::Number)
        };
        let commas = self.cut.separator == Separator::Byte(b',') && fields > 1 && self.cut.decimal == b'.';
        let all_whole = commas && !data.is_empty() && data.iter().all(|l| whole(&l));
        let plain = || above.iter().filter(|l| !self.comments.holds(l.text));
        let last = match options.header_line {
            Some(0) => None,
            Some(n) => above.iter().find(|l| l.number == n),
            None => plain().next_back(),
        };
        let named = header.names.is_some();
        if !named && all_whole && options.delimiter.is_none() {
            let zeros = |c: &&[u8]| c.len() > 1 && c.starts_with(b"0");
            let fraction =
                data.iter().flat_map(|l| separator.cells(l.text).into_iter().skip(1)).any(|c| zeros(&c));
            let title = last.is_some_and(|l| cells(l) < fields);
            if let Some(line) = data.first().filter(|_| fraction || title) {
                return Err(self
                    .error(note!("ingest.delimited.comma_twice"))
                    .at(line.number, None)
                    .found(&String::from_utf8_lossy(line.text))
                    .hint("ingest.delimited.hint_comma"));
            }
        }
        let keyed = |l: &Line<'_>| l.text.contains(&b':') || l.text.contains(&b'=');
        let block = plain().count() > 1 && plain().all(|l| cells(l) == 2);
        let stated = options.header_line.is_some_and(|h| h > 0);
        if let Some(last) = last.filter(|l| !named && (stated || (cells(l) > 1 && !keyed(l) && !block))) {
            let count = cells(last);
            let odd = data.iter().find(|l| cells(l) != count);
            let message = note!(
                "ingest.delimited.names_do_not_fit",
                line = last.number,
                names = count,
                fields = odd.map_or(fields, |l| cells(l))
            );
            let error = IngestError::new(IngestErrorKind::NotNumeric, self.path, message);
            let error = match odd {
                Some(l) => error.at(l.number, None).found(&String::from_utf8_lossy(l.text)),
                None => error,
            };
            return Err(error.hint("ingest.delimited.hint_names"));
        }
        Ok(header)
    }

    /// Names where blanks separate and one name stands over a date and the clock time behind it.
    fn header_over_dates(
        &self,
        above: &[Above<'_>],
        data: &[&Line<'_>],
        stated: Option<u64>,
    ) -> Option<Header> {
        let cells = self.cut.separator.cells(data.first()?.text);
        let of: Vec<Looks> = cells.iter().map(|c| looks(c, self.cut.decimal)).collect();
        let together =
            |pair: &[Looks]| matches!(pair, [Looks::Stamp(Shape::Date(_)), Looks::Stamp(Shape::Clock)]);
        let at = of.windows(2).position(together).filter(|_| self.cut.separator == Separator::Blanks)?;
        let mut header = header::find(above, self.cut.separator, self.cut.fields.checked_sub(1)?, stated);
        let (_, names) = header.names.as_mut()?;
        let date = format!("{}_date", names.get(at)?);
        names.insert(at, date);
        if let Some((_, units)) = header.units.as_mut() {
            units.insert(at.min(units.len()), String::new());
        }
        Some(header)
    }
}
