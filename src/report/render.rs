//! Templates: the built-in ones, each of which a file of the same name in a folder of the user's replaces.

use super::number;
use super::prose::{self, prose};
use super::signatures::{Signature, SignatureView, waived};
use super::translator::Translator;
use crate::i18n::{Arg, Lang, Localize, Note, io_reason, lookup, note, table};
use crate::record::RunRecord;
use base64::Engine as _;
use minijinja::value::{Enumerator, Kwargs, Object, ObjectExt as _, Serde, Value};
use minijinja::{AutoEscape, Environment, ErrorKind, UndefinedBehavior};
use sagnac_ingest::read_text;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The built-in templates by name.
pub const TEMPLATES: &[(&str, &str)] = &[
    ("report.html", include_str!("../../templates/report.html")),
    ("meta.html", include_str!("../../templates/meta.html")),
    ("pointer.js", include_str!("../../templates/pointer.js")),
    ("signoff.md", include_str!("../../templates/signoff.md")),
    ("style.css", include_str!("../../templates/style.css")),
    ("signoff.html", include_str!("../../templates/signoff.html")),
    ("report.md", include_str!("../../templates/report.md")),
    ("page.html", include_str!("../../templates/page.html")),
    ("page.md", include_str!("../../templates/page.md")),
    ("page.css", include_str!("../../templates/page.css")),
    ("blocks.html", include_str!("../../templates/blocks.html")),
    ("blocks.md", include_str!("../../templates/blocks.md")),
    ("block-facts.html", include_str!("../../templates/block-facts.html")),
    ("block-facts.md", include_str!("../../templates/block-facts.md")),
    ("block-figure.html", include_str!("../../templates/block-figure.html")),
    ("block-figure.md", include_str!("../../templates/block-figure.md")),
    ("block-fold.html", include_str!("../../templates/block-fold.html")),
    ("block-footnotes.html", include_str!("../../templates/block-footnotes.html")),
    ("block-footnotes.md", include_str!("../../templates/block-footnotes.md")),
    ("block-head.html", include_str!("../../templates/block-head.html")),
    ("block-head.md", include_str!("../../templates/block-head.md")),
    ("block-heading.html", include_str!("../../templates/block-heading.html")),
    ("block-heading.md", include_str!("../../templates/block-heading.md")),
    ("block-hint.html", include_str!("../../templates/block-hint.html")),
    ("block-hint.md", include_str!("../../templates/block-hint.md")),
    ("block-lead.html", include_str!("../../templates/block-lead.html")),
    ("block-lead.md", include_str!("../../templates/block-lead.md")),
    ("block-link.html", include_str!("../../templates/block-link.html")),
    ("block-link.md", include_str!("../../templates/block-link.md")),
    ("block-list.html", include_str!("../../templates/block-list.html")),
    ("block-list.md", include_str!("../../templates/block-list.md")),
    ("block-method.html", include_str!("../../templates/block-method.html")),
    ("block-method.md", include_str!("../../templates/block-method.md")),
    ("block-paragraph.html", include_str!("../../templates/block-paragraph.html")),
    ("block-paragraph.md", include_str!("../../templates/block-paragraph.md")),
    ("block-reasons.html", include_str!("../../templates/block-reasons.html")),
    ("block-reasons.md", include_str!("../../templates/block-reasons.md")),
    ("block-section.html", include_str!("../../templates/block-section.html")),
    ("block-steps.html", include_str!("../../templates/block-steps.html")),
    ("block-steps.md", include_str!("../../templates/block-steps.md")),
    ("block-table.html", include_str!("../../templates/block-table.html")),
    ("block-table.md", include_str!("../../templates/block-table.md")),
];

/// Largest template file that is read, bytes.
const LARGEST: u64 = 4 << 20;

/// Steps of the template engine that a page may take: those of lists with hundreds of thousands of rows.
const MAX_STEPS: u64 = 50_000_000;

/// Largest page, and most bytes of values that templates write for it, what they keep in variables included.
const MAX_PAGE_BYTES: usize = 256 << 20;

/// What a page is made of, each within bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Budget {
    /// Steps of the template engine.
    Steps,
    /// Bytes that are written.
    Bytes,
}

impl Budget {
    /// What an error of the template engine says to be used up.
    fn used_up(error: &minijinja::Error) -> Option<Budget> {
        match error.kind() {
            ErrorKind::OutOfFuel => Some(Budget::Steps),
            ErrorKind::WriteFailure => Some(Budget::Bytes),
            _ => None,
        }
    }
}

