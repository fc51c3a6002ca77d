use super::*;
use crate::i18n::Lang;

fn every_step() -> Schedule {
    let start = Start { temp_degc: Some(20.5), ..Start::default() };
    let steps = vec![
        Step::Hold { duration_h: 1.0 / 3.0 },
        Step::Ramp { to_degc: -10.0, rate_degc_per_h: 7.5 },
        Step::Cycle { low_degc: -10.0, high_degc: 60.0, rate_degc_per_h: 30.0, soak_h: 0.5, count: 3 },
        Step::TableRates { rates_deg_s: vec![0.0, 10.0, -10.0], dwell_s: 120.0, count: 2 },
        Step::Headings { angles_deg: vec![0.0, 90.0], dwell_s: 300.0, count: 1 },
    ];
    Schedule { start, steps }
}

fn refused(text: &str) -> String {
    parse("plan.toml", text.as_bytes()).err().map(|p| p.say(Lang::En)).unwrap_or_default()
}

#[test]
fn what_is_written_reads_back() {
    let schedule = every_step();
    let again = parse("s.toml", write(&schedule).as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again, schedule);
}

#[test]
fn a_step_that_lacks_or_has_too_much_is_diagnosed_at_its_place() {
    let of = |rest: &str| refused(&format!("format = \"schedule/1\"\n[[step]]\n{rest}"));
    let said = of("do = \"ramp\"\nto_degC = 40.0\n");
    assert!(said.contains("plan.toml:3:6") && said.contains("rate_degC_per_h"), "{said}");
    let said = of("do = \"hold\"\nduration_h = 1.0\ndwell_s = 4.0\n");
    assert!(said.contains("plan.toml:5") && said.contains("dwell_s"), "{said}");
    assert!(of("do = \"headings\"\nangles_deg = []\ndwell_s = 4.0\n").contains("angles_deg"));
    assert!(
        of("do = \"cycle\"\nlow_degC = 0\nhigh_degC = 1\nrate_degC_per_h = 5\ncount = 1.5\n")
            .contains("count")
    );
    assert!(of("do = \"soak\"\n").contains("hold"));
    assert!(refused("format = \"schedule/2\"\n").contains("schedule/1"));
}
