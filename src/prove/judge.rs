//! Whether each rule of a proof holds, and what was found for each reference.

use crate::config::proof::{Must, ProofFile, Reference, Rule, Shown};
use crate::effect::{Domain, find};
use crate::i18n::{Arg, EffectText, Note, effect_key, note};
use crate::record::explanation::{Explanation, Finding};
use crate::record::{CourseRecord, FoundValue, KnownRecord, RuleRecord};
use crate::units::Unit;

/// What the engine said.
#[derive(Clone, Copy)]
pub(super) struct Answers<'a> {
    /// While something was concealed.
    pub concealed: &'a Explanation,
    /// With the columns shown.
    pub unveiled: Option<&'a Explanation>,
    /// The inferred course against what was concealed.
    pub courses: &'a [CourseRecord],
}

impl<'a> Answers<'a> {
    fn of(&self, when: Shown) -> &'a Explanation {
        match (when, self.unveiled) {
            (Shown::Unveiled, Some(explanation)) => explanation,
            _ => self.concealed,
        }
    }
}

/// Every rule of a proof, judged.
pub(super) fn rules(proof: &ProofFile, answers: &Answers<'_>) -> Vec<RuleRecord> {
    let one = |rule: &Rule| {
        let (must, found, holds) = judged(rule, &proof.references, answers);
        RuleRecord { when: rule.when.id().to_owned(), must: must.into(), found: found.into(), holds }
    };
    proof.rules.iter().map(one).collect()
}

/// The rule, the finding, and whether the rule holds.
fn judged(rule: &Rule, references: &[Reference], answers: &Answers<'_>) -> (Note, Note, bool) {
    let said = answers.of(rule.when);
    let must = |key: &'static str| Note::new(key);
    match &rule.must {
        Must::Verdict(ids) => {
            let words = ids.iter().map(|id| verdict(id)).collect();
            let found = note!("prove.found.verdict", verdict = verdict(said.verdict.id()));
            let must = must("prove.must.verdict").with("verdicts", either(words));
            (must, found, ids.contains(&said.verdict.id()))
        }
        Must::Name(kinds) => {
            let must = must("prove.must.name").with("kinds", either(titles(kinds)));
            (must, named(said), said.effects.iter().any(|f| is_one_of(f, kinds, true)))
        }
        Must::NotName(kinds) => {
            let must = must("prove.must.not_name").with("kinds", either(titles(kinds)));
            (must, named(said), !said.effects.iter().any(|f| is_one_of(f, kinds, false)))
        }
        Must::Follow(columns) => {
            let must = must("prove.must.follow").with("columns", columns.join(", "));
            (must, followed(said), said.effects.iter().any(|f| follows(f, columns)))
        }
        Must::NotFollow(columns) => {
            let must = must("prove.must.not_follow").with("columns", columns.join(", "));
            (must, followed(said), !said.effects.iter().any(|f| follows(f, columns)))
        }
        Must::Parameter { kinds, parameter, reference } => {
            within(said, kinds, parameter, references.get(*reference))
        }
        Must::Locate { domain, low, high } => located(said, *domain, [*low, *high]),
        Must::Course { columns, at_least } => alike(answers.courses, columns, *at_least),
        Must::Improve(at_least) => {
            let must = must("prove.must.improve").with("least", Arg::Stated(100.0 * at_least));
            let share = improvement(said);
            let found = note!("prove.found.share", share = Arg::rounded(100.0 * share, 3));
            (must, found, share >= *at_least)
        }
        Must::Recover(at_least) => {
            let must = must("prove.must.recover").with("least", Arg::Stated(100.0 * at_least));
            match answers.courses.iter().find_map(|c| c.recovered_share) {
                Some(share) => {
                    let found = note!("prove.found.share", share = Arg::rounded(100.0 * share, 3));
                    (must, found, share >= *at_least)
                }
                None => (must, "prove.found.no_course".into(), false),
            }
        }
    }
}

