//! Which format reads a file: the one that its user states, else the first that recognises the first bytes.

use crate::error::{IngestError, IngestErrorKind, shorten};
use crate::format::{Candidate, Format};
use crate::formats::{FORMATS, FormatFeature, left_out};
use sagnac_core::message::{Arg, Note, note};
use sagnac_core::spelling::nearest;

/// A kind of file that is not read.
struct NotRead {
    /// Its first bytes.
    magic: &'static [u8],
    /// Key of what it is.
    what: &'static str,
    /// Key of what to do about it.
    hint: &'static str,
    /// What converts it, for the hint; empty where none is named.
    converter: &'static str,
}

const fn not_read(magic: &'static [u8], what: &'static str, hint: &'static str) -> NotRead {
    NotRead { magic, what, hint, converter: "" }
}

const fn convertible(magic: &'static [u8], what: &'static str, converter: &'static str) -> NotRead {
    NotRead { magic, what, hint: "ingest.hint.convert_with", converter }
}

/// Kinds of files that are not read, by their first bytes.
const NOT_READ: &[NotRead] = &[
    not_read(b"PK\x03\x04", "ingest.kind.zip", "ingest.hint.export_sheet"),
    not_read(b"%PDF", "ingest.kind.pdf", "ingest.hint.give_recording"),
    not_read(b"7z\xbc\xaf", "ingest.kind.seven_zip", "ingest.hint.unpack"),
    not_read(b"BZh", "ingest.kind.bzip2", "ingest.hint.repack"),
    not_read(b"\xfd7zXZ", "ingest.kind.xz", "ingest.hint.repack"),
    not_read(b"Rar!", "ingest.kind.rar", "ingest.hint.unpack"),
    not_read(b"\xd0\xcf\x11\xe0", "ingest.kind.compound", "ingest.hint.export_sheet"),
    convertible(b"\xa3\x95", "ingest.kind.dataflash", "`mavlogdump.py --format csv` (pymavlink)"),
    convertible(b"ARROW1", "ingest.kind.arrow", "`pandas.read_feather(...).to_parquet(...)`"),
    convertible(b"FEA1", "ingest.kind.arrow", "`pandas.read_feather(...).to_parquet(...)`"),
    convertible(b"Obj\x01", "ingest.kind.avro", "`fastavro --json`"),
    convertible(b"MDF     ", "ingest.kind.mdf", "`asammdf`"),
    convertible(b"\xaa\x44\x12", "ingest.kind.novatel", "`NovAtel Convert`"),
    convertible(b"\xaa\x44\x13", "ingest.kind.novatel", "`NovAtel Convert`"),
    convertible(b"\xb5\x62", "ingest.kind.ubx", "`pyubx2`"),
    convertible(b"\xfa\xff", "ingest.kind.xsens", "`MT Manager`"),
    convertible(b"RIFF", "ingest.kind.wave", "`scipy.io.wavfile.read`"),
    convertible(b"\x80\x04\x95", "ingest.kind.pickle", "`pandas.read_pickle(...).to_parquet(...)`"),
    convertible(b"\x0e\x03\x13\x01", "ingest.kind.hdf4", "`h4toh5`"),
    convertible(b"CDF\x01", "ingest.kind.netcdf3", "`nccopy -k nc4`"),
    convertible(b"CDF\x02", "ingest.kind.netcdf3", "`nccopy -k nc4`"),
];

/// The format that the user states, else the first that recognises the file.
///
/// # Errors
/// A file that no format recognises, a format that is not known or not compiled in, or one that the content contradicts.
pub(super) fn format_of(file: &Candidate) -> Result<&'static dyn Format, IngestError> {
    let unknown = |message: Note| IngestError::new(IngestErrorKind::UnknownFormat, &file.path, message);
    let Some(stated) = file.options.format.as_deref() else { return recognised(file) };
    let ids = || FORMATS.iter().map(|f| f.id());
    let Some(format) = FORMATS.iter().find(|f| f.id() == stated) else {
        if let Some(missing) = left_out().find(|f| f.id == stated) {
            return Err(not_compiled_in(file, missing));
        }
        let hint = match nearest(stated, ids()) {
            Some(near) => note!("ingest.hint.did_you_mean", name = near),
            None => note!("ingest.stated.formats", formats = ids().collect::<Vec<_>>().join(", ")),
        };
        let note = note!("ingest.stated.no_such_format", format = shorten(stated));
        return Err(unknown(note).hint(hint));
    };
    if format.may_be(file) {
        return Ok(*format);
    }
    Err(unknown(note!("ingest.stated.not_this_format", format = stated)).hint("ingest.stated.hint_format"))
}

