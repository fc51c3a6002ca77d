//! A lot, or a day: units by quantities.

use super::{encoded, page, value};
use crate::lots::{Matrix, Selection};
use crate::queue::{moment, now};
use crate::routes::Shared;
use axum::extract::{Query, State};
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use minijinja::context;
use serde::Deserialize;

/// What is selected; without any part of it, the present day.
#[derive(Debug, Default, Deserialize)]
pub struct LotsQuery {
    lot: Option<String>,
    day: Option<String>,
    procedure: Option<String>,
    verdict: Option<String>,
}

/// `GET /lots`
pub async fn show(State(app): Shared, headers: HeaderMap, Query(query): Query<LotsQuery>) -> Response {
    let lang = app.language(&headers);
    let is_asked = query.lot.is_some() || query.day.is_some() || query.procedure.is_some();
    let today = moment(now()).chars().take(10).collect::<String>();
    let selection = Selection {
        lot: query.lot.unwrap_or_default(),
        day: query.day.unwrap_or_else(|| if is_asked { String::new() } else { today }),
        procedure: query.procedure.unwrap_or_default(),
        verdict: query.verdict.unwrap_or_default(),
    };
    let matrix = app.bench.queue.read(|jobs| Matrix::of(jobs, &selection, lang));
    let share = matrix.first_pass_yield();
    let share = share.map(|share| format!("{share:.1}").replace('.', lang.decimal_mark()));
    let addresses: Vec<String> =
        matrix.rows.iter().map(|row| format!("/units/{}", encoded(&row.serial))).collect();
    let values = context! {
        selection => value(&selection), matrix => value(&matrix), share, addresses, back => "/lots",
    };
    page(&app, lang, "lots.html", values).into_response()
}
