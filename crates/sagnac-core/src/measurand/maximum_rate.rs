//! Largest rate that the output follows, saturation, recovery after an overload.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use crate::estimate::{Estimate, LowerLimit, Spread, UpperLimit};
use crate::message::{Arg, note};
use crate::rate_table::overload::{CLAIM_CONFIDENCE, Overload, Recovery, Side};

/// Largest rate, of both signs, up to which the output follows within the stated error.
pub static MAXIMUM_RATE: Measurand = Measurand::of_steps(
    "maximum_rate",
    "deg/s",
    "largest rate that the output follows in both directions",
    Stimulus::Overload,
    |m, e| of_overload(m, e, |found| maximum_rate(m, e, found)),
)
.also_called(&["range", "rate_range", "max_rate", "measurement_range"])
.formulas(
    &["|y − K·Ω − y₀| ≤ e·K·|Ω|", "Ω_j ≤ Ω_max ≤ Ω_k", "K, y₀ : |Ω| ≤ 0.5·Ω_FS"],
    "IEEE Std 952-2020, 12.10",
);

/// Output at which it saturates, in each direction.
pub static SATURATION_LEVEL: Measurand = Measurand::of_steps(
    "saturation_level",
    "deg/s",
    "output where it no longer rises with the rate, in each direction",
    Stimulus::Overload,
    |m, e| {
        let of = |found: &Overload| {
            let sides = [("positive", found.positive), ("negative", found.negative)];
            sides
                .into_iter()
                .filter_map(|(name, side)| Some(saturation(m, e, name, side.as_ref()?)))
                .collect()
        };
        of_overload(m, e, of)
    },
)
.signed();

/// Longest time after an overload until the output follows again.
pub static OVERLOAD_RECOVERY: Measurand = Measurand::of_steps(
    "overload_recovery",
    "s",
    "time from the return of the rate into the range until the output follows",
    Stimulus::Overload,
    |m, e| of_overload(m, e, |found| vec![recovery(m, e, found)]),
);

const METHOD: &str = "table_overload";
const DEG_H_IN_DEG_S: f64 = 3600.0;

fn of_overload(
    m: &Measurand,
    e: &TableEvidence<'_>,
    rows: impl Fn(&Overload) -> Vec<Estimate>,
) -> Vec<Estimate> {
    match (&e.overload, &e.line) {
        (Some(found), _) => rows(found),
        (None, Some(_)) => {
            vec![m.not_identifiable(&e.channel, None, METHOD).note(note!("overload.few_levels"))]
        }
        (None, None) => vec![],
    }
}

fn maximum_rate(m: &Measurand, e: &TableEvidence<'_>, found: &Overload) -> Vec<Estimate> {
    let none = |limit: Option<UpperLimit>| m.not_identifiable(&e.channel, limit, METHOD);
    let (Some(positive), Some(negative)) = (found.positive, found.negative) else {
        return vec![none(None).note(note!("overload.one_direction"))];
    };
    let least = positive.follows_to.min(negative.follows_to);
    let fails = [positive.fails_from, negative.fails_from].into_iter().flatten().reduce(f64::min);
    let shown = |rate: f64| rate / DEG_H_IN_DEG_S;
    let row = none(fails.map(|rate| UpperLimit { value: shown(rate), coverage: CLAIM_CONFIDENCE }))
        .at_least((least > 0.0).then_some(LowerLimit { value: shown(least), coverage: CLAIM_CONFIDENCE }));
    let error = Arg::figures(100.0 * e.setup.maximum_rate_error, 3);
    let to = Arg::figures(shown(found.line_to), 4);
    let row = row.note(note!("overload.error", error, to));
    let how = match (least > 0.0, fails) {
        (true, None) => note!("overload.of_table", rate = Arg::figures(shown(least), 4)),
        (true, Some(rate)) => {
            note!("overload.between", from = Arg::figures(shown(least), 4), to = Arg::figures(shown(rate), 4))
        }
        (false, _) => note!("overload.none_follows"),
    };
    vec![row.note(how)]
}

fn saturation(m: &Measurand, e: &TableEvidence<'_>, direction: &str, side: &Side) -> Estimate {
    let channel = format!("{}@{direction}", e.channel);
    match side.saturation {
        Some(level) => {
            let spread =
                Spread::StudentT { standard_uncertainty: level.standard / DEG_H_IN_DEG_S, dof: level.dof };
            m.measured(&channel, level.value / DEG_H_IN_DEG_S, spread, METHOD)
        }
        None => m.not_identifiable(&channel, None, METHOD).note(note!(
            "overload.not_saturated",
            output = Arg::figures(side.highest_output / DEG_H_IN_DEG_S, 4)
        )),
    }
}