/// Why a report could not be rendered.
#[derive(Debug)]
pub enum ReportError {
    /// A template is wrong.
    Template {
        /// Name of the template.
        name: String,
        /// Line, counted from 1.
        line: Option<usize>,
        /// What is wrong.
        reason: String,
    },
    /// A template takes more than a page may.
    UsedUp {
        /// Name of the template.
        name: String,
        /// Line, counted from 1.
        line: Option<usize>,
        /// What is used up.
        budget: Budget,
    },
    /// A folder of templates replaces nothing.
    NothingReplaced {
        /// The folder.
        path: String,
        /// Names that would be used.
        names: String,
    },
    /// A file could not be read or written.
    Io {
        /// The file.
        path: String,
        /// The reason.
        source: std::io::Error,
    },
    /// A record cannot be written as JSON.
    Json(serde_json::Error),
    /// Verdicts cannot be written as XML.
    Xml(String),
    /// A certificate lacks what it must state.
    Refused(Vec<Note>),
    /// A table cannot be written as Parquet.
    Parquet(String),
    /// This build makes no PDF.
    NoPdf,
    /// This build writes figures as SVG alone.
    SvgOnly,
    /// A page cannot be typeset.
    Pdf(String),
}

impl ReportError {
    /// What is wrong, as a note. What the template engine says is in English.
    pub fn note(&self) -> Note {
        match self {
            ReportError::Template { name, line: None, reason } => {
                note!("template_error.wrong", name = name.as_str(), reason = reason.as_str())
            }
            ReportError::Template { name, line: Some(line), reason } => {
                note!("template_error.wrong_at", name = name.as_str(), line = *line, reason = reason.as_str())
            }
            ReportError::UsedUp { name, line, budget } => {
                let reason = match budget {
                    Budget::Steps => note!("template_error.steps", most = MAX_STEPS),
                    Budget::Bytes => note!("template_error.bytes", most = MAX_PAGE_BYTES),
                };
                let key = if line.is_some() { "template_error.wrong_at" } else { "template_error.wrong" };
                let note = Note::new(key).with("name", name.as_str()).with("reason", reason);
                line.iter().fold(note, |note, line| note.with("line", *line))
            }
            ReportError::NothingReplaced { path, names } => {
                note!("template_error.nothing_replaced", path = path.as_str(), names = names.as_str())
            }
            ReportError::Io { path, source } => {
                note!("template_error.io", path = path.as_str(), reason = io_reason(source))
            }
            ReportError::Json(e) => note!("system.other", reason = e.to_string()),
            ReportError::Xml(reason) | ReportError::Parquet(reason) => {
                note!("system.other", reason = reason.as_str())
            }
            ReportError::Refused(lacking) => {
                let all = lacking.iter().cloned().map(Arg::from).collect();
                note!("dcc.refused", list = Arg::Several(all, "; ".into()))
            }
            ReportError::NoPdf => "pdf.none".into(),
            ReportError::SvgOnly => "figure_paper.svg_only".into(),
            ReportError::Pdf(reason) => note!("pdf.refused", reason = reason.as_str()),
        }
    }
}

impl fmt::Display for ReportError {
    /// In English.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.note().say(Lang::En))
    }
}

impl std::error::Error for ReportError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            ReportError::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

/// A set of templates.
#[derive(Debug, Clone, Default)]
pub struct Renderer {
    overrides: BTreeMap<String, String>,
    signatures: Vec<Signature>,
}

impl Renderer {
    /// The built-in templates.
    pub fn new() -> Renderer {
        Renderer::default()
    }

    /// The built-in templates, with those replaced that stand in a folder under the same name. Other `.html`, `.md`
    /// and `.css` files of the folder can be included by them.
    ///
    /// # Errors
    /// A file that cannot be read, a template that is wrong, or a folder that replaces nothing.
    pub fn with_overrides(folder: &Path) -> Result<Renderer, ReportError> {
        let failed = |path: &Path| {
            let path = path.display().to_string();
            move |source| ReportError::Io { path, source }
        };
        let mut renderer = Renderer::default();
        for entry in std::fs::read_dir(folder).map_err(failed(folder))? {
            let entry = entry.map_err(failed(folder))?;
            let path = entry.path();
            let Some(name) = path.file_name().and_then(|n| n.to_str()).map(str::to_owned) else { continue };
            let known = [".html", ".md", ".css", ".js"].iter().any(|suffix| name.ends_with(suffix));
            let about = std::fs::metadata(&path).map_err(failed(&path))?;
            if !known || !about.is_file() {
                continue;
            }
            let text = read_text(&path, LARGEST).map_err(failed(&path))?;
            renderer.overrides.insert(name, text);
        }
        if !TEMPLATES.iter().any(|(name, _)| renderer.overrides.contains_key(*name)) {
            let names: Vec<&str> = TEMPLATES.iter().map(|t| t.0).collect();
            return Err(ReportError::NothingReplaced {
                path: folder.display().to_string(),
                names: names.join(", "),
            });
        }
        renderer.environment(Lang::default())?;
        Ok(renderer)
    }