/// Whether a parameter lies in the interval of a reference.
fn within(
    said: &Explanation,
    kinds: &[String],
    parameter: &str,
    reference: Option<&Reference>,
) -> (Note, Note, bool) {
    let Some(([low, high], unit)) = reference.and_then(|r| r.interval.as_ref()) else {
        return ("prove.must.nothing".into(), "prove.found.nothing".into(), false);
    };
    let must = note!(
        "prove.must.parameter",
        parameter,
        kinds = either(titles(kinds)),
        low = Arg::Stated(*low),
        high = Arg::Stated(*high),
        unit = unit.text()
    );
    match value(said, kinds, parameter, unit) {
        Some(found) => (must, of_value(&found, unit), (*low..=*high).contains(&found.value)),
        None => (must, named(said), false),
    }
}

/// Whether an effect is located within an interval of a domain.
fn located(said: &Explanation, domain: Domain, [low, high]: [f64; 2]) -> (Note, Note, bool) {
    let must = note!(
        "prove.must.locate",
        domain = Arg::key("explain.view", domain.id()),
        low = Arg::Stated(low),
        high = Arg::Stated(high),
        unit = domain.unit()
    );
    let places = || said.effects.iter().flat_map(|f| &f.places).filter(|p| p.domain == domain);
    let inside = places().find(|p| p.from >= low && p.to <= high);
    let found = match inside.or_else(|| places().next()) {
        Some(place) => note!(
            "prove.found.place",
            from = Arg::rounded(place.from, 5),
            to = Arg::rounded(place.to, 5),
            unit = domain.unit()
        ),
        None => named(said),
    };
    (must, found, inside.is_some())
}

/// Whether the inferred course correlates with one of some columns.
fn alike(courses: &[CourseRecord], columns: &[String], at_least: f64) -> (Note, Note, bool) {
    let must = note!("prove.must.course", columns = columns.join(", "), least = Arg::Stated(at_least));
    let own = courses.iter().filter(|c| columns.contains(&c.name));
    match own.max_by(|a, b| a.correlation.abs().total_cmp(&b.correlation.abs())) {
        Some(c) => {
            let found = note!("prove.found.course", r = Arg::rounded(c.correlation, 3));
            (must, found.with("name", c.name.as_str()), c.correlation.abs() >= at_least)
        }
        None => (must, "prove.found.no_course".into(), false),
    }
}

/// The share by which the mean square of the held-out residual falls.
fn improvement(said: &Explanation) -> f64 {
    let (before, after) = (said.fit.baseline.heldout_rms_deg_h, said.fit.augmented.heldout_rms_deg_h);
    if before > 0.0 { 1.0 - (after / before).powi(2) } else { 0.0 }
}

/// True for a finding of one of these kinds, or with one of them among its equivalents.
fn is_one_of(finding: &Finding, kinds: &[String], equivalents: bool) -> bool {
    let own = |kind: &String| *kind == finding.kind || kind == finding.effect_id();
    kinds.iter().any(|k| own(k) || (equivalents && finding.equivalents.contains(k)))
}

/// The columns that a finding follows.
fn columns_of(finding: &Finding) -> Vec<String> {
    let mut columns: Vec<String> = finding.column.iter().chain(&finding.column2).cloned().collect();
    if columns.is_empty()
        && let Some(effect) = find(finding.effect_id())
    {
        columns.extend(effect.needs().iter().map(|c| c.name().to_owned()));
    }
    columns
}

/// True for a finding that follows one of these columns, in its formula too.
fn follows(finding: &Finding, columns: &[String]) -> bool {
    columns_of(finding).iter().any(|own| columns.contains(own))
        || finding.formula.as_ref().is_some_and(|f| columns.iter().any(|c| names_in(f).any(|n| n == c)))
}

/// The names in a formula.
fn names_in(formula: &str) -> impl Iterator<Item = &str> {
    formula.split(|c: char| !c.is_alphanumeric() && !matches!(c, '_' | '.' | '[' | ']'))
}

