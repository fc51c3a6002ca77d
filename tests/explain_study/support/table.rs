//! Tables of scores, a row a kind.

use super::score::Score;
use std::collections::BTreeMap;

/// One case of the study.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub name: String,
    pub score: Score,
    /// Widths of stated intervals over those of the fit told the truth.
    pub width_ratios: Vec<f64>,
    /// Removed variance over that of the fit told the truth.
    pub removed_ratio: Option<f64>,
    /// Closed loop: the recording, a fresh one, one of another case, and one without the effect against the augmented claim.
    pub closes: Option<[bool; 4]>,
    /// Exit code that the program gave.
    pub exit: Option<i32>,
}

/// Counts over rows.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    pub cases: usize,
    pub detected: usize,
    pub first: usize,
    pub class: usize,
    pub all_named: usize,
    pub surplus: usize,
    pub located: usize,
    pub inside: usize,
    pub intervals: usize,
    pub unknown: usize,
    pub sane: usize,
    pub held_out: usize,
    pub loops: [usize; 4],
    pub looped: usize,
    pub width_ratio: Option<f64>,
    pub removed: Option<f64>,
    pub removed_ratio: Option<f64>,
}

/// The middle value.
pub fn median(mut x: Vec<f64>) -> Option<f64> {
    x.retain(|v| v.is_finite());
    x.sort_by(f64::total_cmp);
    let n = x.len();
    (n > 0).then(|| 0.5 * (x[(n - 1) / 2] + x[n / 2]))
}

impl Tally {
    /// Counts over rows.
    pub fn of<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Tally {
        let count = |f: &dyn Fn(&Row) -> bool| rows.clone().filter(|r| f(r)).count();
        let covered = || rows.clone().flat_map(|r| &r.score.covered);
        Tally {
            cases: rows.clone().count(),
            detected: count(&|r| r.score.detected),
            first: count(&|r| r.score.first),
            class: count(&|r| r.score.class),
            all_named: count(&|r| r.score.all_named),
            surplus: count(&|r| r.score.surplus > 0),
            located: count(&|r| r.score.located),
            inside: covered().filter(|c| c.inside).count(),
            intervals: covered().count(),
            unknown: count(&|r| r.score.verdict == "unknown-mismatch"),
            sane: count(&|r| r.score.sane),
            held_out: count(&|r| r.score.held_out_gain > 0.0),
            loops: std::array::from_fn(|i| count(&|r| r.closes.is_some_and(|c| c[i]))),
            looped: count(&|r| r.closes.is_some()),
            width_ratio: median(rows.clone().flat_map(|r| r.width_ratios.clone()).collect()),
            removed: median(rows.clone().filter_map(|r| r.score.removed).collect()),
            removed_ratio: median(rows.clone().filter_map(|r| r.removed_ratio).collect()),
        }
    }

    fn line(&self, name: &str) -> String {
        let n = self.cases.max(1) as f64;
        let share = |count: usize| format!("{:>7.3}", count as f64 / n);
        let value = |v: Option<f64>| v.map_or(format!("{:>7}", "-"), |v| format!("{v:>7.3}"));
        let of = |a: usize, b: usize| value((b > 0).then(|| a as f64 / b as f64));
        let shares =
            [self.detected, self.first, self.class, self.all_named, self.surplus, self.located].map(share);
        format!(
            "{name:<28}{:>6}{}{}{:>6}{}{}{}{}{}{}{}{}{}{}",
            self.cases,
            shares.concat(),
            of(self.inside, self.intervals),
            self.intervals,
            value(self.width_ratio),
            value(self.removed),
            value(self.removed_ratio),
            share(self.unknown),
            share(self.sane),
            share(self.held_out),
            of(self.loops[0], self.looped),
            of(self.loops[1], self.looped),
            of(self.loops[2], self.looped),
            of(self.loops[3], self.looped),
        )
    }
}

const HEAD: &str = "detect  first  class    all surplus locate  cover   ivs  width remove rm/told unknown  sane \
                    heldout   loop  fresh  other without";

/// The table over kinds, with a last row over all.
pub fn by_kind(rows: &[Row]) -> String {
    let mut kinds: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    rows.iter().for_each(|r| kinds.entry(&r.score.kind).or_default().push(r));
    let mut text = format!("{:<28}{:>6} {HEAD}\n", "kind", "n");
    for (kind, of) in &kinds {
        text += &Tally::of(of.iter().copied()).line(kind);
        text.push('\n');
    }
    text + &Tally::of(rows.iter().filter(|r| !r.score.null)).line("all effects") + "\n"
}

/// Lower ends of the bands of strength in which curves are drawn.
pub const STRENGTHS: [f64; 7] = [0.0, 7.0, 14.0, 28.0, 56.0, 110.0, 220.0];

/// The table over strengths.
pub fn by_strength(rows: &[Row]) -> String {
    let mut text = format!("{:<28}{:>6} {HEAD}\n", "strength from", "n");
    for (i, low) in STRENGTHS.iter().enumerate() {
        let high = STRENGTHS.get(i + 1).copied().unwrap_or(f64::INFINITY);
        let inside = |r: &&Row| r.score.strength.is_some_and(|s| (*low..high).contains(&s));
        let tally = Tally::of(rows.iter().filter(inside));
        if tally.cases > 0 {
            text += &tally.line(&format!("{low:.0}"));
            text.push('\n');
        }
    }
    text
}

/// Intervals by parameter: kind, parameter, share that holds, number.
pub fn by_parameter(rows: &[Row]) -> String {
    let mut found: BTreeMap<(&str, &str), (usize, usize)> = BTreeMap::new();
    for row in rows {
        for c in &row.score.covered {
            let entry = found.entry((&row.score.kind, &c.name)).or_default();
            entry.0 += usize::from(c.inside);
            entry.1 += 1;
        }
    }
    let line = |((kind, name), (inside, all)): (&(&str, &str), &(usize, usize))| {
        format!("{kind:<28}{name:<40}{:>7.3}{all:>6}\n", *inside as f64 / *all as f64)
    };
    found.iter().map(line).collect()
}