/// The format that recognises a file.
fn recognised(file: &Candidate) -> Result<&'static dyn Format, IngestError> {
    let unknown = |note: Note| IngestError::new(IngestErrorKind::UnknownFormat, &file.path, note);
    let format = FORMATS.iter().find(|f| f.recognises(file)).copied();
    // Text is whatever looks like lines, so that kinds known by their first bytes go before it.
    if let Some(format) = format.filter(|f| f.id() != "csv") {
        return Ok(format);
    }
    if let Some(missing) = left_out().find(|f| (f.recognises)(file)) {
        return Err(not_compiled_in(file, missing));
    }
    if let Some(kind) = NOT_READ.iter().find(|kind| file.head.starts_with(kind.magic)) {
        let what = Arg::Key(kind.what.to_owned());
        let hint = match kind.converter {
            "" => Note::new(kind.hint),
            converter => Note::new(kind.hint).with("converter", converter),
        };
        return Err(unknown(note!("ingest.not_read", what)).hint(hint));
    }
    format.ok_or_else(|| {
        let ids: Vec<&str> = FORMATS.iter().map(|f| f.id()).collect();
        let hint = note!("ingest.formats.give", ids = ids.join(", "));
        unknown("ingest.formats.unknown".into()).hint(hint)
    })
}

/// The diagnostic of a format whose cargo feature is off.
fn not_compiled_in(file: &Candidate, format: &FormatFeature) -> IngestError {
    let note = note!("ingest.formats.left_out", format = format.id);
    IngestError::new(IngestErrorKind::UnknownFormat, &file.path, note)
        .hint(note!("ingest.formats.hint_feature", feature = format.feature))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::byte_stream::Packing;
    use crate::english::english;
    use crate::formats::FEATURES;
    use crate::layout::LayoutFile;
    use crate::options::ReadOptions;

    fn candidate(head: &[u8]) -> Candidate {
        let (path, options) = ("unit.rec".into(), ReadOptions::default());
        let (bytes, head) = (head.len() as u64, head.to_vec());
        Candidate { path, bytes, packing: Packing::Plain, head, head_is_all: true, options }
    }

    /// First bytes of every format.
    fn samples() -> Vec<(&'static str, Candidate)> {
        let mut mat = b"MATLAB 5.0 MAT-file".to_vec();
        mat.resize(124, b' ');
        mat.extend_from_slice(b"\x00\x01IM");
        let mut npz = b"PK\x03\x04".to_vec();
        npz.resize(26, 0);
        npz.extend_from_slice(b"\x05\0\0\0t.npy");
        let mut raw = candidate(&[0; 64]);
        raw.options.layout = Some(LayoutFile::at("unit.toml".into()));
        vec![
            ("raw", raw),
            ("parquet", candidate(b"PAR1....")),
            ("npy", candidate(b"\x93NUMPY\x01\0")),
            ("npz", candidate(&npz)),
            ("hdf5", candidate(b"\x89HDF\r\n\x1a\n....")),
            ("mat", candidate(&mat)),
            ("tdms", candidate(b"TDSm....")),
            ("mcap", candidate(b"\x89MCAP0\r\n....")),
            ("rosbag", candidate(b"#ROSBAG V2.0\n....")),
            ("rosbag2", candidate(b"SQLite format 3\0........")),
            ("ulog", candidate(b"ULog\x01\x12\x35\x01........")),
            ("xlsx", candidate(b"PK\x03\x04............................xl/workbook.xml")),
            ("json", candidate(b"{\"t\": 0, \"rate\": 1}\n")),
            ("slist", candidate(b"TIMESERIES XX_R_S_HJZ, 2 samples, 100 sps, 2026-01-01T00:00:00, SLIST, FLOAT, M/S\n1 2\n")),
            ("rawimu", candidate(b"%RAWIMUSA,1105,1.0;1105,1.0,0,1,2,3,4,5,6*00\n")),
            ("csv", candidate(b"t,rate\n0,1\n1,2\n")),
        ]
    }

    #[test]
    fn every_format_is_read_or_refused_with_its_feature() {
        let samples = samples();
        assert_eq!(samples.iter().map(|s| s.0).collect::<Vec<_>>(), FEATURES.each_ref().map(|f| f.id));
        for (id, mut file) in samples {
            for stated in [None, Some(id.to_owned())] {
                file.options.format = stated;
                let feature = FEATURES.iter().find(|f| f.id == id).unwrap().feature;
                match format_of(&file) {
                    Ok(format) => assert_eq!(format.id(), id),
                    Err(error) => {
                        assert!(FORMATS.iter().all(|f| f.id() != id), "{id}");
                        let text = english(&error.note());
                        assert!(text.contains(&format!("`{feature}`")), "{text}");
                    }
                }
            }
        }
    }
}
