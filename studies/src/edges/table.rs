//! The tables of cases in `studies/cases/edges/`, one file per family of measurands.
//!
//! | key | meaning |
//! |---|---|
//! | `name`, `measurands` | the family, and every measurand of it |
//! | `records` | recordings of a case; a case may state its own |
//! | `[lists]` | lists of measurands, which cases name |
//! | `[limits]` | key with which a limit on a measurand is written: `max`, `min`, `max_abs` |
//! | `[[case]]` | `name`; `edges` that it stands for; `measurands` that it tells of |
//! | `judged` | measurands whose truths are judged, where these are more than `measurands` |
//! | `asked` | measurands of the procedure, where these are more than are judged and the bench does not fix them |
//! | `at_limit` | measurands with a limit exactly at their truth, unless that is nothing |
//! | `limits` | limits elsewhere, by measurand, or measurand and channel |
//! | `oracles` | measurands whose width is held against that of an oracle; without it all for which the bench has one |
//! | `bench` | the unit and its test, as the generator of the family reads it |
//! | `[[exempt]]` | `edges` that do not apply to `measurands`, with the `reason` |

use super::case::{Case, Draw, Edge, Exemption, Family, LimitKey, Simulated, Truth};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;

/// Less than this is nothing: no unit can meet a limit there.
const NOTHING: f64 = 1e-9;

