//! The judge of the study is judged: scores of hand-made reports, and the fit given the truth against closed forms.

use sagnac_studies::explain::case::{Case, single};
use sagnac_studies::explain::classes::{CLASSES, SUBSTITUTES, same_class};
use sagnac_studies::explain::draw::Draw;
use sagnac_studies::explain::files;
use sagnac_studies::explain::kinds::{DEVELOPMENT_UNKNOWNS, HELD_OUT_UNKNOWNS, KINDS, find};
use sagnac_studies::explain::oracle::told;
use sagnac_studies::explain::rows::of_kinds;
use sagnac_studies::explain::scenario::Scenario;
use sagnac_studies::explain::score::{located, removed, score};
use sagnac_studies::explain::setting::Setting;
use sagnac_studies::explain::table::{Row, Tally};
use serde_json::{Value, json};

fn line_case() -> (Case, Value, (Vec<f64>, Vec<f64>)) {
    let case = single(31, find("line").expect("a kind"), (120.0, 120.0));
    let made = case.realise(31);
    let truth = files::truth(&case, &made);
    let contribution = files::contribution(&case, &made).expect("a line adds");
    (case, truth, contribution)
}

fn fit(gain: f64) -> Value {
    let side = |l: f64, rms: f64| json!({"log_likelihood": l, "heldout_log_likelihood": 0.5 * l, "heldout_rms_deg_h": rms});
    json!({"heldout_tau_s": 1.0, "baseline": side(-1000.0, 0.2), "augmented": side(-1000.0 + gain, 0.19)})
}

fn report(kind: &str, truth: &Value) -> Value {
    let value = |name: &str| truth["effects"][0]["parameters"][name].as_f64().expect("a parameter");
    let (f, a) = (value("frequency_hz"), value("amplitude_deg_h"));
    json!({
        "verdict": "mismatch",
        "effects": [{
            "kind": kind,
            "equivalents": [],
            "parameters": {
                "frequency_hz": {"value": f, "unit": "Hz", "ci95": [0.999 * f, 1.001 * f]},
                "amplitude_deg_h": {"value": 2.0 * a, "unit": "deg/h", "ci95": [1.5 * a, 2.5 * a]},
                "phase_deg": {"value": 1.0, "unit": "deg", "ci95": [0.0, 2.0]},
            },
            "where": {"domain": "frequency", "from": 0.9999 * f, "to": 1.0001 * f},
        }],
        "fit": fit(120.0),
    })
}

#[test]
fn a_right_report_scores_and_a_wrong_one_does_not() {
    let (_, truth, contribution) = line_case();
    let right = score(&truth, &report("line", &truth), Some(&contribution), Some(&contribution));
    assert!(right.detected && right.first && right.class && right.all_named && right.located && right.sane);
    assert_eq!((right.surplus, right.covered.len()), (0, 2));
    let inside: Vec<(&str, bool)> = right.covered.iter().map(|c| (c.name.as_str(), c.inside)).collect();
    assert!(inside.contains(&("frequency_hz", true)) && inside.contains(&("amplitude_deg_h", false)));
    assert!((right.removed.expect("a contribution") - 1.0).abs() < 1e-12);
    assert!((right.held_out_gain - 60.0).abs() < 1e-9);

    let wrong = score(&truth, &report("rate_ramp", &truth), None, Some(&contribution));
    assert!(wrong.detected && !wrong.first && !wrong.class && !wrong.all_named);
    assert_eq!((wrong.surplus, wrong.covered.len(), wrong.removed), (1, 0, Some(0.0)));

    let mut equivalent = report("quasi_periodic", &truth);
    equivalent["effects"][0]["equivalents"] = json!(["diurnal", "bias_step", "line", "markov_long"]);
    let third = score(&truth, &equivalent, None, Some(&contribution));
    assert!(!third.first && third.class);
    equivalent["effects"][0]["equivalents"] = json!(["diurnal", "bias_step", "markov_long", "line"]);
    assert!(
        !score(&truth, &equivalent, None, Some(&contribution)).class,
        "a fourth equivalent does not count"
    );
}

