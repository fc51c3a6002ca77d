//! The bench: a serial number is scanned, a verdict is seen, and stays until the next scan.

use super::{page, refused, see_other, value};
use crate::api::{self, Listed, Run};
use crate::catalogue::Catalogue;
use crate::intake::{Form, Given};
use crate::order::State as RunState;
use crate::queue::Job;
use crate::refusal::Refusal;
use crate::routes::{App, Shared};
use crate::texts::Lang;
use axum::extract::{FromRequest, Multipart, Path, Query, Request, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use minijinja::context;
use sagnac_base::estimate::Verdict;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Most recordings that can be chosen.
const MAX_OFFERED: usize = 100;

/// What the page is asked for.
#[derive(Debug, Default, Deserialize)]
pub struct BenchQuery {
    run: Option<String>,
}

/// What the form is filled with.
#[derive(Debug, Default, Serialize)]
struct Filled {
    serial: String,
    part: String,
    lot: String,
    operator: String,
    procedure: String,
    limits: String,
}

impl Filled {
    /// What the last order had, but not its serial number.
    fn by(job: Option<&Job>, tests: &Catalogue) -> Filled {
        let Some(test) = job.map(|job| &job.order.test) else { return Filled::default() };
        let text = |text: &Option<String>| text.clone().unwrap_or_default();
        Filled {
            serial: String::new(),
            part: text(&test.part),
            lot: text(&test.lot),
            operator: text(&test.operator),
            procedure: tests.name(&test.procedure),
            limits: test.limits.as_deref().map(|limits| tests.name(limits)).unwrap_or_default(),
        }
    }

    fn given(given: &Given) -> Filled {
        let text = |text: &Option<String>| text.clone().unwrap_or_default();
        Filled {
            serial: given.serial.clone(),
            part: text(&given.part),
            lot: text(&given.lot),
            operator: text(&given.operator),
            procedure: text(&given.procedure),
            limits: text(&given.limits),
        }
    }
}

/// A test as the bench shows it.
#[derive(Debug, Serialize)]
pub struct Shown {
    #[serde(flatten)]
    run: Run,
    tone: &'static str,
    is_active: bool,
    signatures: Vec<String>,
    folder: String,
    unit: String,
}

impl Shown {
    /// A test; `in_full` with its signatures.
    pub fn of(job: &Job, app: &App, lang: Lang, in_full: bool) -> Shown {
        let place = app.bench.result(&job.order.id);
        let signatures = if in_full && job.outcome().is_some() {
            app.bench.harness.signatures(&place).iter().map(|s| s.of(lang).to_owned()).collect()
        } else {
            vec![]
        };
        let run = Run::of(job, app, lang);
        let tone = match (run.state, run.verdict) {
            (RunState::Queued | RunState::Running, _) => "active",
            (RunState::Cancelled, _) => "cancelled",
            (_, Some(verdict)) => verdict.id(),
            (_, None) => Verdict::Error.id(),
        };
        let unit = super::encoded(&run.serial);
        Shown {
            is_active: run.state.is_active(),
            run,
            tone,
            signatures,
            folder: place.display().to_string(),
            unit,
        }
    }
}

/// The last order.
fn last(app: &App) -> Option<Job> {
    app.bench.queue.list(1, |_| true).into_iter().next()
}

/// `GET /`
pub async fn show(State(app): Shared, Query(query): Query<BenchQuery>, request: Request) -> Response {
    let lang = app.language(request.headers());
    let run = query.run.and_then(|id| app.bench.queue.get(&id));
    let last = last(&app);
    let filled = Filled::by(run.as_ref().or(last.as_ref()), &app.catalogue);
    let recordings = api::newest(&app, MAX_OFFERED).await;
    bench(&app, lang, run.as_ref(), &filled, &recordings, None)
}

fn bench(
    app: &Arc<App>,
    lang: Lang,
    run: Option<&Job>,
    filled: &Filled,
    recordings: &[Listed],
    refusal: Option<&Refusal>,
) -> Response {
    let catalogue = &app.catalogue;
    let values = context! {
        run => value(&run.map(|job| Shown::of(job, app, lang, true))),
        filled => value(filled),
        recordings => value(&recordings),
        procedures => catalogue.shipped.procedures.clone(),
        limits => catalogue.shipped.limits.clone(),
        own => catalogue.own_files(),
        has_rules => !catalogue.rules.is_empty(),
        message => refusal.map(|refusal| refusal.message(lang)),
        back => "/",
    };
    let status = refusal.map_or(StatusCode::OK, |refusal| refusal.status);
    (status, page(app, lang, "bench.html", values)).into_response()
}

/// `POST /bench`: orders a test and shows it. The recording is the one that is given, or else the newest one that has the serial
/// number in its name.
pub async fn order(State(app): Shared, request: Request) -> Response {
    let lang = app.language(request.headers());
    let mut given = Given::default();
    match take(&app, request, &mut given).await {
        Ok(job) => see_other(&format!("/?run={}", job.order.id)),
        Err(refusal) => {
            let recordings = api::newest(&app, MAX_OFFERED).await;
            bench(&app, lang, None, &Filled::given(&given), &recordings, Some(&refusal))
        }
    }
}

async fn take(app: &Arc<App>, request: Request, given: &mut Given) -> Result<Job, Refusal> {
    let malformed = |_| Refusal::new(StatusCode::BAD_REQUEST, "malformed");
    let parts = Multipart::from_request(request, &()).await.map_err(malformed)?;
    let mut form = Form::read(parts, Some(&app.uploads)).await?;
    let file = form.file.take();
    *given = form.given()?;
    let mut order = given.clone();
    let has_rule = order.part.as_deref().is_some_and(|part| app.catalogue.of_part(part).is_some());
    if order.procedure.is_none()
        && !has_rule
        && let Some(last) = last(app)
    {
        let used = Filled::by(Some(&last), &app.catalogue);
        order.procedure = Some(used.procedure);
        order.limits = order.limits.or(Some(used.limits)).filter(|limits| !limits.is_empty());
    }
    if file.is_none() && order.recording.is_none() && !order.serial.is_empty() {
        let (owned, serial) = (Arc::clone(app), order.serial.clone());
        let found = tokio::task::spawn_blocking(move || owned.recordings.of_serial(&serial)).await;
        order.recording = found.ok().flatten().map(|found| found.name);
        if order.recording.is_none() {
            return Err(Refusal::of(
                StatusCode::UNPROCESSABLE_ENTITY,
                "no_recording_of_serial",
                &order.serial,
            ));
        }
    }
    api::place(app, order, file).await
}

/// `POST /runs/ID/cancel`
pub async fn cancel(State(app): Shared, Path(id): Path<String>, request: Request) -> Response {
    let lang = app.language(request.headers());
    match api::cancelled(&app, &id).await {
        Ok(()) => see_other(&format!("/?run={id}")),
        Err(refusal) => (refusal.status, refused(&app, lang, &refusal)).into_response(),
    }
}
