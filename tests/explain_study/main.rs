//! The study of the mismatch engine on cases of an independent generator.
//!
//! Cases to work with are written by
//! `CASES_DIR=… KINDS=all,null COUNT=3 SEED=1 STRENGTH=60-300 cargo test --release --test explain_study write_cases -- --ignored`;
//! the program is judged by
//! `KINDS=all COUNT=100 SEED=1 STRENGTH=60-300 cargo test --release --test explain_study study -- --ignored --nocapture`.
//! `KINDS` is a list of kinds, `null`, `pair`, `all`, `unknown` (for development), `held_out` (for the last judgement);
//! `REMOVED=1` takes what was left out of each claim out of the catalogue as well (`--without`); `CLOSE=1` adds the closed loop; `KEEP=FOLDER` keeps the files; `PROGRAM` judges another build.

mod generator;
mod scoring;
mod support;

use std::path::PathBuf;
use support::plan::Wish;
use support::run::How;
use support::table::{Row, Tally, by_kind, by_parameter, by_strength};
use support::{files, plan, run};

const BUILT: &str = env!("CARGO_BIN_EXE_sagnac");

fn environment(name: &str, otherwise: &str) -> String {
    std::env::var(name).unwrap_or_else(|_| otherwise.to_string())
}

fn number(name: &str, otherwise: &str) -> u64 {
    environment(name, otherwise).parse().expect("a number")
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

/// False alarms: at most 30 of 2000, and below 500 cases what chance allows at that rate.
fn hold_nulls(rows: &[Row]) {
    let tally = Tally::of(rows.iter().filter(|r| r.score.null));
    let expected = 0.015 * tally.cases as f64;
    let allowed = if tally.cases < 500 { expected + 3.0 * expected.sqrt() } else { expected };
    assert!(tally.detected as f64 <= allowed, "{} alarms in {} correct claims", tally.detected, tally.cases);
    assert_eq!(tally.sane, tally.cases, "figures of fit");
}

/// What clear cases of the contract's kinds must give.
fn hold_clear(rows: &[Row]) {
    let known = |r: &&Row| !r.score.null && support::effect::catalogued(&r.score.kind);
    let t = Tally::of(rows.iter().filter(known));
    if t.cases == 0 {
        return;
    }
    let share = |count: usize, of: usize| count as f64 / of.max(1) as f64;
    assert!(share(t.detected, t.cases) >= 0.99, "detected {} of {}", t.detected, t.cases);
    assert!(share(t.first, t.cases) >= 0.85, "right name first in {} of {}", t.first, t.cases);
    assert!(share(t.class, t.cases) >= 0.95, "right name or equivalent in {} of {}", t.class, t.cases);
    assert!(share(t.located, t.cases) >= 0.90, "located {} of {}", t.located, t.cases);
    let cover = share(t.inside, t.intervals);
    let chance = 2.0 * (0.95 * 0.05 / t.intervals.max(1) as f64).sqrt();
    assert!((0.93 - chance..=0.97 + chance).contains(&cover), "intervals hold the truth in {cover}");
    assert!(t.width_ratio.is_some_and(|r| r <= 1.3), "width over the told fit's {:?}", t.width_ratio);
    assert!(
        t.removed_ratio.is_some_and(|r| r >= 0.9),
        "removed variance over the told fit's {:?}",
        t.removed_ratio
    );
    if t.looped > 0 {
        let names = ["the same recording", "a fresh one", "one of another case"];
        for (count, name) in t.loops.iter().zip(names) {
            assert!(share(*count, t.looped) >= 0.95, "closed loop, {name}: {count} of {}", t.looped);
        }
    }
}

/// Two effects at once, and effects of no catalogue.
fn hold_others(rows: &[Row]) {
    let pairs = Tally::of(rows.iter().filter(|r| r.score.kind == "pair"));
    if pairs.cases > 0 {
        assert!(
            pairs.all_named * 10 >= pairs.cases * 8,
            "both named in {} of {}",
            pairs.all_named,
            pairs.cases
        );
        assert!(pairs.surplus * 20 <= pairs.cases, "a third named in {} of {}", pairs.surplus, pairs.cases);
    }
    let foreign =
        |r: &&Row| !r.score.null && r.score.kind != "pair" && !support::effect::catalogued(&r.score.kind);
    let right = rows.iter().filter(foreign).filter(|r| r.score.class && r.score.located).count();
    let all = rows.iter().filter(foreign).count();
    assert!(right * 4 >= all * 3, "unknown, in the right place, in {right} of {all}");
}

#[test]
#[ignore = "hours: KINDS, COUNT, SEED, STRENGTH, CLOSE, KEEP"]
fn study() {
    let wishes = plan::wishes(&environment("KINDS", "null,all,pair,unknown"));
    let (count, first) = (number("COUNT", "20"), number("SEED", "1"));
    let word = environment("STRENGTH", "60-300");
    let strength = plan::strength(&word);
    let keep = std::env::var("KEEP").ok().map(PathBuf::from);
    let set = |name: &str| environment(name, "0") == "1";
    let how = How { close: set("CLOSE"), removed: set("REMOVED") };
    let program = environment("PROGRAM", BUILT);
    let rows = run::all(&program, &wishes, first..first + count, strength, how, keep.as_deref());
    println!("{}\n{}\n{}", by_kind(&rows), by_strength(&rows), by_parameter(&rows));
    for row in rows.iter().filter(|r| r.score.null == r.score.detected || !r.score.null && !r.score.class) {
        println!("{}: {} exit {:?}", row.name, row.score.verdict, row.exit);
    }
    assert_eq!(rows.len(), wishes.len() * count as usize);
    hold_nulls(&rows);
    if how.removed {
        let right = rows.iter().filter(|r| r.score.class && r.score.located).count();
        assert!(right * 4 >= rows.len() * 3, "unknown or a replacement, in the right place, in {right}");
    } else if strength.0 >= 60.0 {
        hold_clear(&rows);
        hold_others(&rows);
    }
}

/// Kinds that issue 5 asks for; the rest need the table's tests.
const FIRST_KINDS: &str = "excess_arw,excess_flicker,excess_rrw,rate_ramp,markov_short,markov_long,quasi_periodic,line,\
    quantization,bandwidth_filter,noise_variance_time,outlier_bursts,random_telegraph,bias_step,warmup_exponential,\
    diurnal,unobserved_driver,dropped_samples,time_offset,clock_drift,supply_sensitivity,temp_linear,temp_polynomial";

#[test]
fn a_few_correct_claims_are_consistent_and_clear_effects_are_found() {
    let nulls = run::all(BUILT, &[Wish::Null], 900..906, (60.0, 60.0), How::default(), None);
    for row in &nulls {
        assert_eq!((row.score.verdict.as_str(), row.exit), ("consistent", Some(0)), "{}", row.name);
        assert!(row.score.sane, "{}", row.name);
    }
    let rows = run::all(BUILT, &plan::wishes(FIRST_KINDS), 920..921, (250.0, 250.0), How::default(), None);
    assert_eq!(rows.len(), 23);
    for row in &rows {
        assert!(row.score.detected, "{}: {}", row.name, row.score.verdict);
        assert!(row.exit == Some(1) || row.exit == Some(3), "{}: {:?}", row.name, row.exit);
        assert!(row.score.sane, "{}", row.name);
    }
    let named = rows.iter().filter(|r| r.score.class).count();
    assert!(named >= 21, "{named} of 23 by their names or equivalents");
}
