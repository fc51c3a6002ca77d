//! The pages, made by the server: they work without a script, which only keeps them up to date.

pub mod bench;
pub mod live;
pub mod lots;
pub mod session;
pub mod unit;

use crate::refusal::Refusal;
use crate::routes::{App, Shared};
use crate::texts::{Lang, filled};
use axum::extract::{Path, State};
use axum::http::{StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use minijinja::value::{Kwargs, Serde, Value};
use minijinja::{Environment, context};
use serde::Serialize;

/// Templates by name.
const TEMPLATES: &[(&str, &str)] = &[
    ("page.html", include_str!("../../templates/page.html")),
    ("blocks.html", include_str!("../../templates/blocks.html")),
    ("bench.html", include_str!("../../templates/bench.html")),
    ("unit.html", include_str!("../../templates/unit.html")),
    ("units.html", include_str!("../../templates/units.html")),
    ("lots.html", include_str!("../../templates/lots.html")),
    ("live.html", include_str!("../../templates/live.html")),
    ("login.html", include_str!("../../templates/login.html")),
    ("refused.html", include_str!("../../templates/refused.html")),
];

/// Files beside the pages: name, type, contents.
const ASSETS: &[(&str, &str, &str)] = &[
    ("bench.css", "text/css; charset=utf-8", include_str!("../../assets/bench.css")),
    ("bench.js", "text/javascript; charset=utf-8", include_str!("../../assets/bench.js")),
];

/// The templates. Names end in `.html`, so that every value is escaped.
pub fn templates() -> Environment<'static> {
    let mut templates = Environment::new();
    for (name, source) in TEMPLATES {
        // One that cannot be read is missing in every page and in every test.
        let _ = templates.add_template(name, source);
    }
    templates
}

/// What serialises, as a value of a template.
fn value(of: &impl Serialize) -> Value {
    Value::from(Serde(of))
}

/// A page in a language.
fn page(app: &App, lang: Lang, name: &str, values: Value) -> Html<String> {
    let t = Value::from_function(move |key: String, arguments: Kwargs| -> Result<String, minijinja::Error> {
        let given: Vec<(String, String)> = arguments
            .args()
            .map(|name| Ok((name.to_owned(), arguments.get::<Value>(name)?.to_string())))
            .collect::<Result<_, minijinja::Error>>()?;
        let given: Vec<(&str, &str)> = given.iter().map(|(n, v)| (n.as_str(), v.as_str())).collect();
        Ok(filled(&key, &given, lang))
    });
    let values = context! { t, lang => lang.code(), ..values };
    let rendered = app.templates.get_template(name).and_then(|template| template.render(values));
    Html(rendered.unwrap_or_else(|e| {
        app.bench.harness.log(&format!("{name}: {e}"));
        String::new()
    }))
}

/// The page of a refusal; without the token, the one that asks for it.
pub fn refused(app: &App, lang: Lang, refusal: &Refusal) -> Html<String> {
    if refusal.status == StatusCode::UNAUTHORIZED {
        return page(app, lang, "login.html", context! { is_wrong => refusal.code == "token_wrong" });
    }
    page(app, lang, "refused.html", context! { message => refusal.message(lang) })
}

/// `GET /assets/FILE`
pub async fn asset(State(app): Shared, Path(file): Path<String>) -> Response {
    match ASSETS.iter().find(|(name, ..)| *name == file) {
        Some((_, kind, text)) => ([(header::CONTENT_TYPE, *kind)], *text).into_response(),
        None => {
            let refusal = Refusal::new(StatusCode::NOT_FOUND, "not_found");
            (refusal.status, refused(&app, app.bench.setup.lang, &refusal)).into_response()
        }
    }
}

/// A page that a form leads to.
fn see_other(place: &str) -> Response {
    (StatusCode::SEE_OTHER, [(header::LOCATION, place.to_owned())]).into_response()
}

/// A text as a part of an address.
fn encoded(text: &str) -> String {
    let mut out = String::new();
    for byte in text.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte) {
            out.push(byte.into());
        } else {
            out.push_str(&format!("%{byte:02X}"));
        }
    }
    out
}
