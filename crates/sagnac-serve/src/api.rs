//! The programming interface: JSON, and streams of events.

use crate::events::{Event, Events};
use crate::intake::{self, Form, Given};
use crate::openapi;
use crate::order::{End, State as RunState};
use crate::queue::{Job, MAX_WAITING, NotTaken, now};
use crate::refusal::Refusal;
use crate::results;
use crate::routes::{API, App, MAX_BODY_BYTES, Shared, refused};
use crate::setup::Rule;
use crate::texts::{Lang, filled};
use axum::Json;
use axum::body::to_bytes;
use axum::extract::{FromRequest, Multipart, Path, Query, Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::sse::{self, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use sagnac_base::estimate::Verdict;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, watch};

/// Pause between two signs of life on a stream.
const STREAM_SIGN: Duration = Duration::from_secs(15);
/// Tests in a list where none is asked for.
const USUAL_LIST: usize = 100;
/// Most tests in a list.
const MAX_LIST: usize = 1000;
/// Most recordings in a list.
const MAX_RECORDINGS: usize = 200;
/// Head by which a client takes up a stream again.
const LAST_EVENT: &str = "last-event-id";

/// A test, as programs and pages get it.
#[derive(Debug, Clone, Serialize)]
pub struct Run {
    /// Id.
    pub id: String,
    /// Where it is.
    pub state: RunState,
    /// Place among those that wait, from 1.
    pub place: Option<usize>,
    /// Serial number.
    pub serial: String,
    /// Part number.
    pub part: Option<String>,
    /// Lot.
    pub lot: Option<String>,
    /// Operator.
    pub operator: Option<String>,
    /// Why the unit was tested again.
    pub reason: Option<String>,
    /// Recording, as it was named.
    pub recording: String,
    /// Procedure.
    pub procedure: String,
    /// Limits; empty without.
    pub limits: String,
    /// When it was ordered, RFC 3339.
    pub ordered_at: String,
    /// When it ended, RFC 3339.
    pub ended_at: Option<String>,
    /// The last line of progress.
    pub progress: Option<String>,
    /// Verdict of the result.
    pub verdict: Option<Verdict>,
    /// Why the unit does not pass, in the language of the client.
    pub reasons: Vec<String>,
    /// What to do, in the language of the client.
    pub next: Option<String>,
    /// What the process said where there is no result.
    pub said: Option<String>,
    /// Where its events are.
    pub events: String,
    /// Where its result is.
    pub result: Option<String>,
    /// Where its report is.
    pub report: Option<String>,
}

impl Run {
    /// A test in a language.
    pub fn of(job: &Job, app: &App, lang: Lang) -> Run {
        let (order, test) = (&job.order, &job.order.test);
        let outcome = job.outcome();
        let file = |name: &str| outcome.map(|_| format!("{API}/results/{}/{name}", order.id));
        Run {
            id: order.id.clone(),
            state: job.state,
            place: app.bench.queue.place(&order.id),
            serial: test.serial.clone(),
            part: test.part.clone(),
            lot: test.lot.clone().or_else(|| outcome.and_then(|o| o.lot.clone())),
            operator: test.operator.clone(),
            reason: test.reason.clone(),
            recording: test.recording.clone(),
            procedure: test.procedure_name(),
            limits: test.limits_name(),
            ordered_at: order.ordered_at.clone(),
            ended_at: job.end.as_ref().map(|(at, _)| at.clone()),
            progress: job.events.last_progress(),
            verdict: outcome.map(|o| o.verdict),
            reasons: outcome.map_or(vec![], |o| o.reasons.iter().map(|r| r.of(lang).to_owned()).collect()),
            next: outcome.map(|o| next(&o.next, lang)),
            said: match &job.end {
                Some((_, End::Failed { said })) => Some(said.clone()),
                _ => None,
            },
            events: format!("{API}/runs/{}/events", order.id),
            result: file("result.json"),
            report: file("report.html"),
        }
    }
}

/// What to do after a verdict, in words.
fn next(next: &crate::harness::Next, lang: Lang) -> String {
    use crate::harness::Next;
    let key = match next {
        Next::HandOn => "next.hand_on",
        Next::SetAside => "next.set_aside",
        Next::CheckSerial => "next.check_serial",
        Next::MeetCondition => "next.meet_condition",
        Next::RecordLonger(hours) => {
            let hours = format!("{hours:.1}").replace('.', lang.decimal_mark());
            return filled("next.record_longer", &[("hours", &hours)], lang);
        }
        Next::ReadReport => "next.read_report",
        Next::ChooseLimits => "next.choose_limits",
        Next::CheckRecording => "next.check_recording",
    };
    filled(key, &[], lang)
}

/// A refusal with what is needed to say it.
pub struct Refused<'a> {
    app: &'a App,
    headers: &'a HeaderMap,
}

