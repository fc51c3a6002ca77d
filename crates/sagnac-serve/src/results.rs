//! Files of results, as browsers may show them.

use crate::refusal::Refusal;
use axum::body::Body;
use axum::http::{HeaderValue, Response, StatusCode, header};
use futures_util::stream;
use std::path::{Component, Path, PathBuf};
use tokio::io::AsyncReadExt;

/// What a page of a result may do: it has its script and its drawings in itself, and asks nobody for anything. Its own policy
/// allows no other script than the one it names.
const REPORT_POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: 'self'; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// What any other file may do.
const FILE_POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; sandbox";
/// Bytes that are read at once.
const CHUNK_BYTES: usize = 64 << 10;

/// Endings of names, and their types.
const TYPES: &[(&str, &str)] = &[
    ("html", "text/html; charset=utf-8"),
    ("svg", "image/svg+xml"),
    ("png", "image/png"),
    ("json", "application/json"),
    ("pdf", "application/pdf"),
    ("csv", "text/csv; charset=utf-8"),
    ("xml", "application/xml"),
    ("md", "text/plain; charset=utf-8"),
    ("toml", "text/plain; charset=utf-8"),
    ("txt", "text/plain; charset=utf-8"),
];

/// The file of a name below a folder, where it really lies there.
pub fn below(folder: &Path, name: &str) -> Option<PathBuf> {
    let is_plain = |part: Component<'_>| matches!(part, Component::Normal(_));
    if name.contains('\0') || !Path::new(name).components().all(is_plain) {
        return None;
    }
    let real = folder.canonicalize().ok()?;
    let file = real.join(name).canonicalize().ok()?;
    (file.starts_with(&real) && file.is_file()).then_some(file)
}

/// A file as an answer, read while it is sent.
///
/// # Errors
/// A file that cannot be opened.
pub async fn answer(path: &Path) -> Result<Response<Body>, Refusal> {
    let missing = |_| Refusal::new(StatusCode::NOT_FOUND, "not_found");
    let file = tokio::fs::File::open(path).await.map_err(missing)?;
    let length = file.metadata().await.map_err(missing)?.len();
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let kind = TYPES.iter().find(|(known, _)| *known == ending).map(|(_, kind)| *kind);
    let policy = if ending == "html" { REPORT_POLICY } else { FILE_POLICY };
    let chunks = stream::try_unfold(file.take(length), |mut file| async move {
        let mut chunk = vec![0; CHUNK_BYTES];
        let read = file.read(&mut chunk).await?;
        chunk.truncate(read);
        Ok::<_, std::io::Error>((read > 0).then_some((chunk, file)))
    });
    let mut response = Response::new(Body::from_stream(chunks));
    let headers = response.headers_mut();
    headers
        .insert(header::CONTENT_TYPE, HeaderValue::from_static(kind.unwrap_or("application/octet-stream")));
    headers.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(policy));
    if kind.is_none() {
        headers.insert(header::CONTENT_DISPOSITION, HeaderValue::from_static("attachment"));
    }
    headers.insert(header::CONTENT_LENGTH, HeaderValue::from(length));
    Ok(response)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_below_a_result_are_given() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("r");
        std::fs::create_dir_all(folder.join("figures")).unwrap();
        for file in ["secret", "r/report.html", "r/figures/a.svg"] {
            std::fs::write(outer.path().join(file), "").unwrap();
        }
        assert!(below(&folder, "report.html").is_some() && below(&folder, "figures/a.svg").is_some());
        for name in ["../secret", "figures", "/etc/passwd", "figures/../../secret", "", "a\0"] {
            assert_eq!(below(&folder, name), None, "{name:?}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(outer.path().join("secret"), folder.join("link")).unwrap();
            assert_eq!(below(&folder, "link"), None);
        }
    }
}
