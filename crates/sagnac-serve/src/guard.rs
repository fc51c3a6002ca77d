//! Who may ask for what. Each rule is a function of the head of a request, and comes before anything reads its body:
//!
//! 1. the host is one of this server's, whatever the method ([`Hosts::check`]);
//! 2. what changes something, and streams, come from a page of this server or from no page at all ([`Hosts::same_origin`]);
//! 3. what changes something has a type that no foreign page can send without being asked ([`content_type`]);
//! 4. everything but the sign-in, the assets and the sign of life needs the token ([`has_token`]).

use crate::client::cookie;
use crate::refusal::Refusal;
use crate::setup::Listen;
use crate::token::Token;
use axum::http::request::Parts;
use axum::http::{HeaderMap, Method, StatusCode, header};
use std::net::SocketAddr;

/// Where a browser says whose page asks.
const FETCH_SITE: &str = "sec-fetch-site";
/// Scheme of a token in a header.
const BEARER: &str = "Bearer ";

/// The names under which a server is reached.
#[derive(Debug, Clone)]
pub struct Hosts {
    hosts: Vec<String>,
    origins: Vec<String>,
    is_encrypted: bool,
    cookie: String,
}

impl Hosts {
    /// The names of a server that listens at an address.
    pub fn new(listen: &Listen, bound: SocketAddr) -> Hosts {
        let port = bound.port();
        let cookie = format!("sagnac_token_{port}");
        if let Some(public) = &listen.behind_proxy {
            let (hosts, origins) = (vec![public.host().to_owned()], vec![public.origin()]);
            return Hosts { hosts, origins, is_encrypted: true, cookie: format!("__Host-{cookie}") };
        }
        let names = ["127.0.0.1".to_owned(), "localhost".to_owned(), "[::1]".to_owned()];
        let own = match bound {
            SocketAddr::V4(v4) => v4.ip().to_string(),
            SocketAddr::V6(v6) => format!("[{}]", v6.ip()),
        };
        let mut hosts: Vec<String> =
            names.into_iter().chain([own]).map(|name| format!("{name}:{port}")).collect();
        if port == 80 {
            hosts.extend(hosts.clone().iter().filter_map(|host| host.strip_suffix(":80").map(str::to_owned)));
        }
        let origins = hosts.iter().map(|host| format!("http://{host}")).collect();
        Hosts { hosts, origins, is_encrypted: false, cookie }
    }

    /// Name of the cookie of the token. Cookies do not tell ports apart, so the port is in it.
    pub fn cookie(&self) -> &str {
        &self.cookie
    }

    /// The head of an answer that gives a cookie. No script reads it, and no foreign page has it sent.
    pub fn set_cookie(&self, name: &str, value: &str) -> String {
        let secure = if self.is_encrypted { "; Secure" } else { "" };
        format!("{name}={value}; Path=/; HttpOnly; SameSite=Strict{secure}")
    }

    /// The host of a request: exactly one, and one of this server's. A page of another name that a name server points here is
    /// refused by it, also where the request says nothing of its origin.
    ///
    /// # Errors
    /// Another host, several, or none.
    pub fn check(&self, parts: &Parts) -> Result<(), Refusal> {
        let wrong = |host: &str| Refusal::of(StatusCode::MISDIRECTED_REQUEST, "host", host);
        let mut given = parts.headers.get_all(header::HOST).iter();
        let host = match (given.next(), given.next()) {
            (Some(host), None) => host.to_str().map_err(|_| wrong(""))?,
            _ => return Err(wrong("")),
        };
        let is_own = |host: &str| self.hosts.iter().any(|own| own.eq_ignore_ascii_case(host));
        if !is_own(host) {
            return Err(wrong(host));
        }
        // A request may name its host in its target too.
        match parts.uri.authority() {
            Some(authority) if !is_own(authority.as_str()) => Err(wrong(authority.as_str())),
            _ => Ok(()),
        }
    }

    /// Whose page asks: one of this server's, or none, as with a program.
    ///
    /// # Errors
    /// A foreign page, or an origin that cannot be read.
    pub fn same_origin(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let foreign = |of: &str| Refusal::of(StatusCode::FORBIDDEN, "origin", of);
        for origin in headers.get_all(header::ORIGIN) {
            let origin = origin.to_str().map_err(|_| foreign(""))?;
            if !self.origins.iter().any(|own| own == origin) {
                return Err(foreign(origin));
            }
        }
        for site in headers.get_all(FETCH_SITE) {
            let site = site.to_str().map_err(|_| foreign(""))?;
            if !["same-origin", "none"].contains(&site) {
                return Err(foreign(site));
            }
        }
        Ok(())
    }
}

/// True for methods that change nothing.
pub fn is_safe(method: &Method) -> bool {
    [Method::GET, Method::HEAD, Method::OPTIONS].contains(method)
}