impl<'a> Refused<'a> {
    fn new(app: &'a App, headers: &'a HeaderMap) -> Refused<'a> {
        Refused { app, headers }
    }

    fn say(&self, refusal: &Refusal) -> Response {
        refused(self.app, API, self.headers, refusal)
    }
}

/// `GET /healthz`
pub async fn health() -> Json<Value> {
    Json(json!({ "status": "ok" }))
}

/// `GET /api/v1/openapi.json`
pub async fn openapi() -> Json<Value> {
    Json(openapi::description())
}

/// `POST /api/v1/runs`
pub async fn order(State(app): Shared, request: Request) -> Response {
    let headers = request.headers().clone();
    let refused = Refused::new(&app, &headers);
    match take(&app, request).await {
        Ok(job) => {
            let run = Run::of(&job, &app, app.language(&headers));
            let place = format!("{API}/runs/{}", run.id);
            (StatusCode::ACCEPTED, [(header::LOCATION, place)], Json(run)).into_response()
        }
        Err(refusal) => refused.say(&refusal),
    }
}

async fn take(app: &Arc<App>, request: Request) -> Result<Job, Refusal> {
    let kind = request.headers().get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    if kind.is_some_and(|kind| kind.to_ascii_lowercase().starts_with("multipart/")) {
        let parts = Multipart::from_request(request, &()).await;
        let parts = parts.map_err(|_| Refusal::new(StatusCode::BAD_REQUEST, "malformed"))?;
        let mut form = Form::read(parts, Some(&app.uploads)).await?;
        let file = form.file.take();
        return place(app, form.given()?, file).await;
    }
    let slow = |_| Refusal::new(StatusCode::REQUEST_TIMEOUT, "too_slow");
    let body = to_bytes(request.into_body(), MAX_BODY_BYTES);
    let body = tokio::time::timeout(STREAM_SIGN, body).await.map_err(slow)?;
    let body = body.map_err(|_| Refusal::new(StatusCode::PAYLOAD_TOO_LARGE, "body"))?;
    let given: Given = serde_json::from_slice(&body)
        .map_err(|e| Refusal::of(StatusCode::BAD_REQUEST, "json", &e.to_string()))?;
    place(app, given, None).await
}

/// Places an order, where what it names may be read.
///
/// # Errors
/// What is refused.
pub async fn place(
    app: &Arc<App>,
    given: Given,
    file: Option<crate::uploads::Upload>,
) -> Result<Job, Refusal> {
    let app = Arc::clone(app);
    let placed = tokio::task::spawn_blocking(move || {
        let test = intake::test(&given, file, &app.recordings, &app.catalogue)?;
        app.bench.queue.order(test, now()).map_err(|why| match why {
            NotTaken::Full => {
                Refusal::of(StatusCode::SERVICE_UNAVAILABLE, "queue_full", &MAX_WAITING.to_string())
            }
            NotTaken::NotWritten(e) => {
                app.bench.harness.log(&format!("queue.jsonl: {e}"));
                Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, "not_written")
            }
        })
    });
    placed.await.unwrap_or_else(|_| Err(Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, "not_written")))
}

