//! What no procedure or limits file may do: panic, hang, or be refused without a reason.

use proptest::prelude::*;
use sagnac::config::procedure::tables::PROCEDURE_FILE;
use sagnac::config::procedure::{load, parse_limits, parse_procedure};
use std::path::Path;

const SHIPPED: &str = include_str!("../../../procedures/static-bias.toml");

#[test]
fn files_that_cannot_be_read_say_so() {
    let missing = load(Path::new("no/such/procedure.toml")).unwrap_err().to_string();
    assert!(missing.contains("no/such/procedure.toml") && missing.contains("cannot be read"), "{missing}");
    let folder = load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("procedures")).unwrap_err().to_string();
    assert!(folder.contains("folder"), "{folder}");
    let large = parse_procedure("large", &vec![b'\n'; 1 << 21]).unwrap_err().to_string();
    assert!(large.contains("larger than"), "{large}");
}

#[test]
fn windows_line_ends_and_a_byte_order_mark_are_no_problem() {
    let text = format!("\u{feff}{}", SHIPPED.replace('\n', "\r\n"));
    let p = parse_procedure("p", text.as_bytes()).unwrap();
    assert_eq!(p.value.title.text(), "Static bias and noise");
}

#[test]
fn hostile_files_end_in_bounded_time() {
    let started = std::time::Instant::now();
    let texts = [
        "[".repeat(1 << 19),
        "[\n".repeat(1 << 19),
        format!("{} = 1", vec!["a"; 1 << 18].join(".")),
        format!("[{}]", vec!["a"; 1 << 18].join(".")),
        "a = \"\n".repeat(1 << 17),
        (0..60_000).map(|i| format!("k{i} = 1\n")).collect(),
        format!("x = {{{}}}", (0..60_000).map(|i| format!("k{i} = 1, ")).collect::<String>()),
        "[[channel]]\n".repeat(80_000),
        format!("[[channel]]\nunit = \"{}\"", "(".repeat(1 << 18)),
        format!("[conditions]\nwarm_up = \"{} s\"", "9".repeat(1 << 19)),
        "'''".repeat(1 << 18),
    ];
    for text in &texts {
        assert!(parse_procedure("h", text.as_bytes()).is_err());
        assert!(parse_limits("h", text.as_bytes()).is_err());
    }
    // Seconds where optimised; time that grows with the square of the length would be hours.
    assert!(started.elapsed().as_secs() < 120, "{:?}", started.elapsed());
}

/// Values that no key expects, the empty text and what steers a terminal among them.
const ODD: [&str; 18] = [
    "\"\"",
    "0",
    "-1",
    "1e308",
    "1e999",
    "99999999999999999999999",
    "nan",
    "true",
    "[]",
    "{}",
    "[1, \"a\"]",
    "1979-05-27",
    "\"\\u0000\"",
    "\"\\u001b]0;PASS\\u0007\"",
    "\"\\u202e\"",
    "\"1e400 deg/h\"",
    "\"../../etc/passwd\"",
    "\"no_such_id\"",
];

#[test]
fn any_line_of_a_shipped_file_may_hold_an_odd_value() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("procedures");
    let mut files = 0;
    for (below, limits) in [("", false), ("limits", true)] {
        for entry in std::fs::read_dir(folder.join(below)).unwrap() {
            let path = entry.unwrap().path();
            let Ok(text) = std::fs::read_to_string(&path) else { continue };
            files += 1;
            let lines: Vec<&str> = text.lines().collect();
            let keys = lines.iter().enumerate().filter(|(_, l)| l.contains(" = ") && !l.starts_with('#'));
            for (at, line) in keys {
                let odd = [ODD[at % ODD.len()], ODD[(at * 7 + files) % ODD.len()]];
                for value in odd {
                    let mut changed = lines.clone();
                    let put = format!("{} = {value}", line.split(" = ").next().unwrap());
                    changed[at] = &put;
                    let changed = changed.join("\n");
                    let problems = if limits {
                        parse_limits("x", changed.as_bytes()).err()
                    } else {
                        parse_procedure("x", changed.as_bytes()).err()
                    };
                    for problem in problems.iter().flat_map(|p| &p.list) {
                        let said = problem.to_string();
                        let place = format!("x:{}:{}", problem.line, problem.column);
                        assert!(
                            problem.line >= 1 && problem.column >= 1 && said.contains(&place),
                            "{put}: {said}"
                        );
                        let steers = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
                        assert!(!said.contains(steers), "{put}: {said:?}");
                    }
                }
            }
        }
    }
    assert!(files >= 20, "{files}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_bytes_are_refused_and_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(parse_procedure("b", &bytes).is_err());
        prop_assert!(parse_limits("b", &bytes).is_err());
    }

    #[test]
    fn a_damaged_procedure_never_panics(
        at in 0usize..6000,
        length in 0usize..40,
        put in r#"[\[\]{}="'.#a-z0-9 \nµ°°,\-+e%/()√]{0,20}"#,
    ) {
        let text = SHIPPED;
        let start = (0..=at.min(text.len())).rev().find(|i| text.is_char_boundary(*i)).unwrap();
        let end = (start + length..=text.len()).find(|i| text.is_char_boundary(*i)).unwrap_or(text.len());
        let damaged = format!("{}{put}{}", &text[..start], &text[end.max(start)..]);
        if let Err(problems) = parse_procedure("d", damaged.as_bytes()) {
            prop_assert!(!problems.list.is_empty());
            for problem in &problems.list {
                prop_assert!(problem.line >= 1 && problem.line <= damaged.lines().count() + 1);
                prop_assert!(!problem.to_string().is_empty());
            }
        }
    }

    #[test]
    fn any_value_at_any_key_is_read_or_refused(key in 0usize..400, value in prop_oneof![
        Just("1".to_owned()), Just("-1.5e300".to_owned()), Just("true".to_owned()), Just("[]".to_owned()),
        Just("[[1], {}]".to_owned()), Just("{}".to_owned()), Just("1979-05-27T07:32:00Z".to_owned()),
        Just("nan".to_owned()), Just("0xFFFFFFFFFFFFFFFFFFFF".to_owned()), "\"[ -~]{0,12}\"",
    ]) {
        let all: Vec<(&str, &str)> =
            PROCEDURE_FILE.walk().into_iter().flat_map(|t| t.keys.iter().map(|k| (t.name, k.name))).collect();
        let (table, name) = all[key % all.len()];
        let text = if table.is_empty() { format!("{name} = {value}") } else { format!("[{table}]\n{name} = {value}") };
        prop_assert!(parse_procedure("v", text.as_bytes()).is_err());
    }
}
