//! A report set against the truth of its case.

use serde_json::Value;

/// One stated interval that has a truth.
#[derive(Clone, Debug)]
pub struct Covered {
    /// Name of the parameter.
    pub name: String,
    /// The interval holds the truth.
    pub inside: bool,
    /// Width of the 95 % interval, in the parameter's unit.
    pub width: f64,
}

/// What a report was worth.
#[derive(Clone, Debug, Default)]
pub struct Score {
    /// Kind of the effect left out; `pair` or `null`.
    pub kind: String,
    /// Truth: the claim is right.
    pub null: bool,
    /// The claim is called a mismatch.
    pub detected: bool,
    /// Verdict of the report.
    pub verdict: String,
    /// The principal finding bears the name of an effect left out.
    pub first: bool,
    /// It, one of at most three equivalents, or its class holds the name.
    pub class: bool,
    /// All effects left out are among the findings, by name or class.
    pub all_named: bool,
    /// Findings beyond those left out.
    pub surplus: usize,
    /// The finding lies where the effect is.
    pub located: bool,
    /// Intervals that have a truth.
    pub covered: Vec<Covered>,
    /// Share of the contribution's variance that the correction removes; none when nothing can be predicted.
    pub removed: Option<f64>,
    /// The figures of `fit` are finite and agree with the verdict.
    pub sane: bool,
    /// Gain of held-out log-likelihood.
    pub held_out_gain: f64,
    /// Expected gain of log-likelihood by naming the weakest effect left out.
    pub strength: Option<f64>,
}

