//! From a request to an order: every name is resolved to what may be read, before anything is queued.

use crate::catalogue::Catalogue;
use crate::order::Test;
use crate::recordings::{NotFound, Roots};
use crate::refusal::Refusal;
use crate::uploads::{Upload, Uploads, malformed};
use axum::extract::Multipart;
use axum::http::StatusCode;
use serde::Deserialize;
use std::time::Duration;

/// Most characters of a text that is given.
const MAX_TEXT_CHARACTERS: usize = 200;
/// Most bytes of a text that is given, before it is looked at.
const MAX_TEXT_BYTES: usize = 4096;
/// Most fields of a form.
const MAX_FIELDS: usize = 32;
/// Longest time in which a field arrives that is no file.
const MAX_FIELD_TIME: Duration = Duration::from_secs(30);

/// What a request gives.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Given {
    /// Serial number.
    pub serial: String,
    /// Recording, by its name below a folder.
    pub recording: Option<String>,
    /// Procedure.
    pub procedure: Option<String>,
    /// Limits.
    pub limits: Option<String>,
    /// Part number.
    pub part: Option<String>,
    /// Lot.
    pub lot: Option<String>,
    /// Operator.
    pub operator: Option<String>,
    /// Why the unit is tested again.
    pub reason: Option<String>,
}

/// A form: its fields, and a file.
#[derive(Debug, Default)]
pub struct Form {
    /// Fields by name.
    pub fields: Vec<(String, String)>,
    /// The file.
    pub file: Option<Upload>,
}

impl Form {
    /// Reads a form; a file is taken only where `uploads` are given.
    ///
    /// # Errors
    /// A form that is malformed, too large or too slow, and what [`Uploads::take`] refuses.
    pub async fn read(mut parts: Multipart, uploads: Option<&Uploads>) -> Result<Form, Refusal> {
        let slow = |_| Refusal::new(StatusCode::REQUEST_TIMEOUT, "too_slow");
        let mut form = Form::default();
        for _ in 0..MAX_FIELDS {
            let next = tokio::time::timeout(MAX_FIELD_TIME, parts.next_field()).await.map_err(slow)?;
            let Some(mut field) = next.map_err(|e| malformed(&e))? else { return Ok(form) };
            let name = field.name().unwrap_or_default().to_owned();
            if name == "file" {
                let uploads = uploads.ok_or_else(|| Refusal::new(StatusCode::BAD_REQUEST, "malformed"))?;
                // A form without a file has an empty one without a name.
                if field.file_name().is_some_and(|label| !label.is_empty()) {
                    if form.file.is_some() {
                        return Err(Refusal::new(StatusCode::BAD_REQUEST, "malformed"));
                    }
                    form.file = Some(uploads.take(field).await?);
                }
                continue;
            }
            let mut text = vec![];
            let all = async {
                while let Some(chunk) = field.chunk().await.map_err(|e| malformed(&e))? {
                    text.extend_from_slice(&chunk);
                    if text.len() > MAX_TEXT_BYTES {
                        return Err(Refusal::of(StatusCode::BAD_REQUEST, "text", &name));
                    }
                }
                Ok(())
            };
            tokio::time::timeout(MAX_FIELD_TIME, all).await.map_err(slow)??;
            let text = String::from_utf8(text);
            form.fields
                .push((name.clone(), text.map_err(|_| Refusal::of(StatusCode::BAD_REQUEST, "text", &name))?));
        }
        Err(Refusal::new(StatusCode::BAD_REQUEST, "malformed"))
    }

    /// The text of a field; empty without it.
    pub fn field(&self, name: &str) -> &str {
        self.fields.iter().find(|(known, _)| known == name).map_or("", |(_, text)| text)
    }

    /// What a form gives. A field that is not known is refused, as in JSON.
    ///
    /// # Errors
    /// A field that is not known.
    pub fn given(&self) -> Result<Given, Refusal> {
        let mut given = Given::default();
        for (name, text) in &self.fields {
            let text = Some(text.trim().to_owned()).filter(|text| !text.is_empty());
            match name.as_str() {
                "serial" => given.serial = text.unwrap_or_default(),
                "recording" => given.recording = text,
                "procedure" => given.procedure = text,
                "limits" => given.limits = text,
                "part" => given.part = text,
                "lot" => given.lot = text,
                "operator" => given.operator = text,
                "reason" => given.reason = text,
                _ => return Err(Refusal::of(StatusCode::BAD_REQUEST, "unknown_field", name)),
            }
        }
        Ok(given)
    }
}

