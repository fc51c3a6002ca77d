//! A unit: its attempts, its charts, and a further attempt with its reason.

use super::bench::Shown;
use super::{encoded, page, refused, see_other, value};
use crate::refusal::Refusal;
use crate::routes::{App, Shared};
use crate::texts::Lang;
use crate::worker::Bench;
use axum::extract::{Path, Query, Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use minijinja::context;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

/// Most attempts on a page.
const MAX_ATTEMPTS: usize = 200;
/// Most units in a list.
const MAX_UNITS: usize = 200;
/// Longest time in which charts are drawn.
const MAX_CHART_TIME: Duration = Duration::from_secs(30);
/// Pause between two looks at the process that draws.
const POLL: Duration = Duration::from_millis(20);
/// What charts may do: as the pages of results.
const CHART_POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// What is searched for.
#[derive(Debug, Default, Deserialize)]
pub struct FindQuery {
    #[serde(default)]
    serial: String,
}

/// `GET /units`: the page of a serial number, or the units that were tested last.
pub async fn find(State(app): Shared, headers: HeaderMap, Query(query): Query<FindQuery>) -> Response {
    let serial = query.serial.trim();
    let is_known = app.bench.queue.read(|mut jobs| jobs.any(|job| job.order.test.serial == serial));
    if is_known {
        return see_other(&format!("/units/{}", encoded(serial)));
    }
    let wanted = serial.to_lowercase();
    let mut seen = BTreeSet::new();
    let jobs = app.bench.queue.list(usize::MAX, |job| job.order.test.serial.to_lowercase().contains(&wanted));
    let lang = app.language(&headers);
    let units = jobs.iter().filter(|job| seen.insert(job.order.test.serial.clone())).take(MAX_UNITS);
    let units: Vec<Shown> = units.map(|job| Shown::of(job, &app, lang, false)).collect();
    page(&app, lang, "units.html", context! { units => value(&units), serial, back => "/units" })
        .into_response()
}

/// `GET /units/SERIAL`
pub async fn show(State(app): Shared, Path(serial): Path<String>, request: Request) -> Response {
    let lang = app.language(request.headers());
    let jobs = app.bench.queue.list(MAX_ATTEMPTS, |job| job.order.test.serial == serial);
    let Some(last) = jobs.first() else { return missing(&app, lang) };
    let attempts: Vec<Shown> = jobs.iter().map(|job| Shown::of(job, &app, lang, true)).collect();
    let test = &last.order.test;
    let address = format!("/units/{}", encoded(&serial));
    let values = context! {
        serial,
        attempts => value(&attempts),
        part => test.part.clone(),
        lot => test.lot.clone(),
        operator => test.operator.clone(),
        procedure => test.procedure.display().to_string(),
        limits => test.limits.as_ref().map(|limits| limits.display().to_string()),
        recordings => value(&crate::api::newest(&app, MAX_UNITS).await),
        has_charts => app.bench.setup.store.is_some(),
        back => address.clone(),
        address,
    };
    page(&app, lang, "unit.html", values).into_response()
}

fn missing(app: &App, lang: Lang) -> Response {
    let refusal = Refusal::new(StatusCode::NOT_FOUND, "not_found");
    (refusal.status, refused(app, lang, &refusal)).into_response()
}

/// `GET /units/SERIAL/charts`: what the store tells of the unit over time.
pub async fn charts(State(app): Shared, Path(serial): Path<String>, request: Request) -> Response {
    let lang = app.language(request.headers());
    let is_known = app.bench.queue.read(|mut jobs| jobs.any(|job| job.order.test.serial == serial));
    let Some(store) = app.bench.setup.store.clone().filter(|_| is_known) else { return missing(&app, lang) };
    let Ok(_slot) = app.charts.acquire().await else { return missing(&app, lang) };
    let bench = Arc::clone(&app.bench);
    let draw = move || {
        let mut command = Command::new(&bench.setup.program);
        command.arg("history").arg("--store").arg(store).args(["--format", "html", "--lang", lang.code()]);
        command.arg("--").arg(serial);
        drawn(&bench, command)
    };
    match tokio::task::spawn_blocking(draw).await.ok().flatten() {
        Some(html) => {
            let mut response = Html(html).into_response();
            let policy = HeaderValue::from_static(CHART_POLICY);
            response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, policy);
            response
        }
        None => missing(&app, lang),
    }
}

/// What a process draws, in a file of its own; `None` where it fails or takes too long.
fn drawn(bench: &Bench, mut command: Command) -> Option<Vec<u8>> {
    let path = bench.setup.data.join("charts.html");
    let file = std::fs::File::create(&path).ok()?;
    let mut child = command.stdin(Stdio::null()).stdout(file).stderr(Stdio::null()).spawn().ok()?;
    let began = std::time::Instant::now();
    let status = loop {
        match child.try_wait().ok()? {
            Some(status) => break status,
            None if began.elapsed() > MAX_CHART_TIME => {
                child.kill().ok()?;
                child.wait().ok()?;
                return None;
            }
            None => std::thread::sleep(POLL),
        }
    };
    let html = std::fs::read(&path).ok();
    std::fs::remove_file(&path).ok()?;
    html.filter(|_| status.success())
}
