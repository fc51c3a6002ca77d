//! Explanations of cases of an independent generator, in short. The studies are `cargo xtask validate
//! explanation-of-correct-claims explanation-of-clear-effects explanation-of-weak-effects explanation-closed-loop
//! explanation-of-pairs-and-unknowns`.
//!
//! Cases to work with are written by
//! `CASES_DIR=… KINDS=all,null COUNT=3 SEED=1 STRENGTH=60-300 cargo test --test it explain_study write_cases -- --ignored`;
//! `KINDS` is a list of kinds, `null`, `pair`, `all`, `unknown` (for development), `held_out` (for the last judgement).

mod generator;
mod scoring;

use sagnac_studies::explain::plan::Wish;
use sagnac_studies::explain::run::How;
use sagnac_studies::explain::{files, plan, run};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn environment(name: &str, otherwise: &str) -> String {
    std::env::var(name).unwrap_or_else(|_| otherwise.to_string())
}

fn number(name: &str, otherwise: &str) -> u64 {
    environment(name, otherwise).parse().expect("a number")
}

/// Runs `explain` and returns its exit code; nothing is hidden from it and nothing given but claim and recording.
fn by_the_program(recording: &Path, model: &Path, out: &Path, without: &[&str]) -> Option<i32> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sagnac"));
    command.arg("explain").arg(recording).arg("--model").arg(model).arg("--out").arg(out);
    command.args(without.iter().flat_map(|kind| ["--without", kind]));
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().ok()?.code()
}

#[test]
#[ignore = "writes cases for work by hand: CASES_DIR, KINDS, COUNT, SEED, STRENGTH"]
fn write_cases() {
    let folder = PathBuf::from(environment("CASES_DIR", "target/explain-cases"));
    let (count, first) = (number("COUNT", "1"), number("SEED", "1"));
    let strength = plan::strength(&environment("STRENGTH", "60-300"));
    for wish in plan::wishes(&environment("KINDS", "all,null")) {
        for seed in first..first + count {
            let case = plan::made(&wish, seed, strength);
            let truth = files::write(&case, &folder.join(&case.name), case.seed)
                .expect("a folder that can be written");
            assert_eq!(truth["case"], case.name.as_str());
            let strengths: Vec<String> = case.left_out.iter().map(|l| format!("{:.1}", l.strength)).collect();
            let (scenario, rows) = (case.setting.scenario, case.setting.rows);
            println!("{} {scenario:?} rows {rows} strength {}", case.name, strengths.join(" "));
        }
    }
}

/// Kinds that issue 5 asks for; the rest need the table's tests.
const FIRST_KINDS: &str = "excess_arw,excess_flicker,excess_rrw,rate_ramp,markov_short,markov_long,quasi_periodic,line,\
    quantization,bandwidth_filter,noise_variance_time,outlier_bursts,random_telegraph,bias_step,warmup_exponential,\
    diurnal,unobserved_driver,dropped_samples,time_offset,clock_drift,supply_sensitivity,temp_linear,temp_polynomial";

#[test]
fn a_few_correct_claims_are_consistent_and_clear_effects_are_found() {
    if !crate::support::long::wanted("a_few_correct_claims_are_consistent_and_clear_effects_are_found") {
        return;
    }
    let nulls = run::all(&by_the_program, &[Wish::Null], 900..906, (60.0, 60.0), How::default());
    for row in &nulls {
        assert_eq!((row.score.verdict.as_str(), row.exit), ("consistent", Some(0)), "{}", row.name);
        assert!(row.score.sane, "{}", row.name);
    }
    let rows =
        run::all(&by_the_program, &plan::wishes(FIRST_KINDS), 920..921, (250.0, 250.0), How::default());
    assert_eq!(rows.len(), 23);
    for row in &rows {
        assert!(row.score.detected, "{}: {}", row.name, row.score.verdict);
        assert!(row.exit == Some(1) || row.exit == Some(3), "{}: {:?}", row.name, row.exit);
        assert!(row.score.sane, "{}", row.name);
    }
    let named = rows.iter().filter(|r| r.score.class).count();
    assert!(named >= 21, "{named} of 23 by their names or equivalents");
}
