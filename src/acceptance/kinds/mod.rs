//! The kinds of test, each a file or a folder. A new kind is one file that implements
//! [`TestKind`](super::test_kind::TestKind) and one line in [`TEST_KINDS`].

mod acceleration;
pub(super) mod at_rest;
mod influence;
mod positions;
mod rate_table;
mod repeatability;
mod start_up;
mod stretch_facts;
mod temperature;
mod transfer;

use super::pipeline::Test;
use super::request::Request;
use super::test_kind::TestKind;
use crate::config::procedure::Procedure;

/// Makes a test of one kind of a procedure, where the procedure describes one.
type Maker = fn(&Procedure) -> Option<Box<dyn Test>>;

/// Every kind of test. A procedure is of the first kind that finds what it needs in it.
const TEST_KINDS: &[Maker] = &[
    kind::<transfer::OverFrequency>,
    kind::<start_up::FromSwitchingOn>,
    kind::<rate_table::RateTable>,
    kind::<positions::InPositions>,
    kind::<acceleration::InGravity>,
    kind::<repeatability::Repeated>,
    kind::<influence::UnderInfluence>,
    kind::<temperature::OverTemperature>,
    kind::<at_rest::AtRest>,
];

fn kind<K: TestKind + 'static>(procedure: &Procedure) -> Option<Box<dyn Test>> {
    K::of(procedure).map(|k| Box::new(k) as Box<dyn Test>)
}

/// The test that a procedure describes.
pub(super) fn of_procedure(procedure: &Procedure) -> Box<dyn Test> {
    TEST_KINDS.iter().find_map(|kind| kind(procedure)).unwrap_or_else(|| Box::new(at_rest::AtRest))
}

/// The test of a request: an analysis is one at rest.
pub(super) fn of_request(request: &Request<'_>) -> Box<dyn Test> {
    if request.is_run() { of_procedure(request.procedure) } else { Box::new(at_rest::AtRest) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acceptance::condition::checks::{ALL_CHECKS, OF_EVERY_TEST};
    use std::path::Path;

    #[test]
    fn every_check_belongs_to_a_kind_of_test_and_stands_in_the_list() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("procedures");
        let mut claimed: Vec<&str> = OF_EVERY_TEST.to_vec();
        for file in std::fs::read_dir(folder).unwrap().flatten() {
            if let Ok(procedure) = crate::config::procedure::load(&file.path()) {
                claimed.extend(of_procedure(&procedure.value).checks());
            }
        }
        assert!(claimed.iter().all(|id| ALL_CHECKS.contains(id)), "{claimed:?}");
        assert!(ALL_CHECKS.iter().all(|id| claimed.contains(id)), "{claimed:?}");
    }
}