    /// The signatures that pages show, as JSON; empty where there are none.
    pub(super) fn signatures_text(&self) -> String {
        match self.signatures.as_slice() {
            [] => String::new(),
            some => serde_json::to_string_pretty(some).unwrap_or_default(),
        }
    }

    /// The signatures that pages show.
    pub(super) fn signatures(&self) -> &[Signature] {
        &self.signatures
    }

    /// The same templates, which show signatures.
    #[must_use]
    pub fn with_signatures(mut self, signatures: Vec<Signature>) -> Renderer {
        self.signatures = signatures;
        self
    }

    fn environment(&self, lang: Lang) -> Result<Environment<'_>, ReportError> {
        let mut env = Environment::new();
        env.set_undefined_behavior(UndefinedBehavior::SemiStrict);
        env.set_fuel(Some(MAX_STEPS));
        let written = AtomicUsize::new(0);
        env.set_auto_escape_callback(|name| match name.rsplit('.').next() {
            Some("html") => AutoEscape::Html,
            Some("md") => AutoEscape::Custom("md".into()),
            _ => AutoEscape::None,
        });
        env.set_formatter(move |out, state, value| {
            // An undefined name goes the ordinary way, which reports it.
            if value.is_undefined() {
                return minijinja::escape_formatter(out, state, value);
            }
            let text = if value.is_none() { String::new() } else { value.to_string() };
            let escaped = match state.auto_escape() {
                _ if value.is_safe() => text,
                AutoEscape::Html => super::svg::escape(&text),
                AutoEscape::Custom(kind) if kind == "md" => prose::markdown(&text),
                _ => text,
            };
            let before = written.fetch_add(escaped.len(), Ordering::Relaxed);
            if before.saturating_add(escaped.len()) > MAX_PAGE_BYTES {
                return Err(ErrorKind::WriteFailure.into());
            }
            out.write_str(&escaped).map_err(minijinja::Error::from)
        });
        let signatures: Vec<SignatureView> = self.signatures.iter().map(|s| s.view(lang)).collect();
        env.add_global("signatures", Value::from(Serde(&signatures)));
        env.add_global("waived", Value::from(Serde(&waived(&self.signatures, lang))));
        let words = Translator { lang };
        env.add_function("t", move |key: String, args: Kwargs| -> Result<String, minijinja::Error> {
            let mut given: Vec<(String, String)> = vec![];
            for name in args.args() {
                given.push((name.to_owned(), args.get::<Value>(name)?.to_string()));
            }
            args.assert_all_used()?;
            let given: Vec<(&str, &str)> = given.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
            Ok(words.with(&key, &given))
        });
        env.add_filter("sha256", |text: String| digest(&text));
        env.add_filter("css_string", |text: String| css_string(&text));
        env.add_filter("unit", move |text: String| words.unit(&text));
        env.add_filter("digits", move |v: f64, n: usize| number::digits(v, n.clamp(1, 15), lang));
        env.add_filter("limit", move |v: f64| number::limit(v, lang));
        env.add_filter("percent", move |v: f64| number::percent(v, lang));
        env.add_filter("count", move |v: u64| number::count(v, lang));
        env.add_filter("duration", move |v: f64| number::duration(v, lang));
        env.add_filter("date", |v: String| number::date_time(&v));
        env.add_filter("prose", prose);
        env.add_filter("formula", prose::formula);
        env.add_filter("say", move |note: Value| say(&note, words));
        for (name, source) in TEMPLATES {
            if !self.overrides.contains_key(*name) {
                env.add_template(name, source).map_err(|e| wrong(&e, name))?;
            }
        }
        for (name, source) in &self.overrides {
            env.add_template(name, source).map_err(|e| wrong(&e, name))?;
        }
        Ok(env)
    }

    /// Renders a template with a context, its last line ended.
    ///
    /// # Errors
    /// [`ReportError::Template`] when the template is wrong.
    pub fn render(&self, name: &str, context: &Value, lang: Lang) -> Result<String, ReportError> {
        let env = self.environment(lang)?;
        let template = env.get_template(name).map_err(|e| wrong(&e, name))?;
        let mut page = Page::default();
        template.render_captured_to(context, &mut page).map_err(|e| wrong(&e, name))?;
        let mut text = String::from_utf8_lossy(&page.0).into_owned();
        if !text.ends_with('\n') {
            text.push('\n');
        }
        Ok(text)
    }
}