#[test]
fn silence_and_nonsense_are_seen() {
    let (_, truth, contribution) = line_case();
    let silent = json!({"verdict": "consistent", "effects": [], "fit": fit(0.0)});
    let s = score(&truth, &silent, None, Some(&contribution));
    assert!(
        !s.detected && !s.class && !s.located && !s.sane,
        "figures that differ are not those of a consistent claim"
    );
    assert!(!score(&truth, &Value::Null, None, None).sane);
    let null = json!({"effects": [], "rows": 10, "duration_s": 10.0});
    let alarm = score(&null, &report("line", &truth), None, None);
    assert!(alarm.null && alarm.detected && alarm.surplus == 1);
    let rows = vec![Row { score: alarm, ..Row::default() }, Row { score: s, ..Row::default() }];
    let tally = Tally::of(rows.iter());
    assert_eq!((tally.cases, tally.detected, tally.sane), (2, 1, 1));
    assert!(of_kinds(&rows).iter().any(|r| r.quantity == "null"));
}

#[test]
fn wide_brackets_do_not_locate() {
    let (_, truth, _) = line_case();
    let t = &truth["effects"][0];
    let f = t["parameters"]["frequency_hz"].as_f64().expect("a frequency");
    let at = |domain: &str, from: f64, to: f64| json!({"where": {"domain": domain, "from": from, "to": to}});
    assert!(located(&at("frequency", 0.96 * f, 1.03 * f), t, 1.0));
    assert!(!located(&at("frequency", 0.5 * f, 1.5 * f), t, 1.0));
    assert!(!located(&at("frequency", 1.2 * f, 1.21 * f), t, 1.0));
    assert!(!located(&at("lag", 0.96 * f, 1.03 * f), t, 1.0));
    let several = json!({"where": [{"domain": "lag", "from": 0, "to": 1}, {"domain": "frequency", "from": f, "to": f}]});
    assert!(located(&several, t, 1.0));
    let step =
        json!({"parameters": {}, "where": [{"domain": "time", "from": 97.0, "to": 103.0, "local": true}]});
    assert!(located(&at("time", 90.0, 110.0), &step, 1.0));
    assert!(!located(&at("time", 50.0, 110.0), &step, 1.0));
}

#[test]
fn corrections_are_interpolated_and_their_mean_is_free() {
    let t: Vec<f64> = (0..100).map(f64::from).collect();
    let y: Vec<f64> = t.iter().map(|t| 0.3 * t).collect();
    let few = (vec![0.0, 50.0, 99.0], vec![7.0, 22.0, 36.7]);
    assert!((removed(&(t.clone(), y.clone()), Some(&few)) - 1.0).abs() < 1e-12);
    let half: Vec<f64> = y.iter().map(|y| 0.5 * y).collect();
    assert!((removed(&(t.clone(), y.clone()), Some(&(t.clone(), half))) - 0.75).abs() < 1e-12);
    assert_eq!(removed(&(t, y), None), 0.0);
}

/// A record of white noise alone, of which N is known.
fn white_case(kind: &str, amplitude: f64) -> Case {
    let mut setting = Setting::drawn(17, Scenario::Static);
    (setting.claim.b, setting.claim.k) = (0.0, 0.0);
    setting.departure = Default::default();
    setting.claim.uncertainty.n_rel = 1e-9;
    let effect = (find(kind).expect("a kind").make)(&mut Draw::new(8, "x"), &setting, amplitude);
    let left = sagnac_studies::explain::case::Left { effect, strength: 0.0 };
    Case { name: kind.into(), seed: 8, setting, left_out: vec![left], stated: Vec::new() }
}

