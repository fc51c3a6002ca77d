//! Swings of which a record holds few. A thermostat or a day that was not recorded swings as regularly through them as
//! what turns by itself, and no statistic of one record tells which it was.

use super::finding::ParameterValue;
use super::options::Options;
use std::collections::BTreeMap;

/// Kinds that swing at a frequency of their own.
const SWING: [&str; 2] = ["line", "quasi_periodic"];
/// What may have made the swings.
const DRIVER: &str = "unobserved_driver";
/// Swings of a record from which their regularity tells.
const TELLING: f64 = 20.0;

/// The driver that was not recorded, beside a kind that swings fewer than [`TELLING`] times in `length_s`.
pub(super) fn driver_beside(
    kind: &str,
    reported: &BTreeMap<String, ParameterValue>,
    length_s: f64,
    options: &Options,
) -> Option<&'static str> {
    let swings = reported.get("frequency_hz")?.value * length_s;
    (SWING.contains(&kind) && swings < TELLING && options.allows(DRIVER)).then_some(DRIVER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_swings_may_be_those_of_a_driver_and_many_may_not() {
        let at = |hz: f64| {
            let value = ParameterValue { value: hz, unit: "Hz".into(), ci95: [hz, hz] };
            BTreeMap::from([("frequency_hz".to_owned(), value)])
        };
        let options = Options::default();
        assert_eq!(driver_beside("line", &at(0.019), 1000.0, &options), Some(DRIVER));
        assert_eq!(driver_beside("quasi_periodic", &at(0.003), 1000.0, &options), Some(DRIVER));
        assert_eq!(driver_beside("line", &at(0.021), 1000.0, &options), None);
        assert_eq!(driver_beside("excess_rrw", &at(0.003), 1000.0, &options), None);
        assert_eq!(driver_beside("line", &BTreeMap::new(), 1000.0, &options), None);
        let without = Options { without: vec![DRIVER], ..options };
        assert_eq!(driver_beside("line", &at(0.003), 1000.0, &without), None);
    }
}
