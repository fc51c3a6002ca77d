//! The routes, as one table: the router, the description of the interface and its test come from it.

use crate::api;
use crate::catalogue::Catalogue;
use crate::client::language;
use crate::guard::{Hosts, content_type, has_token, is_safe};
use crate::pages;
use crate::recordings::Roots;
use crate::refusal::Refusal;
use crate::texts::Lang;
use crate::token::Token;
use crate::uploads::{MAX_UPLOAD_TIME, Uploads};
use crate::worker::Bench;
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, delete, get, post};
use axum::{Json, Router};
use minijinja::Environment;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::Semaphore;
use tower_http::limit::RequestBodyLimitLayer;
use tower_http::set_header::SetResponseHeaderLayer;
use tower_http::timeout::TimeoutLayer;

/// Longest answer to a request that uploads nothing.
const MAX_ANSWER_TIME: Duration = Duration::from_secs(60);
/// Largest body of a request that uploads nothing, bytes.
pub const MAX_BODY_BYTES: usize = 64 << 10;
/// What a form has beside its file, bytes.
const FORM_BYTES: usize = 256 << 10;
/// Where the interface begins.
pub const API: &str = "/api/v1";
/// Policy of a page: its script and its style are files of the server, and it asks only the server.
const PAGE_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; \
    form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

/// Heads of every answer that does not have its own.
static HEADS: [(HeaderName, &str); 7] = [
    (header::CONTENT_SECURITY_POLICY, PAGE_POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    // Forms of this server still tell their origin.
    (header::REFERRER_POLICY, "same-origin"),
    (header::CACHE_CONTROL, "no-store"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];

/// What every request shares.
pub struct App {
    /// Queue, setup and program.
    pub bench: Arc<Bench>,
    /// The secret.
    pub token: Token,
    /// Names of the server.
    pub hosts: Hosts,
    /// Folders with recordings.
    pub recordings: Roots,
    /// Procedures and limits.
    pub catalogue: Catalogue,
    /// Uploads.
    pub uploads: Uploads,
    /// Templates of the pages.
    pub templates: Environment<'static>,
    /// Streams that are free.
    pub streams: Arc<Semaphore>,
    /// Charts are drawn one at a time.
    pub charts: Semaphore,
}

impl App {
    /// The language of a request.
    pub fn language(&self, headers: &HeaderMap) -> Lang {
        language(headers, self.bench.setup.lang)
    }
}

/// State of a handler.
pub type Shared = State<Arc<App>>;

/// What a request may be without.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Anybody.
    Open,
    /// Who has the token.
    Token,
}

/// What a route takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// Nothing, or no more than a small body.
    Little,
    /// A recording.
    Upload,
}

/// A route.
pub struct Route {
    /// Method.
    pub method: Method,
    /// Path, with `{name}` and `{*rest}`.
    pub path: &'static str,
    /// Name of the operation in the description of the interface; empty for pages.
    pub operation: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    /// Who may.
    pub access: Access,
    /// What it takes.
    pub takes: Takes,
    /// Its handler.
    pub handler: fn() -> MethodRouter<Arc<App>>,
}

macro_rules! routes {
    ($($method:ident $path:literal $operation:literal $summary:literal $access:ident $takes:ident $maker:ident $handler:path;)*) => {
        &[$(Route {
            method: Method::$method,
            path: $path,
            operation: $operation,
            summary: $summary,
            access: Access::$access,
            takes: Takes::$takes,
            handler: || $maker($handler),
        }),*]
    };
}

/// Every route.
pub static ROUTES: &[Route] = routes! {
    GET "/" "" "The bench" Token Little get pages::bench::show;
    POST "/bench" "" "Orders a test from the bench" Token Upload post pages::bench::order;
    GET "/units" "" "Finds a unit" Token Little get pages::unit::find;
    GET "/units/{serial}" "" "A unit and its attempts" Token Little get pages::unit::show;
    GET "/units/{serial}/charts" "" "Control charts of a unit" Token Little get pages::unit::charts;
    POST "/runs/{id}/cancel" "" "Cancels a test" Token Little post pages::bench::cancel;
    GET "/lots" "" "Units by quantities of a lot or a day" Token Little get pages::lots::show;
    GET "/live" "" "Tests that wait and run" Token Little get pages::live::show;
    POST "/language" "" "Chooses a language" Open Little post pages::session::language;
    POST "/session" "" "Exchanges the token for a cookie" Open Little post pages::session::sign_in;
    GET "/assets/{file}" "" "Style and script" Open Little get pages::asset;
    GET "/healthz" "" "Sign of life" Open Little get api::health;
    GET "/api/v1/healthz" "health" "Sign of life" Open Little get api::health;
    GET "/api/v1/openapi.json" "interface" "This description" Token Little get api::openapi;
    POST "/api/v1/runs" "order" "Orders a test: JSON names a recording below a folder, a form uploads one" Token Upload post api::order;
    GET "/api/v1/runs" "list" "Tests, the last one first" Token Little get api::list;
    GET "/api/v1/runs/{id}" "run" "A test" Token Little get api::run;
    DELETE "/api/v1/runs/{id}" "cancel" "Cancels a test" Token Little delete api::cancel;
    GET "/api/v1/runs/{id}/events" "events" "Events of a test (Server-Sent Events), replayed after Last-Event-ID" Token Little get api::events;
    GET "/api/v1/units/{serial}" "unit" "Attempts of a unit, the first one first" Token Little get api::unit;
    GET "/api/v1/recordings" "recordings" "The newest recordings of the folders" Token Little get api::recordings;
    GET "/api/v1/procedures" "procedures" "Procedures, limits and rules" Token Little get api::procedures;
    GET "/api/v1/results/{id}/{*file}" "result" "A file of the result of a test" Token Little get api::result;
};

