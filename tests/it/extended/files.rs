//! Hard records as files: through the program, and no value that is no number in anything that it writes.

use crate::extended::exact::records::{Record, hard_records};
use crate::support::{both, files, result};
use rayon::prelude::*;
use std::fmt::Write;
use tempfile::tempdir;

/// What a careless sum would print; none of these records holds a figure of such size.
const OVERFLOWN: f64 = 1e300;

fn assert_sound(folder: &std::path::Path, name: &str) {
    for (path, bytes) in files(folder) {
        let text = String::from_utf8(bytes).unwrap();
        for word in text.split([' ', ',', '\n', '>', '<', '"', ':', '[', ']', '{', '}']) {
            // A word is judged as a number, since a hash may contain `e308`.
            let number =
                word.ends_with(|c: char| c.is_ascii_digit()).then(|| word.parse::<f64>().ok()).flatten();
            assert!(number.is_none_or(|n| n.abs() < OVERFLOWN), "{name}: `{word}` in {}", path.display());
            assert!(!["-0", "-0.0", "−0"].contains(&word), "{name}: a negative zero in {}", path.display());
        }
    }
}

#[test]
fn hard_records_give_figures_or_a_refusal_and_never_a_word() {
    let evaluated = |record: &Record| {
        let mut text = String::from("time_s,rate_deg_h,temp_degC\n");
        for (first, y) in &record.stretches {
            for (i, v) in y.iter().enumerate() {
                writeln!(text, "{},{v:e},20", first + i as u64).unwrap();
            }
        }
        let dir = tempdir().unwrap();
        std::fs::write(dir.path().join("r.csv"), text).unwrap();
        let (analysed, run) = both(dir.path(), "r.csv");
        for (said, out) in [(&analysed, "a"), (&run, "r")] {
            assert!(said.code != 1, "{}: {said:?}", record.name);
            if said.code == 2 {
                assert_eq!(said.err.matches("error: ").count(), 1, "{}: {said:?}", record.name);
            }
            if dir.path().join(out).is_dir() {
                assert_sound(&dir.path().join(out), record.name);
            }
        }
        if analysed.code != 0 {
            assert!(record.samples().count() < 2, "{}: {analysed:?}", record.name);
            return false;
        }
        let found = result(&dir.path().join("a"));
        if record.range() == 0.0 {
            // Nothing moves: no noise term is claimed.
            let terms = found["noise_models"][0]["terms"].as_array().unwrap();
            assert!(terms.is_empty(), "{}: {terms:?}", record.name);
        }
        true
    };
    // Seconds each: what is no noise at all is sought for processes of every length.
    let slow = ["whole numbers up to 2^53", "ramp of 1e9 a sample"];
    let slow_too = crate::support::long::wanted(
        "hard_records_give_figures_or_a_refusal_and_never_a_word: the slow ones",
    );
    let records = hard_records().into_par_iter().filter(|r| slow_too || !slow.contains(&r.name));
    let evaluated = records.filter(|r| evaluated(r)).count();
    assert!(evaluated >= 20, "{evaluated}");
}

#[test]
fn records_beyond_the_range_are_refused_or_zero() {
    for (name, text) in
        [("1e308", "1e308"), ("-1e308", "-1e308"), ("nan", "nan"), ("1e-310", "1e-310"), ("-0.0", "-0.0")]
    {
        let mut rows = String::from("time_s,rate_deg_h,temp_degC\n");
        (0..1000).for_each(|i| writeln!(rows, "{i},{text},20").unwrap());
        let dir = tempdir().unwrap();
        std::fs::write(dir.path().join("r.csv"), rows).unwrap();
        let (analysed, _) = both(dir.path(), "r.csv");
        if ["1e-310", "-0.0"].contains(&name) {
            assert_eq!(analysed.code, 0, "{name}: {analysed:?}");
            assert_sound(&dir.path().join("a"), name);
            let bias =
                crate::support::measurand(&result(&dir.path().join("a")), "static_bias")["value"].as_f64();
            assert_eq!(bias.map(f64::to_bits), Some(0), "{name}");
        } else {
            assert_eq!(analysed.code, 2, "{name}: {analysed:?}");
            assert_eq!(analysed.err.matches("error: ").count(), 1, "{name}: {analysed:?}");
        }
    }
}