/// The time is known to a block: the spread is even over one on each side. Where only the commanded rate is known, the time bounds it.
fn recovery(m: &Measurand, e: &TableEvidence<'_>, found: &Overload) -> Estimate {
    let Some(Recovery { time_s, block_s, by_angle }) = found.recovery else {
        return m.not_identifiable(&e.channel, None, METHOD).note(note!("overload.no_return"));
    };
    let told = note!("overload.resolution", block_s = Arg::figures(block_s, 2));
    if time_s <= 0.0 || !by_angle {
        let limit = UpperLimit { value: time_s.max(0.0) + block_s, coverage: CLAIM_CONFIDENCE };
        let row = m.not_identifiable(&e.channel, Some(limit), METHOD).note(told);
        return if by_angle { row } else { row.note(note!("overload.commanded")) };
    }
    m.measured(&e.channel, time_s, Spread::of_resolution(time_s, block_s), METHOD).note(told)
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{diagonal, line, near, notes, on_table, shows, student, withholds};
    use super::*;
    use crate::numeric::reml::Combination;
    use crate::rate_table::Setup;

    /// Rows of a channel whose rates of both signs showed this.
    fn rows(m: &Measurand, positive: Side, negative: Side, recovery: Option<Recovery>) -> Vec<Estimate> {
        let (steps, line) = line(&[-1.0, 0.0, 1.0], &[0.0; 3], &[], diagonal(&[1.0; 3]));
        let setup = Setup::default();
        let mut evidence = on_table(&setup, &steps, Some(line));
        evidence.overload =
            Some(Overload { line_to: 1e6, positive: Some(positive), negative: Some(negative), recovery });
        m.evaluate_steps(&evidence)
    }

    fn side(follows_to: f64, fails_from: Option<f64>) -> Side {
        Side { follows_to, fails_from, saturation: None, highest_output: 360_000.0 }
    }

    #[test]
    fn the_maximum_rate_is_that_of_the_worse_direction() {
        let row =
            rows(&MAXIMUM_RATE, side(720_000.0, None), side(360_000.0, Some(540_000.0)), None).remove(0);
        withholds(&row, Some(150.0), METHOD);
        near(row.lower_limit.unwrap().value, 100.0);
        assert_eq!(notes(&row), ["overload.error", "overload.between"]);
        let row = rows(&MAXIMUM_RATE, side(720_000.0, None), side(360_000.0, None), None).remove(0);
        withholds(&row, None, METHOD);
        assert_eq!(notes(&row)[1], "overload.of_table");
        let row = rows(&MAXIMUM_RATE, side(0.0, Some(360_000.0)), side(360_000.0, None), None).remove(0);
        assert_eq!((row.lower_limit, notes(&row)[1]), (None, "overload.none_follows"));
    }

    #[test]
    fn saturation_is_stated_for_each_direction() {
        let level = Combination { value: 396_000.0, standard: 36.0, dof: 7.0 };
        let found = rows(
            &SATURATION_LEVEL,
            Side { saturation: Some(level), ..side(0.0, None) },
            side(0.0, None),
            None,
        );
        shows(&found[0], 110.0, METHOD);
        assert_eq!((found[0].channel.as_str(), student(&found[0])), ("g@positive", (0.01, 7.0)));
        withholds(&found[1], None, METHOD);
        assert_eq!(
            (found[1].channel.as_str(), notes(&found[1])),
            ("g@negative", vec!["overload.not_saturated"])
        );
    }

    #[test]
    fn a_recovery_is_known_to_a_block() {
        let of = |recovery| rows(&OVERLOAD_RECOVERY, side(0.0, None), side(0.0, None), recovery).remove(0);
        let late = of(Some(Recovery { time_s: 0.4, block_s: 0.1, by_angle: true }));
        shows(&late, 0.4, METHOD);
        let interval = late.interval95().unwrap();
        // Even over 0.2 s; the curve is told at quarters of a score.
        assert!((interval.low - 0.305).abs() < 2e-4 && (interval.high - 0.495).abs() < 2e-4, "{interval:?}");
        let at_once = of(Some(Recovery { time_s: 0.0, block_s: 0.1, by_angle: true }));
        withholds(&at_once, Some(0.1), METHOD);
        // The table may have been late itself.
        let commanded = of(Some(Recovery { time_s: 0.4, block_s: 0.1, by_angle: false }));
        withholds(&commanded, Some(0.5), METHOD);
        assert_eq!(notes(&commanded), ["overload.resolution", "overload.commanded"]);
        assert_eq!(notes(&of(None)), ["overload.no_return"]);
    }
}
