//! Reads back what is attached to a document.

use crate::PdfError;
use lopdf::{Dictionary, Document, Object};
use std::collections::BTreeMap;

/// The language of a document and the files that are attached to it, by their names.
///
/// # Errors
/// [`PdfError`] for what is no PDF.
pub fn attached(bytes: &[u8]) -> Result<(String, BTreeMap<String, Vec<u8>>), PdfError> {
    let said = |e: lopdf::Error| PdfError(vec![e.to_string()]);
    let document = Document::load_mem(bytes).map_err(said)?;
    let language = document.catalog().ok().and_then(|c| text(c, b"Lang")).unwrap_or_default();
    let specification = |object: &Object| {
        let dictionary = object.as_dict().ok()?;
        let name = text(dictionary, b"UF").or_else(|| text(dictionary, b"F"))?;
        let file = dictionary.get(b"EF").ok()?.as_dict().ok()?.get(b"F").ok()?;
        let stream = document.get_object(file.as_reference().ok()?).ok()?.as_stream().ok()?;
        let contents = stream.decompressed_content().unwrap_or_else(|_| stream.content.clone());
        Some((name, contents))
    };
    Ok((language, document.objects.values().filter_map(specification).collect()))
}

fn text(dictionary: &Dictionary, key: &[u8]) -> Option<String> {
    lopdf::decode_text_string(dictionary.get(key).ok()?).ok()
}
