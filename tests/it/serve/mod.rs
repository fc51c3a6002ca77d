//! The pages of a bench, as a browser, a program and an attacker meet them: raw requests over a socket, since a client of HTTP
//! would write some heads itself.

mod browser;
mod flow;
mod guard;
mod hostile;
mod latency;
mod restart;
mod starts;

use crate::support::program;
use crate::support::quick::Quick;
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::{TempDir, tempdir};

/// No answer and no test of the server may take longer.
const PATIENCE: Duration = Duration::from_secs(300);
/// Pause between two looks at a test.
const POLL: Duration = Duration::from_millis(30);

/// An answer.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    /// Heads by their names in lower case.
    pub heads: Vec<(String, String)>,
    pub body: String,
}

impl Answer {
    pub fn head(&self, name: &str) -> Option<&str> {
        self.heads.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    pub fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|e| panic!("{e}: {}", self.body))
    }
}

/// A folder of a bench, whose server may be started again and again.
pub struct Bench {
    dir: TempDir,
    pub quick: Quick,
}

impl Bench {
    pub fn new() -> Bench {
        let bench = Bench { dir: tempdir().unwrap(), quick: Quick::new("pass") };
        for name in ["in", "tests"] {
            fs::create_dir(bench.at(name)).unwrap();
        }
        fs::copy(&bench.quick.procedure, bench.at("tests/quick.toml")).unwrap();
        fs::copy(&bench.quick.limits, bench.at("tests/quick-limits.toml")).unwrap();
        fs::copy(&bench.quick.recording, bench.at("in/20270301_SN-1_static.csv")).unwrap();
        fs::copy(Quick::new("fail").recording, bench.at("in/20270301_SN-2_static.csv")).unwrap();
        bench
    }

    pub fn folder(&self) -> &Path {
        self.dir.path()
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// Starts a server with further options.
    pub fn start(&self, more: &[&str]) -> Server {
        Server::start(self.folder(), more)
    }

    /// An order of the quick test of a unit.
    pub fn order(&self, serial: &str) -> Value {
        json!({
            "serial": serial, "recording": format!("in/20270301_{serial}_static.csv"),
            "procedure": "quick.toml", "limits": "quick-limits.toml",
        })
    }
}

/// A server that runs; it is killed at the end.
pub struct Server {
    pub child: Child,
    pub port: u16,
    pub token: String,
    said: BufReader<std::process::ChildStdout>,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The command of a server on the folders of a bench.
pub fn command(folder: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(program());
    command.current_dir(folder).args([
        "serve",
        "--data",
        "data",
        "--recordings",
        "in",
        "--procedures",
        "tests",
    ]);
    if !more.contains(&"--port") {
        command.args(["--port", "0"]);
    }
    command.arg("--allow-root").args(more).env("LANG", "C").env_remove("SAGNAC_STORE");
    command
}

impl Server {
    pub fn start(folder: &Path, more: &[&str]) -> Server {
        let mut child = command(folder, more)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(fs::File::options().create(true).append(true).open(folder.join("log")).unwrap())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        said.read_line(&mut line).unwrap();
        let (address, token) =
            line.trim().split_once("/#token=").unwrap_or_else(|| panic!("{line}: {}", log(folder)));
        let port = address.rsplit(':').next().unwrap().parse().unwrap_or(0);
        Server { child, port, token: token.to_owned(), said }
    }

    /// The next line that it prints.
    pub fn line(&mut self) -> String {
        let mut line = String::new();
        self.said.read_line(&mut line).unwrap();
        line
    }

    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// Sends bytes as they are, and reads until the server ends the connection.
    pub fn raw(&self, request: &[u8]) -> Answer {
        let mut stream = self.connect();
        // A refusal may come before all is sent.
        let _ = stream.write_all(request);
        let mut bytes = vec![];
        let _ = stream.read_to_end(&mut bytes);
        answer(&bytes)
    }

    /// A request with heads beside its host, its length and that it is the last one; the first one of a name counts.
    pub fn ask(&self, method: &str, path: &str, heads: &[(&str, &str)], body: &[u8]) -> Answer {
        let host = format!("127.0.0.1:{}", self.port);
        let length = body.len().to_string();
        let usual = [("host", host.as_str()), ("connection", "close"), ("content-length", &length)];
        let mut text = format!("{method} {path} HTTP/1.1\r\n");
        for (name, value) in
            heads.iter().chain(usual.iter().filter(|(n, _)| !heads.iter().any(|(h, _)| h == n)))
        {
            text += &format!("{name}: {value}\r\n");
        }
        self.raw(&[text.as_bytes(), b"\r\n", body].concat())
    }

