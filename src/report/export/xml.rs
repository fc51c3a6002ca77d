//! XML documents: every text is escaped, and numbers read back as they were.

use crate::report::ReportError;
use quick_xml::events::{BytesDecl, BytesText, Event};
use quick_xml::{ElementWriter, Writer};
use std::borrow::Cow;
use std::io;

/// Namespace of the attributes that name types and schemas.
pub(super) const SCHEMA_INSTANCE: &str = "http://www.w3.org/2001/XMLSchema-instance";

/// A document in the making.
pub(super) type Xml = Writer<Vec<u8>>;

/// A whole document: its declaration, and what `write` adds.
pub(super) fn xml_document(write: impl FnOnce(&mut Xml) -> io::Result<()>) -> Result<Vec<u8>, ReportError> {
    let mut xml = Writer::new_with_indent(vec![], b' ', 2);
    let declared = xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
    declared.and_then(|()| write(&mut xml)).map_err(|e| ReportError::Xml(e.to_string()))?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

pub(super) fn element<'a>(
    xml: &'a mut Xml,
    name: &'a str,
    attributes: &[(&str, &str)],
) -> ElementWriter<'a, Vec<u8>> {
    let printable = attributes.iter().map(|(key, value)| (*key, printable(value)));
    xml.create_element(name).with_attributes(printable)
}

/// An element with what `inner` adds to it.
pub(super) fn node(
    xml: &mut Xml,
    name: &str,
    attributes: &[(&str, &str)],
    inner: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    element(xml, name, attributes).write_inner_content(inner).map(|_| ())
}

/// An element with a text.
pub(super) fn leaf(xml: &mut Xml, name: &str, attributes: &[(&str, &str)], text: &str) -> io::Result<()> {
    element(xml, name, attributes).write_text_content(BytesText::new(&printable(text))).map(|_| ())
}

/// An element with nothing in it.
pub(super) fn empty(xml: &mut Xml, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
    element(xml, name, attributes).write_empty().map(|_| ())
}

/// A text without the control characters that XML has no form for.
pub(super) fn printable(text: &str) -> Cow<'_, str> {
    let fits =
        |c: char| (!c.is_control() || matches!(c, '\t' | '\n')) && !matches!(c, '\u{fffe}' | '\u{ffff}');
    if text.chars().all(fits) { text.into() } else { text.chars().filter(|c| fits(*c)).collect() }
}

/// The shortest text that reads back as the same number.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A text that is not blank.
pub(super) fn stated(text: Option<&str>) -> Option<&str> {
    text.map(str::trim).filter(|t| !t.is_empty())
}

/// XML as a reader sees it, for tests.
#[cfg(test)]
pub(super) mod reading {
    use quick_xml::Reader;
    use quick_xml::escape::unescape;
    use quick_xml::events::{BytesStart, Event};
    use std::collections::BTreeMap;

    /// An element: its name behind those of the elements around it, its attributes, and the text directly in it.
    pub struct Element {
        pub path: String,
        pub attributes: BTreeMap<String, String>,
        pub text: String,
    }

    fn element(start: &BytesStart<'_>, around: Option<&Element>) -> Element {
        let text = |bytes: &[u8]| unescape(std::str::from_utf8(bytes).unwrap()).unwrap().into_owned();
        let name = text(start.name().as_ref());
        let attributes = start.attributes().map(Result::unwrap);
        Element {
            path: around.map_or_else(|| name.clone(), |a| format!("{}/{name}", a.path)),
            attributes: attributes.map(|a| (text(a.key.as_ref()), text(&a.value))).collect(),
            text: String::new(),
        }
    }

    /// Every element of a document, in its order.
    pub fn elements(document: &[u8]) -> Vec<Element> {
        let mut reader = Reader::from_str(std::str::from_utf8(document).unwrap());
        let (mut open, mut found): (Vec<usize>, Vec<Element>) = (vec![], vec![]);
        loop {
            let event = reader.read_event().unwrap();
            let within = open.last().copied();
            match &event {
                Event::Start(e) | Event::Empty(e) => {
                    let next = element(e, within.map(|i| &found[i]));
                    if matches!(event, Event::Start(_)) {
                        open.push(found.len());
                    }
                    found.push(next);
                }
                Event::End(_) => open.truncate(open.len().saturating_sub(1)),
                Event::Text(t) => {
                    within.into_iter().for_each(|i| found[i].text.push_str(&t.decode().unwrap()));
                }
                Event::GeneralRef(r) => {
                    let reference = format!("&{};", r.decode().unwrap());
                    within.into_iter().for_each(|i| found[i].text.push_str(&unescape(&reference).unwrap()));
                }
                Event::Eof => break,
                _ => {}
            }
        }
        assert!(open.is_empty());
        found
    }

    /// The elements whose paths end so.
    pub fn ending<'a>(elements: &'a [Element], end: &str) -> Vec<&'a Element> {
        elements.iter().filter(|e| e.path.ends_with(end)).collect()
    }
}
