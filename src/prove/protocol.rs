//! Steps of a proof, each with the hash of the step before, so that none can be put in afterwards.

use crate::output::sha256;
use crate::record::ProtocolStep;
use std::collections::BTreeMap;

/// The steps of a proof.
#[derive(Debug, Clone, Default)]
pub(super) struct Protocol {
    /// In their order.
    pub steps: Vec<ProtocolStep>,
}

impl Protocol {
    /// Adds a step with the hashes of what it is about.
    pub fn add(&mut self, step: &str, hashes: BTreeMap<String, String>) {
        let line = |step: &ProtocolStep| serde_json::to_vec(step).unwrap_or_default();
        let previous = self.steps.last().map(|s| sha256(&line(s))).unwrap_or_default();
        self.steps.push(ProtocolStep { step: step.to_owned(), sha256: hashes, previous });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_step_names_the_one_before() {
        let mut protocol = Protocol::default();
        protocol.add("concealed", BTreeMap::from([("ramp".to_owned(), "ab".to_owned())]));
        protocol.add("shown", BTreeMap::new());
        let [first, second] = protocol.steps.as_slice() else { panic!() };
        assert_eq!(first.previous, "");
        let line = r#"{"step":"concealed","sha256":{"ramp":"ab"},"previous":""}"#;
        assert_eq!(second.previous, sha256(line.as_bytes()));
    }
}
