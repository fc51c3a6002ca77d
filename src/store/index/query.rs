//! Questions to the index. Every answer has an order of its own, so that it does not depend on the order in which the rows
//! were written.

use super::Index;
use crate::estimate::{Interval, UpperLimit, Verdict};
use crate::record::{LimitRecord, MeasurandRecord};
use crate::store::entry::{Entry, EntryRecording, EntryTest, EntryUnit, Reason, ReasonKind, indexed};
use crate::store::error::StoreError;
use rusqlite::types::Value;
use rusqlite::{Row, params, params_from_iter};
use std::collections::BTreeMap;

/// Which results are asked for. What is `None` does not matter.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Filter {
    /// Serial number in the form used for comparison.
    pub serial_key: Option<String>,
    /// Model.
    pub model: Option<String>,
    /// Lots.
    pub lots: Vec<String>,
    /// Id of the procedure.
    pub procedure: Option<String>,
    /// Station.
    pub station: Option<String>,
    /// Earliest moment of evaluation, RFC 3339 or the beginning of one.
    pub since: Option<String>,
}

/// Results that count.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counted {
    /// Their addresses.
    pub addresses: Vec<String>,
    /// Results of reference units, and results that others supersede, which do not count.
    pub left_out: usize,
}

/// A result in the store.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// Address of its folder.
    pub address: String,
    /// Its entry in the index.
    pub entry: Entry,
    /// Which test of the unit by the procedure it is, from 1: as many as there are up to it, or as it states where some are missing;
    /// 0 for a unit without a serial number.
    pub number: u64,
    /// The correction that supersedes it; the latest where there are several.
    pub superseded: Option<Correction>,
    /// Addresses of attempts that it names as earlier ones and that the store does not hold.
    pub missing: Vec<String>,
}

/// A correction of a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Correction {
    /// Address of the result that counts in its place.
    pub by: String,
    /// Why.
    pub reason: String,
    /// Who says so.
    pub operator: String,
    /// When, RFC 3339.
    pub stated_at: String,
}

/// A statement in the index: its hash, and its columns as text.
pub(in super::super) type StatementRow = (String, Vec<String>);

/// Columns of a result, in the order of [`result`].
const SELECT_RESULT: &str = "SELECT r.id, r.address, r.serial, r.model, r.lot, r.build_date, r.reference, r.attributes, r.procedure,
    r.revision, r.procedure_sha256, r.limits, r.limits_sha256, r.station, r.operator, r.evaluated_at, r.attempt, r.verdict,
    r.result_sha256,
    CASE WHEN r.serial_key = '' THEN 0 ELSE
    max(r.attempt, (SELECT count(*) FROM result e WHERE e.serial_key = r.serial_key AND e.procedure = r.procedure
     AND (e.placed_at, e.attempt, e.evaluated_at, e.address) <= (r.placed_at, r.attempt, r.evaluated_at, r.address))) END
    FROM result r";

/// The order of results: by time, but after those that they follow; then as they state themselves, then by address.
const BY_TIME: &str = " ORDER BY r.placed_at, r.attempt, r.evaluated_at, r.address";