/// The value of a parameter in a unit.
fn value(said: &Explanation, kinds: &[String], parameter: &str, unit: &Unit) -> Option<FoundValue> {
    let finding = said.effects.iter().find(|f| is_one_of(f, kinds, false))?;
    let found = finding.parameters.get(parameter)?;
    // A parameter that is a pure number or a count has no unit to convert.
    let factor = Unit::parse(&found.unit).ok().and_then(|own| own.factor_to(unit).ok())?;
    Some(FoundValue {
        when: String::new(),
        kind: finding.effect_id().to_owned(),
        value: found.value * factor,
        ci95: found.ci95.map(|v| v * factor),
    })
}

fn of_value(found: &FoundValue, unit: &Unit) -> Note {
    note!(
        "prove.found.value",
        value = Arg::rounded(found.value, 4),
        low = Arg::rounded(found.ci95[0], 4),
        high = Arg::rounded(found.ci95[1], 4),
        unit = unit.text(),
        kind = title(&found.kind)
    )
}

/// Facts known from elsewhere, with the finding for each.
pub(super) fn references(proof: &ProofFile, answers: &Answers<'_>) -> Vec<KnownRecord> {
    let one = |(place, known): (usize, &Reference)| {
        let rule = proof.rules.iter().find_map(|rule| match &rule.must {
            Must::Parameter { kinds, parameter, reference } if *reference == place => {
                Some((rule.when, kinds, parameter))
            }
            _ => None,
        });
        let found = rule.zip(known.interval.as_ref()).and_then(|((when, kinds, parameter), (_, unit))| {
            let found = value(answers.of(when), kinds, parameter, unit)?;
            Some(FoundValue { when: when.id().to_owned(), ..found })
        });
        KnownRecord {
            id: known.id.clone(),
            what: known.what.clone(),
            interval: known.interval.as_ref().map(|i| i.0),
            unit: known.interval.as_ref().map(|i| i.1.text().to_owned()),
            source: known.source.clone(),
            found,
        }
    };
    proof.references.iter().enumerate().map(one).collect()
}

/// The named effects, or the verdict where nothing was named.
fn named(said: &Explanation) -> Note {
    if said.effects.is_empty() {
        return note!("prove.found.verdict", verdict = verdict(said.verdict.id()));
    }
    let one = |f: &Finding| {
        let equivalents: Vec<Arg> = f.equivalents.iter().map(|k| title(k)).collect();
        let name = title(f.effect_id());
        match equivalents.is_empty() {
            true => name,
            false => {
                note!("prove.found.with_equivalents", name, others = Arg::Several(equivalents, ", ".into()))
                    .into()
            }
        }
    };
    let effects = said.effects.iter().map(one).collect();
    note!("prove.found.named", effects = Arg::Several(effects, "; ".into()))
}

/// Which columns the effects follow.
fn followed(said: &Explanation) -> Note {
    let known = said.columns.iter().map(|c| c.name.clone());
    let columns: Vec<String> =
        known.filter(|c| said.effects.iter().any(|f| follows(f, std::slice::from_ref(c)))).collect();
    match columns.is_empty() {
        true => named(said),
        false => note!("prove.found.columns", columns = columns.join(", ")),
    }
}

fn titles(kinds: &[String]) -> Vec<Arg> {
    kinds.iter().map(|k| title(k)).collect()
}

fn title(kind: &str) -> Arg {
    if kind == "unknown" {
        Arg::Key("prove.unnamed".into())
    } else {
        Arg::Key(effect_key(kind, EffectText::Title))
    }
}

/// A verdict in words.
fn verdict(id: &str) -> Arg {
    let key = match id {
        "consistent" => "explain.verdict.consistent",
        "mismatch" => "explain.verdict.mismatch",
        _ => "explain.verdict.unknown",
    };
    Arg::Key(key.to_owned())
}

fn either(words: Vec<Arg>) -> Arg {
    Arg::Several(words, " / ".into())
}
