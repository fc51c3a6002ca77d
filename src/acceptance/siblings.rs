//! A unit beside the other units of its lot: noise coefficients, temperature coefficients and the curve σ(τ) together.

use super::datasheet::TestedUnit;
use crate::i18n::{Arg, Note, note};
use crate::lot::siblings::{SIBLINGS_A_QUANTITY, Unlike, are_independent, unlike};
use crate::measurand;
use crate::record::{Message, RunRecord, SiblingQuantity, SiblingsRecord};

/// Other units that are looked at, at most: the latest.
pub const MOST_SIBLINGS: usize = 100;

/// Rate of false alarms.
const FALSE_ALARM_RATE: f64 = 0.01;
/// Quantities at most.
const MAX_QUANTITIES: usize = 6;
/// Share of the other units that must have a quantity for it to count. Those that lack one that counts are left out.
const MIN_SHARE_OF_UNITS: f64 = 0.8;
/// Quantities that a sentence names at most, and the deviation, in standard deviations, from which it names them.
const MAX_NAMED_QUANTITIES: usize = 3;
const MIN_NAMED_DEVIATION: f64 = 1.5;
/// Measurands that units are compared in, the first ones first.
const COMPARED_MEASURANDS: [&str; 6] = [
    "angle_random_walk",
    "bias_instability",
    "rate_random_walk",
    "bias_temperature_sensitivity",
    "bias_temperature_rate_sensitivity",
    "scale_factor_temperature_sensitivity",
];
/// The curve that is compared, and its averaging times, s.
const CURVE_ID: &str = "allan_deviation";
const CURVE_ESTIMATOR: &str = "oadev";
const CURVE_TIMES_S: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];
/// Ratio to the nearest of these within which a point of a curve is taken for it.
const MAX_TIME_RATIO: f64 = 1.5;

/// A quantity that units can be compared in.
struct Quantity {
    id: &'static str,
    channel: String,
    tau_s: Option<f64>,
}

impl Quantity {
    /// Its value for a unit on the scale on which units scatter: the logarithm of what is never negative.
    fn of(&self, result: &RunRecord) -> Option<f64> {
        let value = match self.tau_s {
            Some(tau_s) => {
                let same = |t: f64| (t - tau_s).abs() <= 0.01 * tau_s;
                let curve = result
                    .deviations
                    .iter()
                    .filter(|d| d.channel == self.channel && d.estimator == CURVE_ESTIMATOR);
                curve.clone().find(|d| same(d.tau_s)).map(|d| d.deviation_deg_h)
            }
            None => {
                let mut all = result.measurands.iter();
                all.find(|m| m.id == self.id && m.channel == self.channel && m.phase.is_none())?.value
            }
        }?;
        if measurand::find(self.id).is_some_and(|m| m.signed) {
            return Some(value).filter(|v| v.is_finite());
        }
        (value > 0.0 && value.is_finite()).then(|| value.ln())
    }
}

/// Every quantity that the unit has, in the order in which they count.
fn quantities(result: &RunRecord) -> Vec<Quantity> {
    let mut channels: Vec<&str> = vec![];
    for m in &result.measurands {
        if !channels.contains(&m.channel.as_str()) {
            channels.push(&m.channel);
        }
    }
    let mut all = vec![];
    for channel in &channels {
        let of = |id| Quantity { id, channel: (*channel).to_owned(), tau_s: None };
        all.extend(COMPARED_MEASURANDS.map(of));
    }
    for channel in channels {
        let curve =
            || result.deviations.iter().filter(|d| d.channel == channel && d.estimator == CURVE_ESTIMATOR);
        for wanted in CURVE_TIMES_S {
            let near = |t: f64| (t / wanted).ln().abs();
            let nearest = curve().map(|d| d.tau_s).min_by(|a, b| near(*a).total_cmp(&near(*b)));
            let tau_s = nearest.filter(|t| near(*t) <= MAX_TIME_RATIO.ln());
            all.extend(tau_s.map(|t| Quantity { id: CURVE_ID, channel: channel.to_owned(), tau_s: Some(t) }));
        }
    }
    all.retain(|q| q.of(result).is_some());
    all
}

/// The unit beside the other units of its lot; `None` where they are too few, or nothing of them can be compared.
pub fn siblings(unit: &RunRecord, model: &str, lot: &str, others: &[TestedUnit]) -> Option<SiblingsRecord> {
    let shared = |q: &Quantity| {
        let having = others.iter().filter(|o| q.of(&o.result).is_some()).count();
        having as f64 >= MIN_SHARE_OF_UNITS * others.len() as f64
    };
    let of = |chosen: &[Quantity], result: &RunRecord| -> Option<Vec<f64>> {
        chosen.iter().map(|q| q.of(result)).collect()
    };
    let values = |chosen: &[Quantity]| -> Vec<Vec<f64>> {
        others.iter().filter_map(|o| of(chosen, &o.result)).collect()
    };
    let mut chosen: Vec<Quantity> = vec![];
    for quantity in quantities(unit).into_iter().filter(shared) {
        chosen.push(quantity);
        let values = values(&chosen);
        let enough = values.len() >= SIBLINGS_A_QUANTITY * chosen.len();
        if !enough || !are_independent(&values) {
            chosen.pop();
        }
        if chosen.len() == MAX_QUANTITIES {
            break;
        }
    }
    let values = values(&chosen);
    let found = unlike(&of(&chosen, unit)?, &values)?;
    Some(record(model, lot, values.len(), &chosen, &found))
}