#[test]
fn the_fit_told_the_truth_has_the_published_errors() {
    let two_sided = 2.0 * 1.959_964;
    let case = white_case("line", 3.0);
    let s = &case.setting;
    let sigma = s.claim.white_sigma();
    let told_line = told(&case, &case.realise(1));
    let width = |name: &str| told_line.widths.iter().find(|(n, _)| *n == name).expect("a width").1;
    let value = |name: &str| {
        case.left_out[0].effect.parameters.iter().find(|(n, _)| *n == name).expect("a parameter").1
    };
    // Rife and Boorstyn 1974: var(A) = 2σ²/n, var(ω) = 24 σ²/(A² n T²), A as the samples show it.
    let n = s.rows as f64;
    let sinc = |x: f64| (std::f64::consts::PI * x).sin() / (std::f64::consts::PI * x);
    let seen = sinc(value("frequency_hz") * s.interval_s());
    let amplitude = two_sided * (2.0 / n).sqrt() * sigma / seen;
    assert!((width("amplitude_deg_h") / amplitude - 1.0).abs() < 0.02, "{amplitude}: {:?}", told_line.widths);
    let size = value("amplitude_deg_h") * seen;
    let omega = (24.0 / n).sqrt() * sigma / (size * s.duration_s());
    let expected = two_sided * omega / std::f64::consts::TAU;
    assert!((width("frequency_hz") / expected - 1.0).abs() < 0.02, "{expected}: {:?}", told_line.widths);
    // N from n samples: relative deviation 1/√(2n).
    let case = white_case("excess_arw", 1.0);
    let told_n = told(&case, &case.realise(1));
    let total = case.left_out[0].effect.parameters[0].1;
    let expected = two_sided * total / (2.0 * case.setting.rows as f64).sqrt();
    assert!((told_n.widths[0].1 / expected - 1.0).abs() < 0.01, "{:?}", told_n.widths);
    assert_eq!(told_n.removed, None);
}

#[test]
fn the_course_of_a_process_is_predicted_as_well_as_theory_allows() {
    let case = white_case("markov_long", 30.0);
    let made = case.realise(4);
    let removed = told(&case, &made).removed.expect("a process adds");
    // Σ P²/(P + λ) over Σ P, from the closed forms alone.
    let s = &case.setting;
    let Some(sagnac_studies::explain::effect::Process::Markov { sigma, time_s }) =
        case.left_out[0].effect.process
    else {
        panic!("a Markov process");
    };
    let (mut kept, mut all) = (0.0, 0.0);
    for k in 1..s.rows {
        let f = sagnac_studies::explain::modes::mode_frequency(k, s.rows, s.claim.rate_hz);
        let p = sagnac_studies::explain::noise::markov_variance(f, s.claim.rate_hz, sigma, time_s);
        kept += p * p / (p + s.claim.mode_variance(f, [0.0; 3]));
        all += p;
    }
    assert!((removed - kept / all).abs() < 0.05, "{removed} against {}", kept / all);
}

#[test]
fn classes_hold_kinds_of_the_contract_only() {
    let known = |name: &str| KINDS.iter().any(|k| k.name == name);
    assert!(CLASSES.iter().flat_map(|(_, members, _)| members.iter()).all(|m| known(m)));
    assert!(SUBSTITUTES.iter().flat_map(|(_, allowed)| allowed.iter()).all(|m| known(m)));
    let foreign: Vec<&str> = DEVELOPMENT_UNKNOWNS.iter().chain(HELD_OUT_UNKNOWNS).map(|k| k.name).collect();
    assert!(foreign.len() >= 12);
    assert!(foreign.iter().all(|name| SUBSTITUTES.iter().any(|(n, _)| n == name)));
    assert_eq!(same_class("bias_step", Scenario::Fixed), ["heading_change"]);
    assert!(same_class("bias_step", Scenario::Headings).is_empty());
    assert!(same_class("echo", Scenario::Static).is_empty());
}
