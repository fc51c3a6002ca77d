use super::*;
use crate::effect::{ClaimedMean, Column, EFFECTS, Value};
use crate::i18n::LocalText;
use crate::noise::model::NoiseModel;
use crate::noise::simulate::{Setup, Simulator};

/// The example of the contract.
const CONTRACT: &str = r#"
[recording]
case = "case-000"
description = "static, laboratory"      # free text, informative only
sample_rate_hz = 10                     # nominal
columns = ["time_s", "rate_deg_h", "temp_degC", "table_rate_deg_s"]

[noise]                                 # IEEE Std 952 coefficients
N_deg_rt_h = 0.0023                     # angle random walk
B_deg_h = 0.0017                        # bias instability (flicker)
K_deg_h_rt_h = 0.0009                   # rate random walk
quantization_lsb_arcsec = 0.06

[bias]
value_deg_h = -3.1

[temperature]                           # only with temp_degC
coefficient_deg_h_per_degC = 1.2e-4
reference_degC = 25.0

[scale_factor]                          # only with table_rate_deg_s
error_ppm = 12.0

[earth]
latitude_deg = 55.98
azimuth_deg = 12.3

[uncertainty]
N_rel = 0.015
B_rel = 0.12
K_rel = 0.15
bias_deg_h = 0.03
temperature_coefficient_deg_h_per_degC = 1e-6
scale_factor_ppm = 2.0

[[effect]]
kind = "bias_step"
[effect.parameters]
time_s = 1800.25
step_deg_h = 0.0412
rms_deg_h = 0.01
"#;

fn read(text: &str) -> Claim {
    parse("model.toml", text.as_bytes()).unwrap_or_else(|e| panic!("{e}")).claim
}

#[test]
fn the_example_of_the_contract_is_read_as_it_says() {
    let c = read(CONTRACT);
    assert_eq!((c.case.as_str(), c.description.text()), ("case-000", "static, laboratory"));
    assert_eq!(c.sample_rate_hz, 10.0);
    assert_eq!(c.columns, Some(vec![Column::Temperature, Column::TableRate]));
    assert_eq!((c.noise.n, c.noise.b, c.noise.k, c.noise.r), (0.0023, 0.0017, 0.0009, 0.0));
    assert!((c.noise.q * 12f64.sqrt() - 0.06).abs() < 1e-15 && c.quantization_lsb_arcsec == 0.06);
    assert_eq!(c.mean.bias_deg_h, -3.1);
    let t = c.mean.temperature.unwrap();
    assert_eq!((t.coefficient_deg_h_per_degc, t.reference_degc), (1.2e-4, 25.0));
    assert_eq!(c.mean.scale_factor_ppm, Some(12.0));
    let e = c.mean.earth.unwrap();
    assert_eq!((e.latitude_deg, e.azimuth_deg), (55.98, 12.3));
    let u = c.uncertainty;
    assert_eq!((u.n_rel, u.b_rel, u.k_rel, u.bias_deg_h), (0.015, 0.12, 0.15, 0.03));
    assert_eq!((u.temperature_coefficient_deg_h_per_degc, u.scale_factor_ppm), (1e-6, 2.0));
    assert_eq!(c.effects[0].values["step_deg_h"], Value::Number(0.0412));
}

#[test]
fn an_absent_table_is_zero_or_does_not_apply() {
    let c = read("[recording]\nsample_rate_hz = 100\ndescription = \"\"\n");
    assert_eq!((c.case.as_str(), c.columns), ("", None));
    assert_eq!(c.noise, NoiseModel::default());
    assert_eq!(c.mean, ClaimedMean::default());
    assert_eq!(c.uncertainty, Uncertainty::default());
    assert!(c.effects.is_empty());
}

#[test]
fn what_is_written_reads_back_to_the_bit() {
    let first = read(CONTRACT);
    let text = write(&first);
    assert_eq!(write(&read(&text)), text);
    // Any double, large, small or of many digits, in every place.
    let n = 400;
    let model = NoiseModel { n: 1.0, ..NoiseModel::default() };
    let draws = Simulator::new(&model, &Setup::for_record(8, 1.0, n)).take(n as usize);
    for pair in draws.chunks_exact(2) {
        let mut claim = first.clone();
        let scale = 10f64.powi((pair[1] as i32) % 9);
        claim.noise.n = (pair[0] * scale).abs().min(1e6);
        claim.mean.bias_deg_h = pair[0] * scale;
        claim.uncertainty.n_rel = (pair[0] / scale).abs().min(1e6);
        claim.effects[0]
            .values
            .insert("step_deg_h".into(), Value::Number((pair[0] / scale).clamp(-1e6, 1e6)));
        let again = read(&write(&claim));
        assert_eq!(again.noise.n.to_bits(), claim.noise.n.to_bits());
        assert_eq!(again.mean, claim.mean);
        assert_eq!(again.uncertainty, claim.uncertainty);
        assert_eq!(again.effects[0].values, claim.effects[0].values);
    }
}