/// The generator of a family, read from the table.
pub trait Bench: DeserializeOwned + Send + Sync + 'static {
    /// The unit and its recording of a seed, tested for `ids` or for all it has, with all that is true of it.
    fn simulated(&self, ids: &[String], seed: u64) -> Simulated;
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table<B> {
    name: String,
    measurands: Vec<String>,
    records: usize,
    #[serde(default)]
    lists: BTreeMap<String, Vec<String>>,
    #[serde(default)]
    limits: BTreeMap<String, LimitKey>,
    case: Vec<Entry<B>>,
    #[serde(default)]
    exempt: Vec<Exempt>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry<B> {
    name: String,
    edges: Vec<Edge>,
    measurands: Ids,
    judged: Option<Ids>,
    asked: Option<Ids>,
    records: Option<usize>,
    #[serde(default)]
    at_limit: Ids,
    #[serde(default)]
    limits: BTreeMap<String, f64>,
    oracles: Option<Ids>,
    bench: B,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Exempt {
    edges: Vec<Edge>,
    measurands: Ids,
    reason: String,
}

/// Measurands, by the name of a list or one by one.
#[derive(Deserialize)]
#[serde(untagged)]
enum Ids {
    List(String),
    Each(Vec<String>),
}

impl Default for Ids {
    fn default() -> Ids {
        Ids::Each(vec![])
    }
}

impl Ids {
    fn of(self, lists: &BTreeMap<String, Vec<String>>) -> Result<Vec<String>, String> {
        match self {
            Ids::Each(ids) => Ok(ids),
            Ids::List(name) => lists.get(&name).cloned().ok_or_else(|| format!("there is no list `{name}`")),
        }
    }
}

impl Family {
    /// Reads a table.
    ///
    /// # Errors
    /// What the table has wrong, as text.
    pub fn read<B: Bench>(text: &str) -> Result<Family, String> {
        let table: Table<B> = toml::from_str(text).map_err(|e| e.to_string())?;
        let mut lists = table.lists;
        lists.insert("all".to_owned(), table.measurands.clone());
        let exemption =
            |e: Exempt| Ok(Exemption { edges: e.edges, ids: e.measurands.of(&lists)?, reason: e.reason });
        let exempt = table.exempt.into_iter().map(exemption).collect::<Result<_, String>>()?;
        let case = |entry: Entry<B>| {
            let ids = entry.measurands.of(&lists)?;
            let judged = Judged {
                ids: entry.judged.map_or_else(|| Ok(ids.clone()), |j| j.of(&lists))?,
                at_limit: entry.at_limit.of(&lists)?,
                limits: entry.limits,
                keys: table.limits.clone(),
                oracles: entry.oracles.map(|o| o.of(&lists)).transpose()?,
            };
            let asked = entry.asked.map_or_else(|| Ok(judged.ids.clone()), |a| a.of(&lists))?;
            let bench = entry.bench;
            let draw: Draw = Box::new(move |seed| judged.of(bench.simulated(&asked, seed)));
            let records = entry.records.unwrap_or(table.records);
            Ok(Case { name: entry.name, edges: entry.edges, ids, records, draw, may_be_refused: false })
        };
        let cases = table.case.into_iter().map(case).collect::<Result<_, String>>()?;
        Ok(Family { name: table.name, ids: table.measurands, cases, exempt })
    }
}

/// What is judged of a case.
struct Judged {
    ids: Vec<String>,
    at_limit: Vec<String>,
    limits: BTreeMap<String, f64>,
    keys: BTreeMap<String, LimitKey>,
    oracles: Option<Vec<String>>,
}

impl Judged {
    fn of(&self, mut simulated: Simulated) -> Simulated {
        simulated.truths.retain(|t| self.ids.contains(&t.id));
        let limited = |truth: Truth| {
            let key = self.keys.get(&truth.id).copied().unwrap_or(LimitKey::Max);
            let own = if key == LimitKey::MaxAbs { truth.value.abs() } else { truth.value };
            let at_truth = self.at_limit.contains(&truth.id) && own.abs() >= NOTHING;
            let elsewhere = self.limits.get(&truth.id).or_else(|| self.limits.get(&truth.name()));
            match elsewhere.copied().or(at_truth.then_some(own)) {
                Some(value) => truth.limited(key, value),
                None => truth,
            }
        };
        let told = |mut truth: Truth| {
            if self.oracles.as_ref().is_some_and(|ids| !ids.contains(&truth.id)) {
                truth.oracle = None;
            }
            truth
        };
        simulated.truths = simulated.truths.into_iter().map(limited).map(told).collect();
        simulated
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit with two truths of this size, and one of nothing.
    #[derive(Deserialize)]
    struct Fixed(f64);

    impl Bench for Fixed {
        fn simulated(&self, ids: &[String], _: u64) -> Simulated {
            let truth = |id: &str| Truth::new(id, self.0).oracle(0.1);
            let truths = vec![truth("a"), truth("b").on("x@1"), Truth::new("c", 0.0)];
            Simulated { csv: String::new(), procedure: ids.join(" "), truths }
        }
    }

    const HEAD: &str = "name = \"f\"\nmeasurands = [\"a\", \"b\", \"c\"]\nrecords = 7\nlists.two = [\"a\", \"b\"]\n\
                        limits.a = \"max_abs\"\n[[case]]\nname = \"n\"\nedges = [\"zero\"]\nmeasurands = \"two\"\nbench = -3.0\n";

    #[test]
    fn a_case_is_judged_as_its_table_says() {
        let case = "judged = \"all\"\nat_limit = \"all\"\nlimits.\"b x@1\" = 2.0\noracles = [\"b\"]\n";
        let family = Family::read::<Fixed>(&format!("{HEAD}{case}")).unwrap();
        let case = &family.cases[0];
        let Simulated { procedure, truths, .. } = (case.draw)(1);
        assert_eq!((case.records, case.ids.len(), procedure.as_str()), (7, 2, "a b c"));
        let limit = |i: usize| truths[i].limit.as_ref().map(|l| (l.key, l.value));
        assert_eq!(limit(0), Some((LimitKey::MaxAbs, 3.0)));
        assert_eq!(limit(1), Some((LimitKey::Max, 2.0)));
        // There is no limit at a truth of nothing.
        assert_eq!(limit(2), None);
        assert_eq!((truths[0].oracle, truths[1].oracle), (None, Some(0.1)));
    }

    #[test]
    fn a_list_that_is_not_there_is_named() {
        let said = Family::read::<Fixed>(&format!("{HEAD}at_limit = \"three\"\n")).err();
        assert_eq!(said.as_deref(), Some("there is no list `three`"));
    }
}