fn texts(value: &Value) -> Vec<&str> {
    value.as_array().map(|a| a.iter().filter_map(Value::as_str).collect()).unwrap_or_default()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// The names a finding goes by: its kind, then at most three equivalents.
fn names(entry: &Value) -> Vec<&str> {
    let mut names: Vec<&str> = entry["kind"].as_str().into_iter().collect();
    names.extend(texts(&entry["equivalents"]).into_iter().take(3));
    names
}

fn acceptable(truth: &Value) -> Vec<&str> {
    let mut names = texts(&truth["class"]);
    names.extend(truth["kind"].as_str());
    if truth["catalogued"] == false {
        names.push("unknown");
    }
    names
}

fn named(entry: &Value, truth: &Value) -> bool {
    let good = acceptable(truth);
    names(entry).iter().any(|n| good.contains(n))
}

fn exactly(entry: &Value, truth: &Value) -> bool {
    let kind = entry["kind"].as_str();
    kind == truth["kind"].as_str() || (truth["catalogued"] == false && kind == Some("unknown"))
}

fn interval(w: &Value) -> Option<(&str, f64, f64)> {
    Some((w["domain"].as_str()?, w["from"].as_f64()?, w["to"].as_f64()?))
}

/// Whether a finding lies where the effect is; `resolution_s` is the sampling interval.
pub fn located(entry: &Value, truth: &Value, resolution_s: f64) -> bool {
    let own = &entry["where"];
    let reported: Vec<&Value> = if own.is_array() { list(own).iter().take(3).collect() } else { vec![own] };
    let sound = |(w, t): (&Value, &Value)| {
        let (Some((domain, from, to)), Some((true_domain, low, high))) = (interval(w), interval(t)) else {
            return false;
        };
        if domain != true_domain || from > to || from > high || to < low {
            return false;
        }
        match truth["parameters"]["frequency_hz"].as_f64() {
            Some(f) if domain == "frequency" => {
                // A bracket of the frequency, no wider than ±5 % or four times the band itself.
                from <= high && to >= low && to - from <= (0.1 * f).max(4.0 * (high - low))
            }
            _ if t["local"] == true => to - from <= 4.0 * (high - low) + resolution_s,
            _ => true,
        }
    };
    reported.iter().any(|w| list(&truth["where"]).iter().any(|t| sound((w, t))))
}

fn intervals(entry: &Value, truth: &Value) -> Vec<Covered> {
    let Some(parameters) = entry["parameters"].as_object() else {
        return Vec::new();
    };
    parameters
        .iter()
        .filter_map(|(name, stated)| {
            let truth = truth["parameters"][name].as_f64()?;
            let (low, high) = (stated["ci95"][0].as_f64()?, stated["ci95"][1].as_f64()?);
            Some(Covered { name: name.clone(), inside: low <= truth && truth <= high, width: high - low })
        })
        .collect()
}

/// `y` at `t` on the line through points of increasing time.
pub fn between(times: &[f64], values: &[f64], t: f64) -> f64 {
    let after = times.partition_point(|&x| x <= t);
    if after == 0 {
        return values[0];
    }
    if after == times.len() {
        return values[after - 1];
    }
    let w = (t - times[after - 1]) / (times[after] - times[after - 1]);
    values[after - 1] + w * (values[after] - values[after - 1])
}

fn variance(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len() as f64
}

/// Share of the variance of `truth` that `correction` takes away; both are (times, values).
pub fn removed(truth: &(Vec<f64>, Vec<f64>), correction: Option<&(Vec<f64>, Vec<f64>)>) -> f64 {
    let Some((times, values)) = correction.filter(|(t, _)| !t.is_empty()) else {
        return 0.0;
    };
    let rest: Vec<f64> = truth.0.iter().zip(&truth.1).map(|(&t, y)| y - between(times, values, t)).collect();
    1.0 - variance(&rest) / variance(&truth.1)
}

fn sane(report: &Value) -> (bool, f64) {
    let figure = |which: &str, name: &str| report["fit"][which][name].as_f64().filter(|v| v.is_finite());
    let all = ["log_likelihood", "heldout_log_likelihood", "heldout_rms_deg_h"]
        .map(|name| figure("baseline", name).zip(figure("augmented", name)));
    let [Some(whole), Some(held), Some(rms)] = all else {
        return (false, f64::NAN);
    };
    let gain = whole.1 - whole.0;
    let consistent = report["verdict"] == "consistent";
    let empty = list(&report["effects"]).is_empty();
    let agree =
        if consistent { empty && gain == 0.0 && held.0 == held.1 && rms.0 == rms.1 } else { gain > -1e-6 };
    (agree && rms.0 > 0.0 && rms.1 > 0.0 && (consistent || !empty), held.1 - held.0)
}

/// Scores a report against `truth.json`; correction and contribution as (times, values).
pub fn score(
    truth: &Value,
    report: &Value,
    correction: Option<&(Vec<f64>, Vec<f64>)>,
    contribution: Option<&(Vec<f64>, Vec<f64>)>,
) -> Score {
    let effects = list(&truth["effects"]);
    let found = list(&report["effects"]);
    let verdict = report["verdict"].as_str().unwrap_or("none").to_string();
    let resolution_s = truth["duration_s"].as_f64().unwrap_or(0.0) / truth["rows"].as_f64().unwrap_or(1.0);
    let label: Vec<&str> = effects.iter().filter_map(|e| e["kind"].as_str()).collect();
    let (sane, held_out_gain) = sane(report);
    let mut s = Score {
        kind: if label.len() == 1 { label[0].to_string() } else { "pair".to_string() },
        null: effects.is_empty(),
        detected: verdict == "mismatch" || verdict == "unknown-mismatch",
        verdict,
        sane,
        held_out_gain,
        strength: effects.iter().filter_map(|e| e["strength"].as_f64()).reduce(f64::min),
        ..Score::default()
    };
    if s.null {
        s.kind = "null".to_string();
        s.surplus = found.len();
        return s;
    }
    if let Some(entry) = found.first() {
        s.first = effects.iter().any(|t| exactly(entry, t));
        s.class = effects.iter().any(|t| named(entry, t));
    }
    // Of an effect of no catalogue the verdict decides: it is unknown wherever an entry is.
    if effects.iter().any(|t| t["catalogued"] == false) && s.verdict == "unknown-mismatch" {
        s.class = true;
    }
    let partner =
        |t: &Value| found.iter().find(|e| exactly(e, t)).or_else(|| found.iter().find(|e| named(e, t)));
    s.all_named = effects.iter().all(|t| partner(t).is_some());
    s.surplus = found.iter().filter(|e| !effects.iter().any(|t| named(e, t))).count();
    // Without the right name the principal finding may still be in the right place.
    s.located = effects.iter().all(|t| {
        let principal = partner(t).or(found.first());
        let unknown = found.iter().filter(|e| t["catalogued"] == false && e["kind"] == "unknown");
        principal.into_iter().chain(unknown).any(|e| located(e, t, resolution_s))
    });
    for t in effects {
        if let Some(entry) = found.iter().find(|e| exactly(e, t)) {
            s.covered.extend(intervals(entry, t));
        }
    }
    s.removed = contribution.map(|truth| removed(truth, correction));
    s
}