#[test]
fn texts_with_quotes_and_line_breaks_read_back() {
    let mut claim = read(CONTRACT);
    claim.description = "a \"b\" \\ c\nsecond line".into();
    assert_eq!(read(&write(&claim)).description, claim.description);
    let both = [("en".to_owned(), "step \"1\"".to_owned()), ("ru".to_owned(), "скачок".to_owned())];
    claim.description = LocalText::in_languages(both.into(), "en");
    assert_eq!(read(&write(&claim)).description, claim.description);
}

#[test]
fn the_keys_are_in_the_order_of_the_contract() {
    let text = write(&read(CONTRACT));
    let tables: Vec<&str> = text.lines().filter(|l| l.starts_with('[')).collect();
    let expected = [
        "[recording]",
        "[noise]",
        "[bias]",
        "[temperature]",
        "[scale_factor]",
        "[earth]",
        "[uncertainty]",
        "[[effect]]",
        "[effect.parameters]",
    ];
    assert_eq!(tables, expected);
    let at = |key: &str| text.find(key).unwrap();
    assert!(at("step_deg_h") < at("time_s = ") && at("N_rel") < at("K_rel"));
}

#[test]
fn every_effect_can_be_stated_with_its_parameters_and_lists() {
    for effect in EFFECTS {
        let mut claim = read(CONTRACT);
        claim.effects.clear();
        let inside = |p: &crate::effect::Param| 0.5f64.clamp(p.lower, p.upper);
        let numbers = effect.params().iter().map(|p| (p.name.to_owned(), Value::Number(inside(p))));
        // Times must rise; twenty values in a small part of the bounds do.
        let rising = |p: &crate::effect::Param| {
            (0..20).map(|i| (0.5 + 0.01 * f64::from(i)).clamp(p.lower, p.upper)).collect::<Vec<f64>>()
        };
        let list = |p: &crate::effect::Param| (p.name.to_owned(), Value::List(rising(p)));
        let values = numbers.chain(effect.list_params().iter().map(list)).collect();
        claim.effects.push(Stated { effect: *effect, values });
        let again = read(&write(&claim));
        assert_eq!(again.effects[0].effect.kind(), effect.kind());
        assert_eq!(again.effects[0].values, claim.effects[0].values, "{}", effect.kind());
    }
}

/// Every parameter of every effect, given far outside its bounds, at them, and as no number: what is written is read.
#[test]
fn whatever_an_effect_was_fitted_to_its_claim_is_read_again() {
    for effect in EFFECTS {
        let params = || {
            effect.params().iter().map(|p| (p, false)).chain(effect.list_params().iter().map(|p| (p, true)))
        };
        for odd in [f64::NEG_INFINITY, f64::INFINITY, f64::NAN, -0.064, -1e300, 1e300, 0.0, 1.0, 1e7] {
            let given = params().map(|(p, listed)| {
                // Times of a course always rise: they are those of rows.
                let value = match (listed, p.name) {
                    (true, "knots_time_s") => Value::List(vec![0.0, 1.0, 2.0]),
                    (true, _) => Value::List(vec![odd; 3]),
                    (false, _) => Value::Number(odd),
                };
                (p.name.to_owned(), value)
            });
            let values = crate::effect::stateable(*effect, given.collect());
            for (p, _) in params() {
                match values.get(p.name) {
                    Some(Value::Number(v)) => assert!((p.lower..=p.upper).contains(v), "{} {v}", p.name),
                    Some(Value::List(list)) => assert!(list.iter().all(|v| (p.lower..=p.upper).contains(v))),
                    Some(Value::Text(text)) => panic!("{}: a text for a number, {text}", p.name),
                    None => assert!(odd.is_nan(), "{} {odd}", p.name),
                }
            }
            if odd.is_nan() {
                continue;
            }
            let mut claim = read("[recording]\nsample_rate_hz = 10\n");
            claim.effects = vec![Stated { effect: *effect, values }];
            let text = write(&claim);
            parse("augmented.toml", text.as_bytes())
                .unwrap_or_else(|e| panic!("{}: {e}\n{text}", effect.kind()));
        }
    }
}

#[test]
fn bounds_of_coefficients_stated_as_zero_are_written_and_read() {
    let mut claim = read(CONTRACT);
    claim.noise.b = 0.0;
    claim.uncertainty.b_deg_h = 0.0021;
    claim.uncertainty.k_deg_h_rt_h = 3e-4;
    claim.uncertainty.n_at_most_deg_rt_h = 0.012;
    let again = read(&write(&claim));
    assert_eq!(again.uncertainty, claim.uncertainty);
    assert!(!write(&read(CONTRACT)).contains("\nN_deg_rt_h = 0.0\n"));
}
