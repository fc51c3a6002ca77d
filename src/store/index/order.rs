//! The order of the attempts of a unit at a test.
//!
//! Moments of evaluation give it, but for a clock that was set back: an attempt comes after those that it names, and after those
//! that state a lower number, whatever its clock said.

use rusqlite::{Connection, params};
use std::collections::BTreeMap;

/// What the order of an attempt follows from.
#[derive(Debug, Default)]
struct Attempted {
    id: i64,
    address: String,
    evaluated_at: String,
    number: u64,
    earlier: Vec<String>,
}

/// Writes the moments by which attempts are put in order: those of one unit and procedure, or all.
pub(super) fn put_in_order(db: &Connection, of: Option<(&str, &str)>) -> rusqlite::Result<()> {
    let (unit, procedure) = of.unzip();
    let mut attempts: BTreeMap<(String, String), Vec<Attempted>> = BTreeMap::new();
    // Only where something states a number can the order differ from that of the clocks.
    let mut stated = db.prepare_cached(
        "SELECT serial_key, procedure, id, address, evaluated_at, attempt FROM result r
         WHERE serial_key <> '' AND (?1 IS NULL OR (serial_key = ?1 AND procedure = ?2))
         AND EXISTS (SELECT 1 FROM result s WHERE s.serial_key = r.serial_key AND s.procedure = r.procedure AND s.attempt > 0)",
    )?;
    let mut rows = stated.query(params![unit, procedure])?;
    while let Some(row) = rows.next()? {
        let id: i64 = row.get(2)?;
        let earlier = db
            .prepare_cached("SELECT address FROM earlier WHERE result = ?1")?
            .query_map([id], |row| row.get(0))?
            .collect::<rusqlite::Result<_>>()?;
        attempts.entry((row.get(0)?, row.get(1)?)).or_default().push(Attempted {
            id,
            address: row.get(3)?,
            evaluated_at: row.get(4)?,
            number: row.get::<_, i64>(5)? as u64,
            earlier,
        });
    }
    for of_one in attempts.values() {
        for (attempt, placed_at) in of_one.iter().zip(placed(of_one)) {
            db.prepare_cached("UPDATE result SET placed_at = ?2 WHERE id = ?1 AND placed_at <> ?2")?
                .execute(params![attempt.id, placed_at])?;
        }
    }
    Ok(())
}

/// The moment of each attempt, or of a later one that came before it.
fn placed(attempts: &[Attempted]) -> Vec<String> {
    let mut placed: Vec<String> = attempts.iter().map(|a| a.evaluated_at.clone()).collect();
    let by_address: BTreeMap<&str, usize> =
        attempts.iter().enumerate().map(|(i, a)| (a.address.as_str(), i)).collect();
    let mut by_number: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (i, attempt) in attempts.iter().enumerate().filter(|(_, a)| a.number > 0) {
        by_number.entry(attempt.number).or_default().push(i);
    }
    // No chain of attempts is longer than all of them; a chain in a circle, which no honest record has, ends here too.
    for _ in attempts {
        let mut moved = false;
        let mut lower = String::new();
        for same in by_number.values() {
            let before = lower.clone();
            for i in same {
                moved |= move_to(&mut placed, *i, &before);
                lower = placed.get(*i).map_or(lower.clone(), |at| lower.max(at.clone()));
            }
        }
        for (i, own) in attempts.iter().enumerate() {
            let named = own.earlier.iter().filter_map(|e| by_address.get(e.as_str()));
            let latest = named.filter_map(|named| placed.get(*named)).max().cloned();
            moved |= latest.is_some_and(|latest| move_to(&mut placed, i, &latest));
        }
        if !moved {
            break;
        }
    }
    placed
}

/// Moves a moment to a later one; false where it is not later.
fn move_to(placed: &mut [String], i: usize, at: &str) -> bool {
    match placed.get_mut(i) {
        Some(own) if at > own.as_str() => {
            at.clone_into(own);
            true
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attempt(address: &str, evaluated_at: &str, number: u64, earlier: &[&str]) -> Attempted {
        Attempted {
            address: address.to_owned(),
            evaluated_at: evaluated_at.to_owned(),
            number,
            earlier: earlier.iter().map(|e| (*e).to_owned()).collect(),
            ..Attempted::default()
        }
    }

    #[test]
    fn an_attempt_comes_after_those_that_it_follows_whatever_the_clock_says() {
        let by_number =
            [attempt("c", "2025", 3, &[]), attempt("a", "2027", 1, &[]), attempt("b", "2026", 2, &[])];
        assert_eq!(placed(&by_number), ["2027", "2027", "2027"]);
        // Made elsewhere, without a number.
        let by_name =
            [attempt("b", "2026", 2, &["a"]), attempt("a", "2027", 0, &[]), attempt("z", "2028", 0, &[])];
        assert_eq!(placed(&by_name), ["2027", "2027", "2028"]);
        let in_a_circle = [attempt("a", "2026", 0, &["b"]), attempt("b", "2027", 0, &["a"])];
        assert_eq!(placed(&in_a_circle), ["2027", "2027"]);
    }
}
