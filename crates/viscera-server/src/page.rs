//! The page, as it was embedded when the program was built.

use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName, X_CONTENT_TYPE_OPTIONS};
use axum::http::{StatusCode, Uri};
use axum::response::{Html, IntoResponse, Response};

mod embedded {
    include!(concat!(env!("OUT_DIR"), "/page.rs"));
}

/// What the page may load: its own files, and pictures that it made itself.
const POLICY: &str = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; \
                      style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self' ws: wss:; \
                      frame-ancestors 'none'";

/// Whether the program was built with its page, or why not.
pub(crate) fn missing() -> Option<&'static str> {
    embedded::MISSING
}

/// A file of the page.
pub(crate) fn file(uri: &Uri) -> Response {
    let path = if uri.path() == "/" { "/index.html" } else { uri.path() };
    let headers = |kind: &'static str, cache: &'static str| -> [(HeaderName, &'static str); 4] {
        [
            (CONTENT_TYPE, kind),
            (CACHE_CONTROL, cache),
            (CONTENT_SECURITY_POLICY, POLICY),
            (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        ]
    };
    match embedded::FILES.iter().find(|(known, _)| *known == path) {
        // Names of assets change with their content.
        Some((_, bytes)) => {
            let cache = if path.starts_with("/assets/") { "public, max-age=31536000, immutable" } else { "no-cache" };
            (headers(media_type(path), cache), *bytes).into_response()
        }
        None if path == "/index.html" => {
            let reason = missing().unwrap_or("it has no index.html");
            (StatusCode::SERVICE_UNAVAILABLE, Html(without_page(reason))).into_response()
        }
        None => (StatusCode::NOT_FOUND, "there is no such file").into_response(),
    }
}

fn without_page(reason: &str) -> String {
    let reason = reason.replace('&', "&amp;").replace('<', "&lt;");
    format!(
        "<!doctype html><html lang=en><meta charset=utf-8><title>Viscera</title>\
         <body style='font:16px/1.5 system-ui;max-width:40em;margin:4em auto;padding:0 1em'>\
         <h1>Viscera runs, but was built without its page</h1><p>{reason}</p>\
         <p>Install Node.js 20.19 or newer with npm, and build the program again: <code>cargo run --release</code>. The session itself is \
         served at <code>/ws</code> all the same.</p>"
    )
}

fn media_type(path: &str) -> &'static str {
    match path.rsplit('.').next().unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "webp" => "image/webp",
        "ico" => "image/x-icon",
        "woff2" => "font/woff2",
        "json" | "map" => "application/json",
        "webmanifest" => "application/manifest+json",
        "wasm" => "application/wasm",
        _ => "application/octet-stream",
    }
}
