//! Signing in, and the language.

use super::{refused, see_other};
use crate::client::LANGUAGE_COOKIE;
use crate::intake::Form;
use crate::refusal::Refusal;
use crate::routes::{MAX_BODY_BYTES, Shared};
use crate::texts::Lang;
use axum::body::to_bytes;
use axum::extract::{FromRequest, Multipart, Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;

/// A token, from the script that found it behind `#`.
#[derive(Deserialize)]
struct Given {
    token: String,
}

/// `POST /session`: the token for a cookie.
pub async fn sign_in(State(app): Shared, request: Request) -> Response {
    let headers = request.headers().clone();
    let lang = app.language(&headers);
    let is_form = is_form(&headers);
    let token = if is_form { of_form(request).await } else { of_json(request).await };
    if !token.is_some_and(|token| app.token.is(token.trim())) {
        let refusal = Refusal::new(StatusCode::UNAUTHORIZED, "token_wrong");
        return (refusal.status, refused(&app, lang, &refusal)).into_response();
    }
    let cookie = app.hosts.set_cookie(app.hosts.cookie(), app.token.reveal());
    let mut response = if is_form { see_other("/") } else { StatusCode::NO_CONTENT.into_response() };
    if let Ok(cookie) = cookie.parse() {
        response.headers_mut().insert(header::SET_COOKIE, cookie);
    }
    response
}

fn is_form(headers: &HeaderMap) -> bool {
    let kind = headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    kind.is_some_and(|kind| kind.to_ascii_lowercase().starts_with("multipart/"))
}

async fn of_form(request: Request) -> Option<String> {
    let parts = Multipart::from_request(request, &()).await.ok()?;
    Some(Form::read(parts, None).await.ok()?.field("token").to_owned())
}

async fn of_json(request: Request) -> Option<String> {
    let body = to_bytes(request.into_body(), MAX_BODY_BYTES).await.ok()?;
    Some(serde_json::from_slice::<Given>(&body).ok()?.token)
}

/// `POST /language`
pub async fn language(State(app): Shared, request: Request) -> Response {
    let lang = app.language(request.headers());
    let Ok(parts) = Multipart::from_request(request, &()).await else {
        let refusal = Refusal::new(StatusCode::BAD_REQUEST, "malformed");
        return (refusal.status, refused(&app, lang, &refusal)).into_response();
    };
    let form = Form::read(parts, None).await.unwrap_or_default();
    let back = form.field("back");
    let mut response = see_other(if is_own_page(back) { back } else { "/" });
    if let Some(lang) = Lang::from_code(form.field("language"))
        && let Ok(cookie) = app.hosts.set_cookie(LANGUAGE_COOKIE, lang.code()).parse()
    {
        response.headers_mut().insert(header::SET_COOKIE, cookie);
    }
    response
}

/// True for an address that leads to no other server.
fn is_own_page(back: &str) -> bool {
    back.starts_with('/') && !back.starts_with("//") && !back.contains(|c: char| c == '\\' || c.is_control())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_leads_to_no_other_server() {
        assert!(is_own_page("/") && is_own_page("/units/a?b=c"));
        for back in
            ["", "//evil.example", "/\\evil.example", "/\t/evil.example", "https://evil.example", "evil"]
        {
            assert!(!is_own_page(back), "{back:?}");
        }
    }
}