/// The type of what is sent: JSON, or the parts of a form. A page of another server can send neither of them with a token that it
/// does not have, and what it can send without asking is refused.
///
/// # Errors
/// Another type, several, or none.
pub fn content_type(parts: &Parts) -> Result<(), Refusal> {
    if parts.method != Method::POST {
        return Ok(());
    }
    let wrong = || Refusal::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "content_type");
    let mut given = parts.headers.get_all(header::CONTENT_TYPE).iter();
    let (Some(kind), None) = (given.next(), given.next()) else { return Err(wrong()) };
    let kind = kind.to_str().map_err(|_| wrong())?;
    let kind = kind.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
    if ["application/json", "multipart/form-data"].contains(&kind.as_str()) { Ok(()) } else { Err(wrong()) }
}

/// True where a request has the token, in its cookie or as that of a program.
pub fn has_token(headers: &HeaderMap, token: &Token, hosts: &Hosts) -> bool {
    let bearer = headers.get(header::AUTHORIZATION).and_then(|given| given.to_str().ok());
    let bearer = bearer.and_then(|given| given.strip_prefix(BEARER));
    [bearer, cookie(headers, hosts.cookie())].into_iter().flatten().any(|given| token.is(given))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::PublicOrigin;
    use axum::http::Request;

    fn hosts(behind: Option<&str>, bound: &str) -> Hosts {
        let address: SocketAddr = bound.parse().unwrap();
        let behind_proxy = behind.map(|url| PublicOrigin::parse(url).unwrap());
        Hosts::new(&Listen { address, behind_proxy }, address)
    }

    fn head(target: &str, headers: &[(&str, &str)]) -> Parts {
        let request = Request::builder().uri(target);
        let request = headers.iter().fold(request, |r, (name, value)| r.header(*name, *value));
        request.body(()).unwrap().into_parts().0
    }

    #[test]
    fn only_own_hosts_are_answered() {
        let own = hosts(None, "127.0.0.1:8643");
        for host in ["127.0.0.1:8643", "localhost:8643", "LOCALHOST:8643", "[::1]:8643"] {
            assert!(own.check(&head("/", &[("host", host)])).is_ok(), "{host}");
        }
        for host in [
            "evil.example",
            "127.0.0.1",
            "127.0.0.1:80",
            "localhost.evil.example:8643",
            "",
            "127.0.0.1:8643@evil",
        ] {
            assert!(own.check(&head("/", &[("host", host)])).is_err(), "{host}");
        }
        assert!(own.check(&head("/", &[])).is_err());
        let twice = [("host", "localhost:8643"), ("host", "localhost:8643")];
        assert!(own.check(&head("/", &twice)).is_err());
        let target = head("http://evil.example/", &[("host", "localhost:8643")]);
        assert_eq!(own.check(&target).unwrap_err().detail, "evil.example");
        let proxied = hosts(Some("https://bench.example.com"), "0.0.0.0:8643");
        assert!(proxied.check(&head("/", &[("host", "bench.example.com")])).is_ok());
        assert!(proxied.check(&head("/", &[("host", "localhost:8643")])).is_err());
        assert!(proxied.set_cookie(proxied.cookie(), "x").ends_with("SameSite=Strict; Secure"));
    }

    #[test]
    fn foreign_pages_are_told_by_origin_and_site() {
        let own = hosts(None, "127.0.0.1:8643");
        let allowed = |headers: &[(&str, &str)]| own.same_origin(&head("/", headers).headers).is_ok();
        assert!(
            allowed(&[])
                && allowed(&[("origin", "http://localhost:8643"), ("sec-fetch-site", "same-origin")])
        );
        assert!(allowed(&[("sec-fetch-site", "none")]));
        for origin in [
            "null",
            "http://evil.example",
            "https://localhost:8643",
            "http://localhost",
            "http://localhost:86430",
        ] {
            assert!(!allowed(&[("origin", origin)]), "{origin}");
        }
        for site in ["cross-site", "same-site", ""] {
            assert!(!allowed(&[("sec-fetch-site", site)]), "{site}");
        }
        let both = [("origin", "http://localhost:8643"), ("origin", "http://evil.example")];
        assert!(!allowed(&both));
    }

    #[test]
    fn a_token_counts_in_its_cookie_and_as_that_of_a_program() {
        let (own, token) = (hosts(None, "127.0.0.1:8643"), Token::new().unwrap());
        let has = |name: &str, value: &str| has_token(&head("/", &[(name, value)]).headers, &token, &own);
        let secret = token.reveal();
        assert!(has("cookie", &format!("a=b; sagnac_token_8643={secret}")));
        assert!(has("authorization", &format!("Bearer {secret}")));
        assert!(!has("cookie", &format!("sagnac_token_8644={secret}")) && !has("authorization", secret));
        assert!(!has("cookie", "sagnac_token_8643=") && !has("authorization", "Bearer "));
    }
}
