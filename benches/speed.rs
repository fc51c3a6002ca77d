//! CPU of what users wait for over that of bare kernels, in turn in one run: `cargo xtask speed`.
//!
//! Seconds depend on the machine and on what else runs there; the ratio hardly does. Each figure and its kernels run in turn, the
//! least of [`ROUNDS`] counts. The table that is printed is that of `docs/PERFORMANCE.md`. A ratio more than [`WORSE`] times
//! the stored one (`benches/ratios.csv`) fails the command; `--store` writes those of this run instead.

use sagnac::noise::digest::{DigestPlan, RateAccumulator, RateDigest};
use sagnac::noise::spectral_record::identify_digest;
use sagnac_benches::{TAU0_S, limits, simulated_rate};
use std::fmt::Write as _;
use std::hint::black_box;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

/// Each is measured so often, in turn; the least counts.
const ROUNDS: usize = 3;
/// Growth of a ratio that is a loss of speed.
const WORSE: f64 = 1.2;
/// Rows of the long recording: ten hours at 100 Hz.
const ROWS: usize = 3_600_000;
/// Rows of short recordings.
const SHORT_ROWS: usize = 36_000;
const MIDDLE_ROWS: usize = 360_000;
/// Recordings of a lot.
const RECORDINGS: usize = 12;
/// Where ratios are kept.
const STORED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/ratios.csv");

/// A model of N, B and K without columns beside.
const MODEL: &str =
    "[recording]\nsample_rate_hz = 100\n[noise]\nN_deg_rt_h = 0.002\nB_deg_h = 0.004\nK_deg_h_rt_h = 0.01\n";

/// A test of N without a warm-up, which short recordings do not have.
const PROCEDURE: &str = "format = \"procedure/1\"\n[procedure]\nid = \"short\"\ntitle = \"Short\"\nrevision = \"A\"\n\
    [[channel]]\nid = \"time\"\ncolumn = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n\
    [[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
    [conditions]\nminimum_duration = \"1 min\"\n[[measurand]]\nid = \"angle_random_walk\"\n";

/// This program is the one that is measured as well, when it is started with this argument before those of a verb.
const PROGRAM: &str = "--program";

/// CPU and wall time of something, s.
#[derive(Clone, Copy)]
struct Cost {
    cpu_s: f64,
    wall_s: f64,
}

impl Cost {
    const NONE: Cost = Cost { cpu_s: f64::INFINITY, wall_s: f64::INFINITY };

    fn least(self, other: Cost) -> Cost {
        Cost { cpu_s: self.cpu_s.min(other.cpu_s), wall_s: self.wall_s.min(other.wall_s) }
    }

    fn share(self, count: usize) -> Cost {
        Cost { cpu_s: self.cpu_s / count as f64, wall_s: self.wall_s / count as f64 }
    }
}

/// A figure of speed: what users wait for, and the kernels that it is compared with; each as often as makes a second or so.
struct Figure<'a> {
    name: &'static str,
    times: usize,
    run: Box<dyn Fn() + 'a>,
    kernel_times: usize,
    kernels: Box<dyn Fn() + 'a>,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    if arguments.get(1).is_some_and(|a| a == PROGRAM) {
        let program: Vec<_> = std::env::args_os().take(1).chain(std::env::args_os().skip(2)).collect();
        return sagnac::cli::run(&program).into();
    }
    let folder = tempfile::tempdir().expect("a folder");
    let measured = measure(folder.path());
    let Some(measured) = measured else {
        eprintln!("the CPU time of a process is read from /proc/self/stat, which is not there");
        return ExitCode::from(2);
    };
    println!("| figure | CPU, s | wall, s | kernels, CPU, s | ratio | stored |\n|---|---|---|---|---|---|");
    let stored = std::fs::read_to_string(STORED).unwrap_or_default();
    let before = |name: &str| -> Option<f64> {
        stored.lines().filter_map(|l| l.rsplit_once(',')).find(|(n, _)| *n == name)?.1.parse().ok()
    };
    let (mut ratios, mut worse) = (String::from("figure,ratio\n"), vec![]);
    for (name, cost, kernels) in &measured {
        let ratio = cost.cpu_s / kernels.cpu_s;
        let was = before(name);
        let shown = was.map_or("–".to_owned(), |r| format!("{r:.2}"));
        println!(
            "| {name} | {:.3} | {:.3} | {:.4} | {ratio:.2} | {shown} |",
            cost.cpu_s, cost.wall_s, kernels.cpu_s
        );
        let _ = writeln!(ratios, "{name},{ratio:.3}");
        worse.extend(was.filter(|was| ratio > WORSE * was).map(|_| *name));
    }
    if arguments.iter().any(|a| a == "--store") {
        std::fs::write(STORED, ratios).expect("the file of ratios");
        return ExitCode::SUCCESS;
    }
    if worse.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("slower than before, beside their kernels: {}", worse.join("; "));
    ExitCode::FAILURE
}