/// The test that is asked for.
///
/// # Errors
/// What is missing, unknown or elsewhere.
pub fn test(given: &Given, file: Option<Upload>, roots: &Roots, tests: &Catalogue) -> Result<Test, Refusal> {
    let bad = |code, detail: &str| Refusal::of(StatusCode::UNPROCESSABLE_ENTITY, code, detail);
    let serial = text("serial", Some(&given.serial))?.ok_or_else(|| bad("serial", ""))?;
    let part = text("part", given.part.as_ref())?;
    let rule = part.as_deref().filter(|_| given.procedure.is_none()).and_then(|part| tests.of_part(part));
    let procedure = given.procedure.as_deref().or(rule.map(|rule| rule.procedure.as_str()));
    let procedure = procedure.ok_or_else(|| bad("no_procedure", ""))?;
    let limits = given.limits.as_deref().or(rule.and_then(|rule| rule.limits.as_deref()));
    let mut test = Test {
        serial,
        part,
        lot: text("lot", given.lot.as_ref())?,
        operator: text("operator", given.operator.as_ref())?,
        reason: text("reason", given.reason.as_ref())?,
        procedure: tests.procedure(procedure).ok_or_else(|| bad("procedure", procedure))?,
        limits: limits.map(|l| tests.limits(l).ok_or_else(|| bad("limits", l))).transpose()?,
        ..Test::default()
    };
    match (file, given.recording.as_deref()) {
        (Some(_), Some(_)) => return Err(bad("two_recordings", "")),
        (Some(file), None) => (test.path, test.recording) = file.keep(),
        (None, Some(name)) => {
            test.path = roots.resolve(name).map_err(|why| match why {
                NotFound::Missing => bad("recording_missing", name),
                NotFound::Outside => Refusal::of(StatusCode::FORBIDDEN, "recording_outside", name),
            })?;
            test.recording = name.to_owned();
        }
        (None, None) => return Err(bad("no_recording", "")),
    }
    Ok(test)
}

/// A text of one line and bounded length; `None` where it is empty.
fn text(name: &str, given: Option<&String>) -> Result<Option<String>, Refusal> {
    let Some(given) = given.map(|text| text.trim()).filter(|text| !text.is_empty()) else { return Ok(None) };
    if given.chars().any(char::is_control) || given.chars().count() > MAX_TEXT_CHARACTERS {
        return Err(Refusal::of(StatusCode::UNPROCESSABLE_ENTITY, "text", name));
    }
    Ok(Some(given.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::{Rule, Shipped};

    #[test]
    fn a_part_number_chooses_the_test_and_what_is_given_wins() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.csv"), "").unwrap();
        let roots = Roots::new(&[folder.path().to_owned()]).unwrap();
        let rule = |part: &str, limits: &str| Rule {
            part: part.to_owned(),
            procedure: "static-bias".to_owned(),
            limits: Some(limits.to_owned()),
        };
        let names = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
        let tests = Catalogue {
            shipped: Shipped {
                procedures: names(&["static-bias", "warm-up"]),
                limits: names(&["one", "two"]),
            },
            own: Roots::default(),
            rules: vec![rule("A-*", "one"), rule("*", "two")],
        };
        let given = Given {
            serial: " SN-1 ".to_owned(),
            recording: Some("a.csv".to_owned()),
            part: Some("A-7".to_owned()),
            ..Given::default()
        };
        let of = |given: &Given| test(given, None, &roots, &tests);
        let test = of(&given).unwrap();
        assert_eq!(
            (test.serial.as_str(), test.procedure_name(), test.limits_name()),
            ("SN-1", "static-bias".into(), "one".into())
        );
        let other = Given { part: Some("B".to_owned()), ..given.clone() };
        assert_eq!(of(&other).unwrap().limits_name(), "two");
        let chosen = Given { procedure: Some("warm-up".to_owned()), ..given.clone() };
        assert_eq!(of(&chosen).unwrap().limits, None);
        let code = |given: Given| of(&given).unwrap_err().code;
        assert_eq!(code(Given { part: None, ..given.clone() }), "no_procedure");
        assert_eq!(code(Given { serial: " ".to_owned(), ..given.clone() }), "serial");
        assert_eq!(code(Given { serial: "a\nb".to_owned(), ..given.clone() }), "text");
        assert_eq!(code(Given { lot: Some("x".repeat(201)), ..given.clone() }), "text");
        assert_eq!(code(Given { procedure: Some("none".to_owned()), ..given.clone() }), "procedure");
        assert_eq!(code(Given { limits: Some("none".to_owned()), ..given.clone() }), "limits");
        assert_eq!(code(Given { recording: None, ..given.clone() }), "no_recording");
        assert_eq!(
            code(Given { recording: Some("../a.csv".to_owned()), ..given.clone() }),
            "recording_outside"
        );
        assert_eq!(code(Given { recording: Some("b.csv".to_owned()), ..given }), "recording_missing");
    }
}
