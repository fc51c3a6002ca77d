//! Tests that wait and run, with the lines of their progress.

use super::bench::Shown;
use super::{page, value};
use crate::order::State as RunState;
use crate::queue::Job;
use crate::routes::Shared;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use minijinja::context;

/// Most tests on the page.
const MAX_SHOWN: usize = 50;

/// `GET /live`
pub async fn show(State(app): Shared, headers: HeaderMap) -> Response {
    let lang = app.language(&headers);
    let mut active = app.bench.queue.list(usize::MAX, |job| job.state.is_active());
    active.reverse();
    let waiting = active.len();
    // Those that run come first.
    active.sort_by_key(|job| job.state == RunState::Queued);
    active.truncate(MAX_SHOWN);
    let ended = app.bench.queue.list(10, |job| !job.state.is_active());
    let show =
        |jobs: &[Job]| value(&jobs.iter().map(|job| Shown::of(job, &app, lang, false)).collect::<Vec<_>>());
    let values = context! {
        active => show(&active), ended => show(&ended), waiting, jobs => app.bench.setup.jobs, back => "/live",
    };
    page(&app, lang, "live.html", values).into_response()
}