impl Index {
    /// The results that a filter lets through, the earliest first.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn attempts(&self, filter: &Filter) -> Result<Vec<Attempt>, StoreError> {
        let (condition, values) = filter.condition();
        self.select(&format!("{SELECT_RESULT}{condition}{BY_TIME}"), values).map_err(|e| self.refused(&e))
    }

    /// Addresses of the results that a filter lets through, the earliest first: of products, as far as no other result counts in
    /// their place.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn counted(&self, filter: &Filter) -> Result<Counted, StoreError> {
        let (condition, values) = filter.condition();
        let query = format!(
            "SELECT r.address, r.reference OR EXISTS (SELECT 1 FROM correction c WHERE c.superseded = r.address)
             FROM result r{condition}{BY_TIME}"
        );
        let read = || -> rusqlite::Result<Vec<(String, bool)>> {
            let mut query = self.db.prepare_cached(&query)?;
            query.query_map(params_from_iter(values), |row| Ok((row.get(0)?, row.get(1)?)))?.collect()
        };
        let all = read().map_err(|e| self.refused(&e))?;
        let left_out = all.iter().filter(|(_, out)| *out).count();
        let addresses = all.into_iter().filter(|(_, out)| !out).map(|(address, _)| address).collect();
        Ok(Counted { addresses, left_out })
    }

    /// The results whose addresses begin with a text, the earliest first; at most two.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn by_address(&self, beginning: &str) -> Result<Vec<Attempt>, StoreError> {
        let query = format!("{SELECT_RESULT} WHERE substr(r.address, 1, length(?1)) = ?1{BY_TIME} LIMIT 2");
        self.select(&query, vec![beginning.to_owned().into()]).map_err(|e| self.refused(&e))
    }

    /// The result at an address.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn at(&self, address: &str) -> Result<Option<Attempt>, StoreError> {
        let found =
            self.select(&format!("{SELECT_RESULT} WHERE r.address = ?1"), vec![address.to_owned().into()]);
        Ok(found.map_err(|e| self.refused(&e))?.pop())
    }

    /// Every correction: the result that is superseded, and the one that counts in its place.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn corrections(&self) -> Result<Vec<(String, String)>, StoreError> {
        let read = || -> rusqlite::Result<Vec<(String, String)>> {
            let mut query =
                self.db.prepare_cached("SELECT superseded, by FROM correction ORDER BY statement")?;
            query.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?.collect()
        };
        read().map_err(|e| self.refused(&e))
    }

    /// Every statement, by its hash.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn statements(&self) -> Result<Vec<StatementRow>, StoreError> {
        let read = |query: &str, columns: usize| -> rusqlite::Result<Vec<StatementRow>> {
            let mut query = self.db.prepare_cached(query)?;
            let row = |row: &Row<'_>| {
                Ok((row.get(0)?, (1..columns).map(|i| row.get(i)).collect::<Result<_, _>>()?))
            };
            query.query_map([], row)?.collect()
        };
        let corrections =
            read("SELECT statement, superseded, by, reason, operator, stated_at FROM correction", 6);
        let places = read("SELECT statement, sha256, path, stated_at FROM place", 4);
        let mut all = corrections.map_err(|e| self.refused(&e))?;
        all.extend(places.map_err(|e| self.refused(&e))?);
        all.sort();
        Ok(all)
    }

    /// Serial number and place in the order of time of each result, by address.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn keys(&self) -> Result<BTreeMap<String, String>, StoreError> {
        let read = || -> rusqlite::Result<BTreeMap<String, String>> {
            let mut query = self.db.prepare("SELECT address, serial_key || ' ' || placed_at FROM result")?;
            query.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?.collect()
        };
        read().map_err(|e| self.refused(&e))
    }

    /// The definitions of the tables, as the database holds them.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn definitions(&self) -> Result<Vec<String>, StoreError> {
        self.texts("SELECT type || ' ' || name || ' ' || coalesce(sql, '') FROM sqlite_master ORDER BY 1")
            .map_err(|e| self.refused(&e))
    }

    /// Where a recording is: where it was evaluated, then where it was found later, the earliest first.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn places(&self, sha256: &str) -> Result<Vec<String>, StoreError> {
        let of = |query: &str| -> rusqlite::Result<Vec<String>> {
            self.db.prepare_cached(query)?.query_map([sha256], |row| row.get(0))?.collect()
        };
        let run = of("SELECT DISTINCT path FROM recording WHERE sha256 = ?1 ORDER BY path");
        let later = of("SELECT path FROM place WHERE sha256 = ?1 ORDER BY stated_at, statement");
        let both = run.and_then(|run| later.map(|later| run.into_iter().chain(later).collect()));
        both.map_err(|e| self.refused(&e))
    }

    /// Every recording of the results: SHA-256 with size, each once.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn recordings(&self) -> Result<Vec<(String, u64)>, StoreError> {
        let read = || -> rusqlite::Result<Vec<(String, u64)>> {
            let mut query = self.db.prepare(
                "SELECT sha256, max(bytes) FROM recording WHERE sha256 <> '' GROUP BY sha256 ORDER BY sha256",
            )?;
            let rows = query.query_map([], |row| Ok((row.get(0)?, row.get::<_, i64>(1)? as u64)))?;
            rows.collect()
        };
        read().map_err(|e| self.refused(&e))
    }

    fn texts(&self, query: &str) -> rusqlite::Result<Vec<String>> {
        self.db.prepare_cached(query)?.query_map([], |row| row.get(0))?.collect()
    }

    fn select(&self, query: &str, values: Vec<Value>) -> rusqlite::Result<Vec<Attempt>> {
        let mut statement = self.db.prepare_cached(query)?;
        let found: Vec<(i64, Attempt)> =
            statement.query_map(params_from_iter(values), result)?.collect::<rusqlite::Result<_>>()?;
        found.into_iter().map(|(id, attempt)| self.completed(id, attempt)).collect()
    }

    /// A result with its rows.
    fn completed(&self, id: i64, mut attempt: Attempt) -> rusqlite::Result<Attempt> {
        let entry = &mut attempt.entry;
        entry.measurands = self
            .db
            .prepare_cached(
                "SELECT measurand, channel, phase, unit, value, low, high, coverage, upper_limit, upper_coverage,
                 limit_min, limit_max, verdict FROM measurand WHERE result = ?1 ORDER BY position",
            )?
            .query_map([id], measurand)?
            .collect::<rusqlite::Result<_>>()?;
        entry.reasons = self
            .db
            .prepare_cached("SELECT kind, name FROM reason WHERE result = ?1 ORDER BY position")?
            .query_map([id], |row| Ok(Reason { kind: kind(&row.get::<_, String>(0)?), name: row.get(1)? }))?
            .collect::<rusqlite::Result<_>>()?;
        entry.recordings = self
            .db
            .prepare_cached("SELECT path, sha256, bytes FROM recording WHERE result = ?1 ORDER BY position")?
            .query_map([id], |row| {
                let bytes = row.get::<_, i64>(2)? as u64;
                Ok(EntryRecording { path: row.get(0)?, sha256: row.get(1)?, bytes })
            })?
            .collect::<rusqlite::Result<_>>()?;
        entry.test.earlier = self
            .db
            .prepare_cached("SELECT address FROM earlier WHERE result = ?1 ORDER BY position")?
            .query_map([id], |row| row.get(0))?
            .collect::<rusqlite::Result<_>>()?;
        attempt.missing = self
            .db
            .prepare_cached(
                "SELECT address FROM earlier e WHERE result = ?1
                 AND NOT EXISTS (SELECT 1 FROM result r WHERE r.address = e.address) ORDER BY position",
            )?
            .query_map([id], |row| row.get(0))?
            .collect::<rusqlite::Result<_>>()?;
        let correction = |row: &Row<'_>| {
            Ok(Correction {
                by: row.get(0)?,
                reason: row.get(1)?,
                operator: row.get(2)?,
                stated_at: row.get(3)?,
            })
        };
        attempt.superseded = self
            .db
            .prepare_cached(
                "SELECT by, reason, operator, stated_at FROM correction WHERE superseded = ?1
                 ORDER BY stated_at DESC, statement LIMIT 1",
            )?
            .query_map(params![attempt.address], correction)?
            .next()
            .transpose()?;
        Ok(attempt)
    }
}