/// A recording as a file, its rate, and its text.
struct Recording {
    path: PathBuf,
    rate: Vec<f64>,
    text: Vec<u8>,
}

impl Recording {
    fn new(folder: &Path, rows: usize) -> Recording {
        let path = folder.join(format!("{rows}.csv"));
        let rate = write_recording(&path, rows);
        let text = std::fs::read(&path).expect("the recording");
        Recording { path, rate, text }
    }

    /// Kernels that an analysis has at least.
    fn kernels(&self) {
        black_box((limits::parse(&self.text), limits::allan(&self.rate), limits::welch(&self.rate)));
    }
}

/// Recordings, models and lots that the figures are measured on.
struct Inputs<'a> {
    folder: &'a Path,
    long: Recording,
    middle: Recording,
    short: Recording,
    model: PathBuf,
    procedure: PathBuf,
    parquet: PathBuf,
    lot: Vec<PathBuf>,
}

impl Inputs<'_> {
    fn new(folder: &Path) -> Inputs<'_> {
        let recording = |rows: usize| Recording::new(folder, rows);
        let short = recording(SHORT_ROWS);
        let model = folder.join("model.toml");
        std::fs::write(&model, MODEL).expect("a model");
        let procedure = folder.join("procedure.toml");
        std::fs::write(&procedure, PROCEDURE).expect("a procedure");
        let lot: Vec<PathBuf> = (0..RECORDINGS).map(|i| folder.join(format!("unit-{i}.csv"))).collect();
        lot.iter().for_each(|path| std::fs::write(path, &short.text).expect("a recording"));
        let (long, middle, parquet) =
            (recording(ROWS), recording(MIDDLE_ROWS), folder.join("simulated.parquet"));
        let inputs = Inputs { folder, long, middle, short, model, procedure, parquet, lot };
        inputs.simulate(ROWS);
        inputs
    }

    fn simulate(&self, rows: usize) {
        let length = format!("{}s", rows as f64 * TAU0_S);
        let [out, model] = [&self.parquet, &self.model].map(|p| p.display().to_string());
        program(&["simulate", "--quiet", "--force", "--duration", &length, "--out", &out, &model]);
    }

    /// A place for results that is not there yet.
    fn free(&self, name: &str) -> String {
        let out = self.folder.join(name);
        let _ = std::fs::remove_dir_all(&out);
        out.display().to_string()
    }

    fn analyse(&self, path: &Path) {
        program(&["analyze", "--quiet", "--out", &self.free("out"), &path.display().to_string()]);
    }

    fn test_each(&self) {
        let mut arguments = vec!["run".to_owned(), self.procedure.display().to_string()];
        arguments.extend(self.lot.iter().map(|p| p.display().to_string()));
        arguments.extend(["--each", "--quiet", "--out"].map(str::to_owned));
        arguments.push(self.free("lot"));
        program(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    }
}

/// Analyses of recordings of several lengths and forms.
fn of_recordings<'a>(inputs: &'a Inputs<'_>) -> Vec<Figure<'a>> {
    let Inputs { long, middle, short, parquet, .. } = inputs;
    let analysis = |name, recording: &'a Recording, times, kernel_times| Figure {
        name,
        times,
        run: Box::new(|| inputs.analyse(&recording.path)),
        kernel_times,
        kernels: Box::new(|| recording.kernels()),
    };
    vec![
        analysis("analysis of 3.6 million rows of CSV", long, 1, 2),
        analysis("analysis of 360 000 rows of CSV", middle, 4, 20),
        analysis("analysis of 36 000 rows of CSV", short, 8, 200),
        Figure {
            name: "analysis of 3.6 million rows of Parquet",
            times: 1,
            run: Box::new(|| inputs.analyse(parquet)),
            kernel_times: 2,
            kernels: Box::new(|| {
                let sum = limits::decode(parquet).expect("the recording");
                black_box((sum, limits::allan(&long.rate), limits::welch(&long.rate)));
            }),
        },
        Figure {
            name: "test of 12 recordings of 36 000 rows",
            times: 1,
            run: Box::new(|| inputs.test_each()),
            kernel_times: 200,
            kernels: Box::new(|| short.kernels()),
        },
        Figure {
            name: "simulation of 3.6 million rows as Parquet",
            times: 1,
            run: Box::new(|| inputs.simulate(ROWS)),
            kernel_times: 2,
            kernels: Box::new(|| {
                black_box(limits::noise(ROWS));
            }),
        },
    ]
}