/// What the templates of blocks see of a run: with its record.
pub(super) fn run_context(page: Value, record: &RunRecord, lang: Lang) -> Value {
    minijinja::context! { run => Value::from(Serde(record)), ..page_context(page, lang) }
}

/// What the templates of blocks see.
pub(super) fn page_context(page: Value, lang: Lang) -> Value {
    minijinja::context! { v => page, locale => Value::from_object(Texts(lang)) }
}

/// The table of texts of a language. A template looks up what it asks for; thousands of texts are not copied for each page.
#[derive(Debug)]
struct Texts(Lang);

impl Object for Texts {
    fn get_value(self: &Arc<Self>, key: &Value) -> Option<Value> {
        table(self.0).get(key.as_str()?).map(|text| Value::from(text.as_str()))
    }

    fn enumerate(self: &Arc<Self>) -> Enumerator {
        self.mapped_enumerator(|texts| Box::new(table(texts.0).keys().map(|key| Value::from(key.as_str()))))
    }
}

/// What a template sees whose page is to be printed.
pub(super) fn paper_context(context: Value) -> Value {
    minijinja::context! { paper => true, ..context }
}

/// A page in the making, of a bounded size.
#[derive(Debug, Default)]
struct Page(Vec<u8>);

impl Write for Page {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0.len() + bytes.len() > MAX_PAGE_BYTES {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn wrong(error: &minijinja::Error, name: &str) -> ReportError {
    let place = || (error.name().unwrap_or(name).to_owned(), error.line());
    if let Some(used_up) = Budget::used_up(error) {
        let (name, line) = place();
        return ReportError::UsedUp { name, line, budget: used_up };
    }
    let mut reason = error.kind().to_string();
    if let Some(detail) = error.detail() {
        reason = format!("{reason}: {detail}");
    }
    ReportError::Template { name: error.name().unwrap_or(name).to_owned(), line: error.line(), reason }
}

/// A note of the serialised record in words.
fn say(note: &Value, words: Translator) -> String {
    let part = |name: &str| note.get_attr(name).ok().filter(|v| !v.is_undefined());
    let id = part("id").map(|v| v.to_string()).unwrap_or_default();
    let Some(pattern) = lookup(words.lang, &id) else {
        return part("text").map_or(id, |v| v.to_string());
    };
    let args = part("args");
    crate::i18n::fill(pattern, |name| {
        let value = args.as_ref()?.get_attr(name).ok().filter(|v| !v.is_undefined())?;
        Some(match (value.is_integer(), f64::try_from(value.clone())) {
            (true, _) => u64::try_from(value.clone())
                .map_or_else(|_| value.to_string(), |n| number::count(n, words.lang)),
            (false, Ok(v)) => number::limit_digits(v, 4, words.lang),
            (false, Err(_)) if value.get_attr("id").is_ok_and(|id| !id.is_undefined()) => say(&value, words),
            (false, Err(_)) => {
                let text = value.to_string();
                lookup(words.lang, &text).map_or(text, str::to_owned)
            }
        })
    })
}

/// SHA-256 of an inline script in the form in which a content security policy names it.
fn digest(text: &str) -> String {
    // A browser reads every end of a line as one character.
    base64::engine::general_purpose::STANDARD.encode(Sha256::digest(text.replace("\r\n", "\n")))
}

/// A quoted string of CSS in which nothing can end the string or the style sheet.
fn css_string(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        if c.is_alphanumeric() || matches!(c, ' ' | '.' | ',' | '-' | ':' | '·') {
            out.push(c);
        } else {
            out.push_str(&format!("\\{:x} ", u32::from(c)));
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn css_strings_cannot_be_left() {
        assert_eq!(css_string("SN \"1\"</style>"), "\"SN \\22 1\\22 \\3c \\2f style\\3e \"");
    }

    #[test]
    fn a_script_is_named_by_its_digest() {
        // RFC 4648 form of the digest of nothing.
        assert_eq!(digest(""), "47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=");
        assert_eq!(digest("a\r\nb"), digest("a\nb"));
    }

    #[test]
    fn a_template_looks_texts_up_in_the_table_of_its_language() {
        let asked = "{{ locale['verdict.pass'] }},{{ locale['none'] is defined }},{{ locale | length }}";
        for lang in Lang::ALL {
            let said = Environment::new().render_str(asked, page_context(Value::UNDEFINED, *lang)).unwrap();
            let expected = format!("{},False,{}", table(*lang)["verdict.pass"], table(*lang).len());
            assert_eq!(said, expected);
        }
    }

    #[test]
    fn the_built_in_templates_are_right() {
        Renderer::new().environment(Lang::En).unwrap();
    }
}
