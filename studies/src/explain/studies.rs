//! The studies: correct claims, clear and weak effects, the closed loop, pairs, and what no catalogue has.

use super::by_library::by_the_library;
use super::plan::{Wish, wishes};
use super::rows;
use super::run::{How, all};
use super::table::Row;
use crate::study::{self, Case, Study};

const METHOD: &str = "Cases of a generator that imports nothing of the library: a claim of a gyro's noise and mean, and a recording with \
    effects that the claim leaves out. The strength is the gain of log-likelihood that is expected from naming them.";

/// Correct claims.
pub static NULLS: Study = Study {
    id: "explanation-of-correct-claims",
    title: "Correct claims",
    method: METHOD,
    records: 2000,
    cases: || vec![case("correct claims", "null", CLEAR, How::default(), |rows| rows::of_nulls(&rows))],
};

/// Clear effects of the catalogue.
pub static CLEAR_EFFECTS: Study = Study {
    id: "explanation-of-clear-effects",
    title: "Clear effects of the catalogue",
    method: METHOD,
    records: 100,
    cases: || {
        vec![case("strength 60 to 300", "all", CLEAR, How::default(), |rows| {
            [rows::of_clear(&rows), rows::of_kinds(&rows), rows::of_parameters(&rows)].concat()
        })]
    },
};

/// Effects between what hardly shows and what is clear.
pub static WEAK_EFFECTS: Study = Study {
    id: "explanation-of-weak-effects",
    title: "Weak effects of the catalogue",
    method: METHOD,
    records: 20,
    cases: || {
        vec![case("strength 4 to 60", "all", (4.0, 60.0), How::default(), |rows| rows::of_strengths(&rows))]
    },
};

/// The augmented claim against recordings.
pub static CLOSED_LOOP: Study = Study {
    id: "explanation-closed-loop",
    title: "The augmented claim against recordings",
    method: METHOD,
    records: 10,
    cases: || {
        let how = How { close: true, ..How::default() };
        vec![case("strength 60 to 300", "all", CLEAR, how, |rows| rows::of_loop(&rows))]
    },
};

/// Two effects at once, and effects of no catalogue.
pub static OTHERS: Study = Study {
    id: "explanation-of-pairs-and-unknowns",
    title: "Two effects at once, and effects of no catalogue",
    method: METHOD,
    records: 100,
    cases: || {
        let how = How { removed: true, ..How::default() };
        let unknown = |rows: Vec<Row>| [rows::of_unknown(&rows), rows::of_kinds(&rows)].concat();
        vec![
            case("two effects", "pair", CLEAR, How::default(), |rows| rows::of_pairs(&rows)),
            case("effects of no catalogue, those of development", "unknown", CLEAR, How::default(), unknown),
            case("effects of no catalogue, held out", "held_out", CLEAR, How::default(), unknown),
            case("effects taken out of the catalogue", "all", CLEAR, how, unknown),
        ]
    },
};

/// Strengths of clear effects.
const CLEAR: (f64, f64) = (60.0, 300.0);

fn case(
    name: &str,
    kinds: &str,
    strength: (f64, f64),
    how: How,
    rows: impl Fn(Vec<Row>) -> Vec<study::Row> + 'static,
) -> Case {
    let wishes: Vec<Wish> = wishes(kinds);
    Case::new(name, move |records, seed| {
        let first = 1 + 1_000_000 * (seed - 1);
        rows(all(&by_the_library, &wishes, first..first + records, strength, how))
    })
}
