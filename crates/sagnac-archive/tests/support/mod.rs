//! What tests of the program share: recordings, folders, processes that end with the test.
#![allow(dead_code)]

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A folder of a test, with a job list of what lies in `recordings`.
pub struct Archive {
    folder: tempfile::TempDir,
}

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A file of the repository, by its whole path.
pub fn file(name: &str) -> String {
    root().join(name).canonicalize().unwrap().display().to_string()
}

/// The text of a short recording at rest: one sample a second, noise of a small generator.
pub fn recording(seed: u64, rows: usize) -> String {
    let mut state = seed.wrapping_mul(2).wrapping_add(1);
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut text = format!("# serial: SN-{seed}\ntime_s,rate_deg_h\n");
    for row in 0..rows {
        let normal: f64 = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        text += &format!("{row},{:.6}\n", 10.0 + seed as f64 * 0.01 + normal);
    }
    text
}

impl Archive {
    /// An archive of some short recordings, listed.
    pub fn of(recordings: usize, rows: usize) -> Archive {
        let archive = Archive::empty();
        for i in 0..recordings {
            archive.add(&format!("unit-{i:03}.csv"), &recording(i as u64, rows));
        }
        archive.list("jobs");
        archive
    }

    /// An archive without a recording.
    pub fn empty() -> Archive {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("recordings")).unwrap();
        Archive { folder }
    }

    /// A path in its folder.
    pub fn path(&self, name: &str) -> String {
        self.folder.path().join(name).display().to_string()
    }

    /// Adds a recording.
    pub fn add(&self, name: &str, text: &str) {
        std::fs::write(self.folder.path().join("recordings").join(name), text).unwrap();
    }

    /// Writes the job list.
    pub fn list(&self, jobs: &str) {
        let done = program(&["list", &self.path("recordings"), "--out", &self.path(jobs)]);
        assert!(done.status.success(), "{}", said(&done));
    }

    /// Runs a query over the job list.
    pub fn run(&self, sql: &str, out: &str, more: &[&str]) -> Output {
        let (jobs, out) = (self.path("jobs"), self.path(out));
        program(&[&["run", sql, "--jobs", &jobs, "--out", &out], more].concat())
    }

    /// What a query over results prints as CSV.
    pub fn query(&self, sql: &str, results: &str) -> String {
        let done = program(&["query", sql, "--results", &self.path(results), "--csv"]);
        assert!(done.status.success(), "{}", said(&done));
        String::from_utf8(done.stdout).unwrap()
    }

    /// Rows, different keys and different recordings of the results.
    pub fn counts(&self, results: &str) -> String {
        let sql = "SELECT count(*) AS n, count(distinct key) AS k, count(distinct uri) AS u FROM results";
        self.query(sql, results).lines().nth(1).unwrap().to_owned()
    }
}

/// The program with some arguments.
pub fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sagnac-archive"));
    command.args(args);
    command
}

/// Runs the program to its end.
pub fn program(args: &[&str]) -> Output {
    command(args).output().unwrap()
}

/// Everything that it said.
pub fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// A process that ends with the test.
pub struct Process(pub Child);

impl Process {
    /// Starts the program.
    pub fn start(args: &[&str]) -> Process {
        Process(command(args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap())
    }

    /// Ends it at once.
    pub fn kill(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// A port that was free a moment ago.
pub fn port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

/// Waits until a condition holds.
pub fn until(what: &str, limit: Duration, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < limit, "waited {limit:?} for {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// True when something listens at a port.
pub fn listens(port: u16) -> bool {
    std::net::TcpStream::connect(("127.0.0.1", port)).is_ok()
}

/// Files with an ending below a folder.
pub fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return vec![] };
    let paths = entries.map(|e| e.unwrap().path());
    paths
        .flat_map(|p| if p.is_dir() { files(&p, ending) } else { vec![p] })
        .filter(|p| p.to_string_lossy().ends_with(ending))
        .collect()
}

/// A scheduler and its workers on the loopback.
pub struct Cluster {
    port: u16,
    /// The scheduler.
    pub scheduler: Process,
    /// The workers.
    pub workers: Vec<Process>,
}

impl Cluster {
    /// Starts a scheduler and some workers of one core each.
    pub fn start(workers: usize) -> Cluster {
        let port = port();
        let mut cluster = Cluster { port, scheduler: Cluster::scheduler(port), workers: vec![] };
        until("the scheduler", Duration::from_secs(30), || listens(port));
        cluster.workers = (0..workers).map(|_| cluster.worker()).collect();
        cluster
    }

    fn scheduler(port: u16) -> Process {
        Process::start(&["scheduler", "--bind", &format!("127.0.0.1:{port}")])
    }

    /// Ends the scheduler at once and starts it again at the same port.
    pub fn restart_scheduler(&mut self) {
        self.scheduler.kill();
        self.scheduler = Cluster::scheduler(self.port);
    }

    /// Starts a worker and waits until it listens.
    pub fn worker(&self) -> Process {
        let (results, grpc) = (port(), port());
        let scheduler = format!("127.0.0.1:{}", self.port);
        let (port, grpc) = (results.to_string(), grpc.to_string());
        let more = ["--port", &port, "--grpc-port", &grpc, "--cores", "1", "--host", "127.0.0.1"];
        let worker = Process::start(&[&["worker", "--scheduler", &scheduler], more.as_slice()].concat());
        until("a worker", Duration::from_secs(30), || listens(results));
        worker
    }

    /// The address of the scheduler.
    pub fn address(&self) -> String {
        format!("df://127.0.0.1:{}", self.port)
    }
}