/// What a list is asked for.
#[derive(Debug, Default, Deserialize)]
pub struct ListQuery {
    state: Option<String>,
    serial: Option<String>,
    limit: Option<usize>,
}

/// `GET /api/v1/runs`
pub async fn list(State(app): Shared, headers: HeaderMap, Query(query): Query<ListQuery>) -> Response {
    let most = query.limit.unwrap_or(USUAL_LIST).min(MAX_LIST);
    let wanted = |job: &Job| {
        query.state.as_deref().is_none_or(|state| state == job.state.id())
            && query.serial.as_deref().is_none_or(|serial| serial == job.order.test.serial)
    };
    let lang = app.language(&headers);
    let jobs = app.bench.queue.list(most, wanted);
    let runs: Vec<Run> = jobs.iter().map(|job| Run::of(job, &app, lang)).collect();
    Json(json!({ "runs": runs })).into_response()
}

/// `GET /api/v1/runs/ID`
pub async fn run(State(app): Shared, headers: HeaderMap, Path(id): Path<String>) -> Response {
    match app.bench.queue.get(&id) {
        Some(job) => Json(Run::of(&job, &app, app.language(&headers))).into_response(),
        None => Refused::new(&app, &headers).say(&Refusal::new(StatusCode::NOT_FOUND, "not_found")),
    }
}

/// `DELETE /api/v1/runs/ID`
pub async fn cancel(State(app): Shared, headers: HeaderMap, Path(id): Path<String>) -> Response {
    let cancelled = cancelled(&app, &id).await;
    let refused = Refused::new(&app, &headers);
    match (cancelled, app.bench.queue.get(&id)) {
        (Ok(()), Some(job)) => {
            let run = Run::of(&job, &app, app.language(&headers));
            (StatusCode::ACCEPTED, Json(run)).into_response()
        }
        (Ok(()), None) => refused.say(&Refusal::new(StatusCode::NOT_FOUND, "not_found")),
        (Err(refusal), _) => refused.say(&refusal),
    }
}

/// Cancels a test.
///
/// # Errors
/// One that is not known or has ended.
pub async fn cancelled(app: &Arc<App>, id: &str) -> Result<(), Refusal> {
    let (owned, id) = (Arc::clone(app), id.to_owned());
    let done = tokio::task::spawn_blocking(move || owned.bench.queue.cancel(&id, now())).await;
    match done {
        Ok(Ok(Some(true))) => Ok(()),
        Ok(Ok(Some(false))) => Err(Refusal::new(StatusCode::CONFLICT, "has_ended")),
        Ok(Ok(None)) => Err(Refusal::new(StatusCode::NOT_FOUND, "not_found")),
        _ => Err(Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, "not_written")),
    }
}

/// A stream of events on its way.
struct Following {
    events: Arc<Events>,
    changes: watch::Receiver<u64>,
    ready: VecDeque<Event>,
    last: u64,
    is_over: bool,
    _slot: OwnedSemaphorePermit,
}

impl Following {
    async fn next(mut self) -> Option<(Result<sse::Event, Infallible>, Following)> {
        loop {
            if let Some(event) = self.ready.pop_front() {
                self.last = event.number;
                let sent = sse::Event::default()
                    .id(event.number.to_string())
                    .event(event.name)
                    .data(event.data.to_string());
                return Some((Ok(sent), self));
            }
            if self.is_over {
                return None;
            }
            // Marked as seen before looking, so that no event is missed between the two.
            self.changes.borrow_and_update();
            let (new, is_over) = self.events.after(self.last);
            self.is_over = is_over;
            if new.is_empty() && !is_over && self.changes.changed().await.is_err() {
                return None;
            }
            self.ready.extend(new);
        }
    }
}