    pub fn bearer(&self) -> String {
        format!("Bearer {}", self.token)
    }

    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, &[("authorization", &self.bearer())], b"")
    }

    /// As a browser that has chosen a language.
    pub fn page(&self, path: &str, lang: &str) -> Answer {
        let cookie = format!("sagnac_language={lang}; sagnac_token_{}={}", self.port, self.token);
        self.ask("GET", path, &[("cookie", &cookie)], b"")
    }

    pub fn post(&self, path: &str, body: &Value) -> Answer {
        let heads = [("authorization", self.bearer()), ("content-type", "application/json".to_owned())];
        let heads = heads.each_ref().map(|(name, value)| (*name, value.as_str()));
        self.ask("POST", path, &heads, body.to_string().as_bytes())
    }

    /// Sends a form: fields, and a file with the name that the client gives it.
    pub fn form(&self, path: &str, fields: &[(&str, &str)], file: Option<(&str, &[u8])>) -> Answer {
        let (kind, body) = form(fields, file);
        self.ask("POST", path, &[("authorization", &self.bearer()), ("content-type", &kind)], &body)
    }

    /// Orders a test; gives its id.
    pub fn order(&self, order: &Value) -> String {
        let answer = self.post("/api/v1/runs", order);
        assert_eq!(answer.status, 202, "{answer:?}");
        answer.json()["id"].as_str().unwrap().to_owned()
    }

    pub fn run(&self, id: &str) -> Value {
        self.get(&format!("/api/v1/runs/{id}")).json()
    }

    /// Waits for the end of a test.
    pub fn ended(&self, id: &str) -> Value {
        let began = Instant::now();
        loop {
            let run = self.run(id);
            if !["queued", "running"].contains(&run["state"].as_str().unwrap_or_else(|| panic!("{run}"))) {
                return run;
            }
            assert!(began.elapsed() < PATIENCE, "{run}");
            std::thread::sleep(POLL);
        }
    }
}

/// A form with its type.
pub fn form(fields: &[(&str, &str)], file: Option<(&str, &[u8])>) -> (String, Vec<u8>) {
    let mut body = vec![];
    for (name, value) in fields {
        let part = format!("--edge\r\ncontent-disposition: form-data; name=\"{name}\"\r\n\r\n{value}\r\n");
        body.extend_from_slice(part.as_bytes());
    }
    if let Some((name, bytes)) = file {
        let head = format!(
            "--edge\r\ncontent-disposition: form-data; name=\"file\"; filename=\"{name}\"\r\n\
             content-type: application/octet-stream\r\n\r\n"
        );
        body.extend_from_slice(head.as_bytes());
        body.extend_from_slice(bytes);
        body.extend_from_slice(b"\r\n");
    }
    body.extend_from_slice(b"--edge--\r\n");
    ("multipart/form-data; boundary=edge".to_owned(), body)
}

/// What a server said of itself.
pub fn log(folder: &Path) -> String {
    fs::read_to_string(folder.join("log")).unwrap_or_default()
}

/// An answer from its bytes; status 0 where the connection was ended without one.
pub fn answer(bytes: &[u8]) -> Answer {
    let text = String::from_utf8_lossy(bytes);
    let (head, body) = text.split_once("\r\n\r\n").unwrap_or((&text, ""));
    let mut lines = head.lines();
    let status = lines.next().and_then(|l| l.split(' ').nth(1)?.parse().ok()).unwrap_or(0);
    let heads: Vec<(String, String)> = lines
        .filter_map(|line| line.split_once(": "))
        .map(|(name, value)| (name.to_ascii_lowercase(), value.to_owned()))
        .collect();
    let is_chunked = heads.iter().any(|(name, value)| name == "transfer-encoding" && value == "chunked");
    let body = if is_chunked { unchunked(body) } else { body.to_owned() };
    Answer { status, heads, body }
}

fn unchunked(mut body: &str) -> String {
    let mut out = String::new();
    while let Some((length, rest)) = body.split_once("\r\n") {
        let length = usize::from_str_radix(length.trim(), 16).unwrap_or(0);
        let Some(chunk) = rest.get(..length).filter(|chunk| !chunk.is_empty()) else { break };
        out += chunk;
        body = rest.get(length + 2..).unwrap_or_default();
    }
    out
}
