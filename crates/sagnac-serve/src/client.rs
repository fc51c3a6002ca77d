//! What a request tells of its client: cookies and language.

use crate::texts::Lang;
use axum::http::{HeaderMap, header};

/// Cookie of the language.
pub const LANGUAGE_COOKIE: &str = "sagnac_language";

/// The value of a cookie.
pub fn cookie<'h>(headers: &'h HeaderMap, name: &str) -> Option<&'h str> {
    let lines = headers.get_all(header::COOKIE).into_iter().filter_map(|line| line.to_str().ok());
    let mut pairs = lines.flat_map(|line| line.split(';')).filter_map(|pair| pair.trim().split_once('='));
    pairs.find(|(known, _)| *known == name).map(|(_, value)| value)
}

/// The language of a client: by its cookie, or else that of the server.
pub fn language(headers: &HeaderMap, usual: Lang) -> Lang {
    cookie(headers, LANGUAGE_COOKIE).and_then(Lang::from_code).unwrap_or(usual)
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    #[test]
    fn a_cookie_is_found_by_its_whole_name() {
        let mut headers = HeaderMap::new();
        headers.append(header::COOKIE, HeaderValue::from_static("xa=1; a=2;b=3"));
        headers.append(header::COOKIE, HeaderValue::from_static("sagnac_language=ru"));
        assert_eq!(
            (cookie(&headers, "a"), cookie(&headers, "b"), cookie(&headers, "c")),
            (Some("2"), Some("3"), None)
        );
        assert_eq!(language(&headers, Lang::En), Lang::Ru);
        assert_eq!(language(&HeaderMap::new(), Lang::En), Lang::En);
    }
}