impl Filter {
    /// The condition of a query, with its values.
    fn condition(&self) -> (String, Vec<Value>) {
        let mut parts: Vec<String> = vec![];
        let mut values: Vec<Value> = vec![];
        let single = [
            ("r.serial_key =", &self.serial_key),
            ("r.model =", &self.model),
            ("r.procedure =", &self.procedure),
            ("r.station =", &self.station),
            ("r.evaluated_at >=", &self.since),
        ];
        for (column, value) in single {
            if let Some(value) = value {
                parts.push(format!("{column} ?"));
                values.push(value.clone().into());
            }
        }
        if !self.lots.is_empty() {
            parts.push(format!("r.lot IN ({})", vec!["?"; self.lots.len()].join(", ")));
            values.extend(self.lots.iter().map(|lot| Value::from(lot.clone())));
        }
        let condition =
            if parts.is_empty() { String::new() } else { format!(" WHERE {}", parts.join(" AND ")) };
        (condition, values)
    }
}

fn result(row: &Row<'_>) -> rusqlite::Result<(i64, Attempt)> {
    let attributes: String = row.get(7)?;
    let entry = Entry {
        unit: EntryUnit {
            serial: row.get(2)?,
            model: row.get(3)?,
            lot: row.get(4)?,
            build_date: row.get(5)?,
            reference: row.get(6)?,
            attributes: serde_json::from_str(&attributes).unwrap_or_default(),
        },
        test: EntryTest {
            procedure: row.get(8)?,
            revision: row.get(9)?,
            procedure_sha256: row.get(10)?,
            limits: row.get(11)?,
            limits_sha256: row.get(12)?,
            station: row.get(13)?,
            operator: row.get(14)?,
            evaluated_at: row.get(15)?,
            attempt: row.get::<_, i64>(16)? as u64,
            earlier: vec![],
        },
        verdict: verdict(&row.get::<_, String>(17)?),
        result_sha256: row.get(18)?,
        measurands: vec![],
        reasons: vec![],
        recordings: vec![],
    };
    let number = row.get::<_, i64>(19)? as u64;
    Ok((row.get(0)?, Attempt { address: row.get(1)?, entry, number, superseded: None, missing: vec![] }))
}

fn measurand(row: &Row<'_>) -> rusqlite::Result<MeasurandRecord> {
    let number = |at: usize| row.get::<_, Option<f64>>(at);
    let interval = match (number(5)?, number(6)?, number(7)?) {
        (Some(low), Some(high), Some(coverage)) => Some(Interval { low, high, coverage }),
        _ => None,
    };
    let upper_limit = match (number(8)?, number(9)?) {
        (Some(value), Some(coverage)) => Some(UpperLimit { value, coverage }),
        _ => None,
    };
    let limit = LimitRecord { min: number(10)?, max: number(11)?, ..LimitRecord::default() };
    Ok(indexed(MeasurandRecord {
        id: row.get(0)?,
        channel: row.get(1)?,
        phase: row.get(2)?,
        unit: row.get(3)?,
        value: number(4)?,
        interval,
        upper_limit,
        limit: Some(limit),
        verdict: verdict(&row.get::<_, String>(12)?),
        ..MeasurandRecord::default()
    }))
}

/// The verdict of an id; the index holds no other.
fn verdict(id: &str) -> Verdict {
    let all = [Verdict::None, Verdict::Pass, Verdict::Indeterminate, Verdict::Fail, Verdict::Error];
    all.into_iter().find(|v| v.id() == id).unwrap_or(Verdict::Error)
}

/// The kind of an id; the index holds no other.
fn kind(id: &str) -> ReasonKind {
    ReasonKind::ALL.into_iter().find(|k| k.id() == id).unwrap_or(ReasonKind::Error)
}
