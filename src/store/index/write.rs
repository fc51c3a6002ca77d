//! Rows of results and statements.

use super::Index;
use super::order::put_in_order;
use crate::store::entry::Entry;
use crate::store::error::StoreError;
use crate::store::statement::{Statement, What};
use rusqlite::{Connection, params};

impl Index {
    /// Adds a result, all of its rows or none. `false` where it is there already.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn add(&mut self, address: &str, entry: &Entry) -> Result<bool, StoreError> {
        self.in_one(|db| {
            let new = insert(db, address, entry)?;
            if new {
                put_in_order(db, Some((&entry.unit.key(), &entry.test.procedure)))?;
            }
            Ok(new)
        })
    }

    /// Adds what is stated under the hash of a statement.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn add_statement(&mut self, hash: &str, statement: &Statement) -> Result<(), StoreError> {
        self.in_one(|db| state(db, hash, statement))
    }

    /// Adds many results and statements at once.
    ///
    /// # Errors
    /// What the database refuses, or the first error of the results.
    pub fn fill(
        &mut self,
        results: impl Iterator<Item = Result<(String, Entry), StoreError>>,
        statements: &[(String, Statement)],
    ) -> Result<usize, StoreError> {
        let path = self.path.clone();
        let refused = |e: rusqlite::Error| StoreError::of_database(&path, &e);
        let change = self.db.transaction().map_err(refused)?;
        let mut count = 0;
        for result in results {
            let (address, entry) = result?;
            count += usize::from(insert(&change, &address, &entry).map_err(refused)?);
        }
        for (hash, statement) in statements {
            state(&change, hash, statement).map_err(refused)?;
        }
        put_in_order(&change, None).map_err(refused)?;
        change.commit().map_err(refused)?;
        Ok(count)
    }

    fn in_one<T>(&mut self, of: impl FnOnce(&Connection) -> rusqlite::Result<T>) -> Result<T, StoreError> {
        let path = self.path.clone();
        let refused = |e: rusqlite::Error| StoreError::of_database(&path, &e);
        // Who begins by reading could not go on to write after another has written meanwhile.
        let change =
            self.db.transaction_with_behavior(rusqlite::TransactionBehavior::Immediate).map_err(refused)?;
        let done = of(&change).map_err(refused)?;
        change.commit().map_err(refused)?;
        Ok(done)
    }
}

fn insert(db: &Connection, address: &str, entry: &Entry) -> rusqlite::Result<bool> {
    let (unit, test) = (&entry.unit, &entry.test);
    let attributes = serde_json::to_string(&unit.attributes).unwrap_or_default();
    let new = db
        .prepare_cached(
            "INSERT OR IGNORE INTO result (address, serial, serial_key, model, lot, build_date, reference, attributes,
             procedure, revision, procedure_sha256, limits, limits_sha256, station, operator, evaluated_at, placed_at, attempt,
             verdict, result_sha256)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?16, ?17, ?18, ?19)",
        )?
        .execute(params![
            address,
            unit.serial,
            unit.key(),
            unit.model,
            unit.lot,
            unit.build_date,
            unit.reference,
            attributes,
            test.procedure,
            test.revision,
            test.procedure_sha256,
            test.limits,
            test.limits_sha256,
            test.station,
            test.operator,
            test.evaluated_at,
            test.attempt as i64,
            entry.verdict.id(),
            entry.result_sha256,
        ])?;
    if new == 0 {
        return Ok(false);
    }
    let id = db.last_insert_rowid();
    let mut measurands = db.prepare_cached(
        "INSERT INTO measurand VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15)",
    )?;
    for (position, m) in entry.measurands.iter().enumerate() {
        measurands.execute(params![
            id,
            position as i64,
            m.id,
            m.channel,
            m.phase,
            m.unit,
            m.value,
            m.interval.map(|i| i.low),
            m.interval.map(|i| i.high),
            m.interval.map(|i| i.coverage),
            m.upper_limit.map(|u| u.value),
            m.upper_limit.map(|u| u.coverage),
            m.limits().min,
            m.limits().max,
            m.verdict.id(),
        ])?;
    }
    let mut reasons = db.prepare_cached("INSERT INTO reason VALUES (?1, ?2, ?3, ?4)")?;
    for (position, r) in entry.reasons.iter().enumerate() {
        reasons.execute(params![id, position as i64, r.kind.id(), r.name])?;
    }
    let mut recordings = db.prepare_cached("INSERT INTO recording VALUES (?1, ?2, ?3, ?4, ?5)")?;
    for (position, r) in entry.recordings.iter().enumerate() {
        recordings.execute(params![id, position as i64, r.path, r.sha256, r.bytes as i64])?;
    }
    let mut earlier = db.prepare_cached("INSERT INTO earlier VALUES (?1, ?2, ?3)")?;
    for (position, before) in test.earlier.iter().enumerate() {
        earlier.execute(params![id, position as i64, before])?;
    }
    Ok(true)
}

fn state(db: &Connection, hash: &str, statement: &Statement) -> rusqlite::Result<()> {
    let at = &statement.stated_at;
    match &statement.what {
        What::Correction { superseded, by, reason, operator } => db
            .prepare_cached("INSERT OR IGNORE INTO correction VALUES (?1, ?2, ?3, ?4, ?5, ?6)")?
            .execute(params![hash, superseded, by, reason, operator, at])?,
        What::Place { sha256, path } => db
            .prepare_cached("INSERT OR IGNORE INTO place VALUES (?1, ?2, ?3, ?4)")?
            .execute(params![hash, sha256, path, at])?,
    };
    Ok(())
}