/// Identification of noise, and of what is none.
fn of_identification<'a>(noise: &'a RateDigest, ramp: &'a RateDigest) -> Vec<Figure<'a>> {
    let identification = |name, digest, times| Figure {
        name,
        times,
        run: Box::new(move || {
            black_box(identify_digest("rate", digest, TAU0_S, 0.01, None));
        }),
        kernel_times: 10,
        kernels: Box::new(|| {
            black_box(limits::densities(1000));
        }),
    };
    vec![
        identification("identification of N and B in 36 000 rows", noise, 8),
        identification("identification of a ramp of 1e9 a sample", ramp, 1),
    ]
}

/// Every figure with its kernels, in turn; `None` where the CPU time cannot be read.
fn measure(folder: &Path) -> Option<Vec<(&'static str, Cost, Cost)>> {
    let inputs = Inputs::new(folder);
    let steep: Vec<f64> = (0..SHORT_ROWS).map(|i| 1e9 * i as f64).collect();
    let (noise, ramp) = (digest(&inputs.short.rate), digest(&steep));
    let mut figures = of_recordings(&inputs);
    figures.extend(of_identification(&noise, &ramp));
    let mut least = vec![[Cost::NONE; 2]; figures.len()];
    for _ in 0..ROUNDS {
        for (figure, least) in figures.iter().zip(&mut least) {
            let now = [
                cost_of(figure.times, &figure.run)?.share(figure.times),
                cost_of(figure.kernel_times, &figure.kernels)?.share(figure.kernel_times),
            ];
            least.iter_mut().zip(now).for_each(|(least, now)| *least = least.least(now));
        }
    }
    Some(figures.iter().zip(least).map(|(f, [run, kernels])| (f.name, run, kernels)).collect())
}

/// A recording of time, rate and temperature; gives the rate.
fn write_recording(path: &Path, rows: usize) -> Vec<f64> {
    let rate = simulated_rate(rows);
    let mut file = std::io::BufWriter::new(std::fs::File::create(path).expect("a file"));
    writeln!(file, "time_s,rate_deg_h,temp_degC").expect("a line");
    for (i, y) in rate.iter().enumerate() {
        let t = i as f64 * TAU0_S;
        writeln!(file, "{t:.2},{y:.6},{:.3}", 20.0 + 0.1 * (t / 900.0).sin()).expect("a line");
    }
    file.flush().expect("a file");
    rate
}

fn digest(rate: &[f64]) -> RateDigest {
    let mut digest = RateAccumulator::new(DigestPlan::new(TAU0_S));
    digest.push(rate, 0, false);
    digest.finish()
}

/// The program as a user runs it.
fn program(arguments: &[&str]) {
    let status = Command::new(std::env::current_exe().expect("this program"))
        .arg(PROGRAM)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .expect("the program");
    // A verdict is no failure: codes below 2, and 3 for one that cannot be told.
    assert!(matches!(status.code(), Some(0 | 1 | 3)), "{arguments:?}: {status}");
}

/// CPU seconds of this process and of those that it waited for, and wall time, while something runs so often.
fn cost_of(times: usize, run: &dyn Fn()) -> Option<Cost> {
    let (before, begun) = (cpu_s()?, Instant::now());
    (0..times).for_each(|_| run());
    Some(Cost { cpu_s: cpu_s()? - before, wall_s: begun.elapsed().as_secs_f64() })
}

fn cpu_s() -> Option<f64> {
    // Hundredths of a second on Linux, whatever the clock of the kernel.
    const TICKS_PER_S: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // User and system time of the process and of its children; the name before them may hold blanks.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: u64 = fields.get(11..15)?.iter().map(|f| f.parse::<u64>().ok()).sum::<Option<u64>>()?;
    Some(ticks as f64 / TICKS_PER_S)
}
