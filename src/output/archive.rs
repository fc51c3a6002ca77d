//! Several files in one: a ZIP archive whose bytes depend on the files alone.

use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::time::UtcDateTime;
use rawzip::{CompressionMethod, ZipArchiveWriter};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// A ZIP archive of files by their names, in the order of the names, all of the first moment that archives know.
///
/// # Errors
/// What the archive has no form for, such as a name of more than 65 535 bytes.
pub fn archive(files: &BTreeMap<String, Vec<u8>>) -> io::Result<Vec<u8>> {
    let mut archive = ZipArchiveWriter::new(vec![]);
    for (name, bytes) in files {
        let file = archive.new_file(name.as_str()).compression_method(CompressionMethod::DEFLATE);
        let file = file.last_modified(first_moment()?);
        let (mut entry, config) = file.start().map_err(io::Error::other)?;
        let mut writer = config.wrap(DeflateEncoder::new(&mut entry, Compression::default()));
        writer.write_all(bytes)?;
        let (encoder, output) = writer.finish().map_err(io::Error::other)?;
        encoder.finish()?;
        entry.finish(output).map_err(io::Error::other)?;
    }
    archive.finish().map_err(io::Error::other)
}

/// The first moment of 1980, from which on archives have times.
fn first_moment() -> io::Result<UtcDateTime> {
    UtcDateTime::from_components(1980, 1, 1, 0, 0, 0, 0).ok_or_else(|| io::ErrorKind::InvalidInput.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::DeflateDecoder;
    use rawzip::ZipArchive;
    use std::io::Read;

    #[test]
    fn files_come_back_and_bytes_depend_on_them_alone() {
        let files: BTreeMap<String, Vec<u8>> =
            [("b/ж.txt".to_owned(), vec![7; 9000]), ("a".to_owned(), vec![])].into();
        let made = archive(&files).unwrap();
        assert_eq!(made, archive(&files).unwrap());
        assert!(made.len() < 1000, "{}", made.len());
        let read = ZipArchive::from_slice(&made).unwrap();
        let mut entries = read.entries();
        let mut found = BTreeMap::new();
        while let Some(entry) = entries.next_entry().unwrap() {
            let mut bytes = vec![];
            let compressed = read.get_entry(entry.wayfinder()).unwrap();
            DeflateDecoder::new(compressed.data()).read_to_end(&mut bytes).unwrap();
            found.insert(String::from_utf8(entry.file_path().as_ref().to_vec()).unwrap(), bytes);
        }
        assert_eq!(found, files);
    }
}
