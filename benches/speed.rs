//! CPU of an analysis over that of bare kernels on the same samples, in one run:
//! `cargo bench -p sagnac-benches --bench ratio`.
//!
//! Seconds depend on the machine and on what else runs there; the ratio hardly does. The last line is the ratio; above
//! [`MOST`] the command fails. The kernels are good plain code on one core: numbers parsed from text, the Allan deviation at
//! ten averaging times a decade, a Welch spectrum. Neither checks nor intervals are in them.

use sagnac_benches::{TAU0_S, simulated_rate};
use sagnac_fft::real_forward;
use std::hint::black_box;
use std::io::Write;
use std::path::Path;
use std::process::{Command, ExitCode};

/// Rows of the recording: ten hours at 100 Hz.
const ROWS: usize = 3_600_000;
/// Each is measured so often, in turn; the least counts.
const ROUNDS: usize = 3;
/// Largest ratio that is no loss of speed.
const MOST: f64 = 6.5;
/// Samples of a segment of the Welch spectrum.
const SEGMENT: usize = 1 << 16;
/// Terms of the Allan deviation that are summed for all averaging times before the next ones.
const BLOCK: usize = 1 << 13;

/// Verb of the program that is measured. This program is that one too, when it is started with the verb.
const VERB: &str = "analyze";

fn main() -> ExitCode {
    if std::env::args().nth(1).is_some_and(|verb| verb == VERB) {
        let arguments: Vec<_> = std::env::args_os().collect();
        return sagnac::cli::run(&arguments).into();
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("recording.csv");
    let rate = write_recording(&path);
    let text = std::fs::read(&path).expect("the recording");
    let mut least = [f64::INFINITY; 4];
    for _ in 0..ROUNDS {
        let cpu = [
            cpu_of(|| analyse(&path, folder.path())),
            cpu_of(|| parse(&text)),
            cpu_of(|| allan(&rate)),
            cpu_of(|| welch(&rate)),
        ];
        for (least, cpu) in least.iter_mut().zip(cpu) {
            let Some(cpu) = cpu else {
                eprintln!("the CPU time of a process is read from /proc/self/stat, which is not there");
                return ExitCode::from(2);
            };
            *least = least.min(cpu);
        }
    }
    let [analysis, kernels @ ..] = least;
    println!("{ROWS} rows, {} MB; CPU, least of {ROUNDS}", text.len() / 1_000_000);
    for (name, cpu) in [
        ("sagnac analyze", analysis),
        ("parse", kernels[0]),
        ("Allan deviation", kernels[1]),
        ("Welch", kernels[2]),
    ] {
        println!("{name:16} {cpu:6.2} s");
    }
    let ratio = analysis / kernels.iter().sum::<f64>();
    println!("ratio {ratio:.2} (at most {MOST:.2})");
    if ratio > MOST { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// A recording of time, rate and temperature; gives the rate.
fn write_recording(path: &Path) -> Vec<f64> {
    let rate = simulated_rate(ROWS);
    let mut file = std::io::BufWriter::new(std::fs::File::create(path).expect("a file"));
    writeln!(file, "time_s,rate_deg_h,temp_degC").expect("a line");
    for (i, y) in rate.iter().enumerate() {
        let t = i as f64 * TAU0_S;
        writeln!(file, "{t:.2},{y:.6},{:.3}", 20.0 + 0.1 * (t / 900.0).sin()).expect("a line");
    }
    file.flush().expect("a file");
    rate
}

/// What a user runs: reading, analysis, report and figures.
fn analyse(path: &Path, folder: &Path) {
    let out = folder.join("out");
    let _ = std::fs::remove_dir_all(&out);
    let status = Command::new(std::env::current_exe().expect("this program"))
        .args([VERB, "--quiet", "--out"])
        .args([out.as_path(), path])
        .stdout(std::process::Stdio::null())
        .status();
    assert!(status.expect("the program").success());
}

/// CPU seconds of this process and of those that it waited for, while something runs.
fn cpu_of<T>(run: impl FnOnce() -> T) -> Option<f64> {
    let before = cpu_s()?;
    black_box(run());
    Some(cpu_s()? - before)
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

/// Every number of a text of plain decimals; their sum.
fn parse(text: &[u8]) -> f64 {
    const POWERS: [f64; 10] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9];
    let header = text.iter().position(|b| *b == b'\n').unwrap_or(0) + 1;
    let (mut sum, mut digits, mut decimals, mut negative, mut after) = (0.0, 0u64, 0usize, false, false);
    for byte in &text[header..] {
        match byte {
            b'0'..=b'9' => {
                digits = 10 * digits + u64::from(byte - b'0');
                decimals += usize::from(after);
            }
            b'.' => after = true,
            b'-' => negative = true,
            _ => {
                let value = digits as f64 / POWERS[decimals];
                sum += if negative { -value } else { value };
                (digits, decimals, negative, after) = (0, 0, false, false);
            }
        }
    }
    sum
}

/// Overlapping Allan deviations at ten averaging times a decade.
fn allan(rate: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let phase: Vec<f64> = std::iter::once(0.0)
        .chain(rate.iter().map(|y| {
            sum += y * TAU0_S;
            sum
        }))
        .collect();
    let largest = rate.len() / 3;
    let mut times: Vec<usize> = (0..80).map(|i| 10f64.powf(f64::from(i) / 10.0).round() as usize).collect();
    times.dedup();
    times.retain(|m| *m <= largest);
    let mut squares = vec![0.0; times.len()];
    for begin in (0..phase.len()).step_by(BLOCK) {
        for (m, total) in times.iter().zip(&mut squares) {
            let end = (begin + BLOCK).min((phase.len()).saturating_sub(2 * m));
            if begin >= end {
                continue;
            }
            let (first, middle, last) =
                (&phase[begin..end], &phase[begin + m..end + m], &phase[begin + 2 * m..end + 2 * m]);
            let terms = first.iter().zip(middle).zip(last);
            *total += terms.map(|((a, b), c)| (c - 2.0 * b + a).powi(2)).sum::<f64>();
        }
    }
    let deviation = |(m, square): (&usize, &f64)| {
        let (tau_s, terms) = (*m as f64 * TAU0_S, (phase.len() - 2 * m) as f64);
        (square / (2.0 * tau_s * tau_s * terms)).sqrt()
    };
    times.iter().zip(&squares).map(deviation).collect()
}

/// Mean powers of segments under a Hann window that overlap by half.
fn welch(rate: &[f64]) -> Vec<f64> {
    let plan = real_forward(SEGMENT);
    let (mut input, mut output) = (plan.make_input_vec(), plan.make_output_vec());
    let window: Vec<f64> = (0..SEGMENT)
        .map(|i| 0.5 - 0.5 * (2.0 * std::f64::consts::PI * i as f64 / SEGMENT as f64).cos())
        .collect();
    let mut powers = vec![0.0; output.len()];
    for begin in (0..=rate.len() - SEGMENT).step_by(SEGMENT / 2) {
        let samples = rate[begin..begin + SEGMENT].iter().zip(&window);
        input.iter_mut().zip(samples).for_each(|(x, (y, w))| *x = y * w);
        plan.process(&mut input, &mut output).expect("lengths that agree");
        powers.iter_mut().zip(&output).for_each(|(p, v)| *p += v.norm_sqr());
    }
    powers
}