/// The router of a server.
pub fn router(app: &Arc<App>) -> Router {
    let most = usize::try_from(app.uploads.max_bytes()).unwrap_or(usize::MAX).saturating_add(FORM_BYTES);
    let mut router = Router::new();
    for route in ROUTES {
        let handler = (route.handler)();
        let handler = match route.takes {
            Takes::Little => {
                let in_time = TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, MAX_ANSWER_TIME);
                handler
                    .layer::<_, Infallible>(in_time)
                    .layer::<_, Infallible>(DefaultBodyLimit::max(MAX_BODY_BYTES))
            }
            Takes::Upload => {
                let in_time = TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, MAX_UPLOAD_TIME);
                handler
                    .layer::<_, Infallible>(in_time)
                    .layer::<_, Infallible>(DefaultBodyLimit::disable())
                    .layer::<_, Infallible>(RequestBodyLimitLayer::new(most))
            }
        };
        router = router.route(route.path, handler);
    }
    let router = router
        .fallback(not_found)
        .with_state(Arc::clone(app))
        .layer(from_fn_with_state(Arc::clone(app), guard));
    HEADS.iter().fold(router, |router, (name, value)| {
        router.layer(SetResponseHeaderLayer::if_not_present(name.clone(), HeaderValue::from_static(value)))
    })
}

async fn not_found(State(app): Shared, request: Request) -> Response {
    refused(&app, request.uri().path(), request.headers(), &Refusal::new(StatusCode::NOT_FOUND, "not_found"))
}

/// True where a path is open without the token.
fn is_open(path: &str) -> bool {
    let open = ROUTES.iter().filter(|route| route.access == Access::Open);
    open.map(|route| route.path).any(|known| match known.split_once("{file}") {
        Some((folder, _)) => path.strip_prefix(folder).is_some_and(|rest| !rest.contains('/')),
        None => path == known,
    })
}

/// Lets a request through, or refuses it, by the rules of [`crate::guard`] in their order.
async fn guard(State(app): Shared, request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    let method = parts.method.clone();
    let path = parts.uri.path().to_owned();
    let checked = app.hosts.check(&parts).and_then(|()| {
        if !is_safe(&method) || path.starts_with(API) {
            app.hosts.same_origin(&parts.headers)?;
        }
        content_type(&parts)?;
        if is_open(&path) || has_token(&parts.headers, &app.token, &app.hosts) {
            Ok(())
        } else {
            Err(Refusal::new(StatusCode::UNAUTHORIZED, "token"))
        }
    });
    let response = match checked {
        Ok(()) => next.run(Request::from_parts(parts, body)).await,
        Err(refusal) => refused(&app, &path, &parts.headers, &refusal),
    };
    let status = response.status();
    if !is_safe(&method)
        || (status.is_client_error() && status != StatusCode::NOT_FOUND)
        || status.is_server_error()
    {
        let path = crate::refusal::shown(&path);
        app.bench.harness.log(&format!("{method} {path} {}", status.as_u16()));
    }
    response
}

/// A refusal: as JSON below the interface, as a page elsewhere.
pub fn refused(app: &App, path: &str, headers: &HeaderMap, refusal: &Refusal) -> Response {
    let lang = app.language(headers);
    if path.starts_with(API) {
        return (refusal.status, Json(refusal.body(lang))).into_response();
    }
    (refusal.status, pages::refused(app, lang, refusal)).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_get_changes_anything_and_little_is_open() {
        for route in ROUTES {
            assert!([Method::GET, Method::POST, Method::DELETE].contains(&route.method));
            assert_eq!(!route.operation.is_empty(), route.path.starts_with(API), "{}", route.path);
        }
        let open: Vec<&str> = ROUTES.iter().filter(|r| r.access == Access::Open).map(|r| r.path).collect();
        let expected = ["/language", "/session", "/assets/{file}", "/healthz", "/api/v1/healthz"];
        assert_eq!(open, expected);
        assert!(
            is_open("/assets/bench.css")
                && !is_open("/assets/../x")
                && !is_open("/")
                && !is_open("/api/v1/runs")
        );
    }
}