fn record(model: &str, lot: &str, units: usize, chosen: &[Quantity], found: &Unlike) -> SiblingsRecord {
    let unlike = found.p_value < FALSE_ALARM_RATE;
    let quantities: Vec<SiblingQuantity> = chosen
        .iter()
        .zip(&found.deviations)
        .map(|(q, deviation)| SiblingQuantity {
            id: q.id.to_owned(),
            channel: q.channel.clone(),
            tau_s: q.tau_s,
            deviation: *deviation,
        })
        .collect();
    let summary = if unlike { notes(lot, units, found.p_value, &quantities) } else { vec![] };
    SiblingsRecord {
        model: model.to_owned(),
        lot: lot.to_owned(),
        units,
        quantities,
        p_value: found.p_value,
        false_alarm_rate: FALSE_ALARM_RATE,
        unlike,
        summary: summary.into_iter().map(Message::from).collect(),
    }
}

/// That the unit is unlike the others, and in what.
fn notes(lot: &str, units: usize, p_value: f64, quantities: &[SiblingQuantity]) -> Vec<Note> {
    let unlike = note!(
        "siblings.unlike",
        lot = Arg::from(lot),
        units = units as u64,
        p = format!("{:.2}", 100.0 * p_value),
        rate = 100.0 * FALSE_ALARM_RATE
    );
    let mut order: Vec<&SiblingQuantity> =
        quantities.iter().filter(|q| q.deviation.abs() >= MIN_NAMED_DEVIATION).collect();
    order.sort_by(|a, b| b.deviation.abs().total_cmp(&a.deviation.abs()));
    let several = quantities.iter().any(|q| quantities.first().is_some_and(|f| f.channel != q.channel));
    let one = |q: &&SiblingQuantity| -> Arg {
        let id = if q.tau_s.is_some() { "siblings.at_tau" } else { "siblings.measurand" };
        let channel = if several { format!(" ({})", q.channel) } else { String::new() };
        let mut note =
            Note::new(id).with("channel", channel).with("deviation", format!("{:+.1}", q.deviation));
        note = match q.tau_s {
            Some(tau_s) => note.with("tau", tau_s),
            None => note.with("name", Arg::key("measurand", &q.id)),
        };
        note.into()
    };
    let list: Vec<Arg> = order.iter().take(MAX_NAMED_QUANTITIES).map(one).collect();
    let second = if list.is_empty() {
        note!("siblings.together")
    } else {
        note!("siblings.furthest", list = Arg::Several(list, "; ".into()))
    };
    vec![unlike, second]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};
    use crate::record::read;

    /// A unit with a coefficient of random walk, a bias instability and two points of its curve.
    fn input(arw: f64, bias_instability: f64, more: &str) -> RunRecord {
        let measurand = |id: &str, value: f64| {
            format!(r#"{{"id": "{id}", "channel": "x", "unit": "deg/h", "value": {value}}}"#)
        };
        let point = |tau: f64, value: f64| {
            format!(
                r#"{{"channel": "x", "estimator": "oadev", "tau_s": {tau}, "deviation_deg_h": {value},
                "low_deg_h": null, "high_deg_h": null, "edf": 10}}"#
            )
        };
        let text = format!(
            r#"{{"unit_under_test": {{}}, "verdict": "pass", "measurands": [{}, {} {more}],
            "deviations": [{}, {}]}}"#,
            measurand("angle_random_walk", arw),
            measurand("bias_instability", bias_instability),
            point(1.024, 60.0 * arw),
            point(98.3, 2.0 * bias_instability),
        );
        let members = ["verdict", "measurands", "deviations"];
        read::with_members(serde_json::from_str(&text).unwrap(), &members).unwrap()
    }

    /// Units whose coefficients scatter by a tenth, each by itself.
    fn others(count: usize) -> Vec<TestedUnit> {
        let scatter = |i: usize, k: usize| (0.1 * (((i * k) % 11) as f64 / 3.2 - 1.56)).exp();
        let one = |i: usize| TestedUnit {
            serial: i.to_string(),
            path: String::new(),
            sha256: String::new(),
            result: input(0.002 * scatter(i, 3), 0.01 * scatter(i, 7), ""),
            tables: vec![],
        };
        (1..=count).map(one).collect()
    }

    #[test]
    fn a_unit_unlike_its_lot_is_named_with_what_it_is_unlike_in() {
        let found = siblings(&input(0.0031, 0.0101, ""), "A", "L1", &others(24)).unwrap();
        assert!(found.unlike && found.p_value < 0.01 && found.units == 24, "{found:?}");
        assert_eq!(found.quantities[0].id, "angle_random_walk");
        assert!(found.quantities[0].deviation > 3.0, "{found:?}");
        let said: Vec<String> = found.summary.iter().map(|m| m.say(Lang::En)).collect();
        assert!(said[0].contains("L1") && said[0].contains("24"), "{said:?}");
        assert!(said[1].contains("Angle random walk") || said[1].contains("angle random walk"), "{said:?}");
        let like = siblings(&input(0.00201, 0.0101, ""), "A", "L1", &others(24)).unwrap();
        assert!(!like.unlike && like.summary.is_empty() && like.p_value > 0.05, "{like:?}");
    }

    #[test]
    fn quantities_that_follow_from_others_are_left_out() {
        // A point of the curve is 60 times the coefficient in every unit: the two are one.
        let found = siblings(&input(0.002, 0.01, ""), "A", "L1", &others(24)).unwrap();
        let ids: Vec<&str> = found.quantities.iter().map(|q| q.id.as_str()).collect();
        assert_eq!(ids, ["angle_random_walk", "bias_instability"]);
        assert!(siblings(&input(0.002, 0.01, ""), "A", "L1", &others(7)).is_none());
    }
}