/// `GET /api/v1/runs/ID/events`
pub async fn events(State(app): Shared, headers: HeaderMap, Path(id): Path<String>) -> Response {
    let refused = Refused::new(&app, &headers);
    let Some(job) = app.bench.queue.get(&id) else {
        return refused.say(&Refusal::new(StatusCode::NOT_FOUND, "not_found"));
    };
    let Ok(slot) = app.streams.clone().try_acquire_owned() else {
        return refused.say(&Refusal::new(StatusCode::SERVICE_UNAVAILABLE, "too_many_streams"));
    };
    let last = headers.get(LAST_EVENT).and_then(|id| id.to_str().ok()?.trim().parse().ok()).unwrap_or(0);
    let changes = job.events.follow();
    // A number that was never given is of a server before its restart.
    let last = if last > *changes.borrow() { 0 } else { last };
    let following =
        Following { changes, events: job.events, ready: VecDeque::new(), last, is_over: false, _slot: slot };
    let events = stream::unfold(following, Following::next);
    Sse::new(events).keep_alive(KeepAlive::new().interval(STREAM_SIGN)).into_response()
}

/// `GET /api/v1/units/SERIAL`
pub async fn unit(State(app): Shared, headers: HeaderMap, Path(serial): Path<String>) -> Response {
    let mut jobs = app.bench.queue.list(MAX_LIST, |job| job.order.test.serial == serial);
    if jobs.is_empty() {
        return Refused::new(&app, &headers).say(&Refusal::new(StatusCode::NOT_FOUND, "not_found"));
    }
    jobs.reverse();
    let lang = app.language(&headers);
    let attempts: Vec<Run> = jobs.iter().map(|job| Run::of(job, &app, lang)).collect();
    Json(json!({ "serial": serial, "attempts": attempts })).into_response()
}

/// A recording in a list.
#[derive(Debug, Clone, Serialize)]
pub struct Listed {
    /// Name, as an order takes it.
    pub name: String,
    /// Size, bytes.
    pub bytes: u64,
    /// Time of change, RFC 3339.
    pub modified: String,
}

/// The newest recordings of the folders.
pub async fn newest(app: &Arc<App>, most: usize) -> Vec<Listed> {
    let owned = Arc::clone(app);
    let found = tokio::task::spawn_blocking(move || owned.recordings.newest(most)).await.unwrap_or_default();
    let listed = |found: crate::recordings::Found| Listed {
        modified: crate::queue::moment(found.modified.into()),
        name: found.name,
        bytes: found.bytes,
    };
    found.into_iter().map(listed).collect()
}

/// `GET /api/v1/recordings`
pub async fn recordings(State(app): Shared) -> Json<Value> {
    Json(json!({ "recordings": newest(&app, MAX_RECORDINGS).await }))
}

/// `GET /api/v1/procedures`
pub async fn procedures(State(app): Shared) -> Json<Value> {
    let shipped = &app.catalogue.shipped;
    let rules: &[Rule] = &app.catalogue.rules;
    Json(json!({
        "procedures": shipped.procedures,
        "limits": shipped.limits,
        "own": app.catalogue.own_files(),
        "rules": rules,
    }))
}

/// `GET /api/v1/results/ID/FILE`
pub async fn result(
    State(app): Shared,
    headers: HeaderMap,
    Path((id, file)): Path<(String, String)>,
) -> Response {
    let missing = Refusal::new(StatusCode::NOT_FOUND, "not_found");
    // The id is one of the queue, so that it leads nowhere else.
    let place = app.bench.queue.get(&id).filter(|job| job.outcome().is_some());
    let place = place.and_then(|job| results::below(&app.bench.result(&job.order.id), &file));
    let answer = match place {
        Some(path) => results::answer(&path).await,
        None => Err(missing),
    };
    answer.unwrap_or_else(|refusal| Refused::new(&app, &headers).say(&refusal))
}
