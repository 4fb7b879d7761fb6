//! Who may talk to the server: nobody that another site has sent.
//!
//! A page of another site can open a WebSocket to this machine, and the browser says where it came from in `Origin`. It can also give its
//! own name the address 127.0.0.1 (DNS rebinding), and its requests then come with that name in `Host`. So `Host` has to be an
//! address, `localhost` or a name that the user allows, and `Origin`, where there is one, the same.

use std::net::IpAddr;

use axum::http::header::{HOST, ORIGIN};
use axum::http::{HeaderMap, StatusCode};

/// What is allowed besides addresses and `localhost`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Guard {
    /// Names, with or without a port.
    pub(crate) allowed: Vec<String>,
}

/// Why a request is refused.
pub(crate) type Refused = (StatusCode, String);

impl Guard {
    /// Lets a request pass, or says why not.
    pub(crate) fn check(&self, headers: &HeaderMap) -> Result<(), Refused> {
        let refuse = |text: String| Err((StatusCode::FORBIDDEN, text));
        let of = |name| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
        let Some(host) = of(HOST) else {
            return refuse("the request does not say which host it means".into());
        };
        if !self.is_allowed(host) {
            return refuse(format!(
                "this server is not called `{host}`; start it with --allow-host {} if it should be",
                name_of(host)
            ));
        }
        match of(ORIGIN) {
            None => Ok(()),
            Some(origin) => match origin.split_once("://") {
                Some(("http" | "https", from)) if from == host || self.is_named(from) => Ok(()),
                _ => refuse(format!("a page of `{origin}` may not drive this server")),
            },
        }
    }

    fn is_allowed(&self, host: &str) -> bool {
        let name = name_of(host);
        let address = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
        name == "localhost" || address.parse::<IpAddr>().is_ok() || self.is_named(host)
    }

    fn is_named(&self, host: &str) -> bool {
        self.allowed.iter().any(|allowed| allowed == host || allowed == name_of(host))
    }
}

/// A host without its port.
fn name_of(host: &str) -> &str {
    match host.rfind(':') {
        Some(colon) if host[colon + 1..].bytes().all(|byte| byte.is_ascii_digit()) && !host[..colon].ends_with(':') => {
            &host[..colon]
        }
        _ => host,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passes(host: &str, origin: Option<&str>, allowed: &[&str]) -> bool {
        let mut headers = HeaderMap::new();
        headers.insert(HOST, host.parse().unwrap());
        if let Some(origin) = origin {
            headers.insert(ORIGIN, origin.parse().unwrap());
        }
        Guard { allowed: allowed.iter().map(|name| (*name).to_owned()).collect() }.check(&headers).is_ok()
    }

    #[test]
    fn the_page_itself_and_programs_without_a_page_pass() {
        assert!(passes("127.0.0.1:7373", Some("http://127.0.0.1:7373"), &[]));
        assert!(passes("localhost:7373", Some("http://localhost:7373"), &[]));
        assert!(passes("[::1]:7373", Some("http://[::1]:7373"), &[]));
        assert!(passes("127.0.0.1:7373", None, &[]));
    }

    #[test]
    fn pages_of_other_sites_and_other_ports_do_not() {
        for origin in
            ["http://evil.example", "https://127.0.0.1.evil.example", "http://127.0.0.1:8000", "null", "file://"]
        {
            assert!(!passes("127.0.0.1:7373", Some(origin), &[]), "{origin}");
        }
    }

    #[test]
    fn a_name_that_was_rebound_to_this_machine_does_not() {
        assert!(!passes("evil.example:7373", Some("http://evil.example:7373"), &[]));
        assert!(!passes("evil.example", None, &[]));
    }

    #[test]
    fn names_that_the_user_allows_do() {
        assert!(passes("lab.example:7373", Some("http://lab.example:7373"), &["lab.example"]));
        assert!(passes("127.0.0.1:7373", Some("http://localhost:5173"), &["localhost:5173"]));
        assert!(!passes("lab.example:7373", Some("http://evil.example"), &["lab.example"]));
    }
}
