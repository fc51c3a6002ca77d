//! The study of the mismatch engine on cases of an independent generator.
//!
//! Cases to work with are written by
//! `CASES_DIR=… KINDS=all,null COUNT=3 SEED=1 STRENGTH=60-300 cargo test --release --test explain_study write_cases -- --ignored`.

#[allow(dead_code)]
mod explain_study_support;

use explain_study_support::{files, plan};
use std::path::PathBuf;

fn environment(name: &str, otherwise: &str) -> String {
    std::env::var(name).unwrap_or_else(|_| otherwise.to_string())
}

#[test]
#[ignore = "writes cases for work by hand: CASES_DIR, KINDS, COUNT, SEED, STRENGTH"]
fn write_cases() {
    let folder = PathBuf::from(environment("CASES_DIR", "target/explain-cases"));
    let count: u64 = environment("COUNT", "1").parse().expect("a number");
    let first: u64 = environment("SEED", "1").parse().expect("a number");
    let strength = plan::strength(&environment("STRENGTH", "60-300"));
    for wish in plan::wishes(&environment("KINDS", "all,null")) {
        for seed in first..first + count {
            let case = plan::made(&wish, seed, strength);
            let truth =
                files::write(&case, &folder.join(&case.name), seed).expect("a folder that can be written");
            assert_eq!(truth["case"], case.name.as_str());
            let strengths: Vec<String> = case.left_out.iter().map(|l| format!("{:.1}", l.strength)).collect();
            println!(
                "{} {:?} rows {} strength {}",
                case.name,
                case.setting.scenario,
                case.setting.rows,
                strengths.join(" ")
            );
        }
    }
}
