//! The shipped samples with their procedures, as `samples/README.md` lists them.

use super::shared::{SharedRun, shared};
use super::shipped;

/// A shipped sample tested as its pair says.
pub fn sample_once(sample: &str) -> &'static SharedRun {
    let pair = PAIRS.iter().find(|p| p.sample == sample).unwrap_or_else(|| panic!("{sample}"));
    let procedure = shipped(&format!("procedures/{}.toml", pair.procedure));
    let recording = shipped(&format!("samples/{sample}.csv"));
    let limits = pair.limits.map(|l| shipped(&format!("procedures/limits/{l}.toml")));
    let mut args = vec!["run", &procedure, &recording, "--serial", pair.serial];
    args.extend(limits.iter().flat_map(|l| ["--limits", l.as_str()]));
    let run = shared(&args, "r");
    assert_eq!(run.said.code, pair.code, "{sample}: {:?}", run.said);
    run
}

/// A sample and what it is judged by.
pub struct Pair {
    /// Name of the sample.
    pub sample: &'static str,
    /// Name of the procedure.
    pub procedure: &'static str,
    /// Name of the limits, where they do not stand in the procedure.
    pub limits: Option<&'static str>,
    /// Serial number.
    pub serial: &'static str,
    /// Exit code.
    pub code: i32,
    /// The channel of the influence, where the recording has one.
    pub influence: Option<&'static str>,
    /// Length of the first interval of a schedule that nothing but the procedure tells, s.
    pub schedule_s: Option<f64>,
}

const fn pair(
    sample: &'static str,
    procedure: &'static str,
    limits: Option<&'static str>,
    serial: &'static str,
    code: i32,
    influence: Option<&'static str>,
) -> Pair {
    Pair { sample, procedure, limits, serial, code, influence, schedule_s: None }
}

/// The recording begins with an interval of this length at least without the influence, which only the procedure tells.
const fn scheduled(pair: Pair, interval_s: f64) -> Pair {
    Pair { schedule_s: Some(interval_s), ..pair }
}

const UNIT: Option<&str> = Some("sample-unit");
const OVEN: Option<&str> = Some("sample-temperature");
const WARM: Option<&str> = Some("sample-warm-up");
const RATE: Option<&str> = Some("table_rate_deg_s");
const OUTER: Option<&str> = Some("outer_rate_deg_s");
const FIELD: Option<&str> = Some("field_mT");
const VOLTS: Option<&str> = Some("supply_V");
const BARO: Option<&str> = Some("pressure_kPa");
const SWITCH: Option<&str> = Some("field_on");
const TEMP: Option<&str> = Some("temp_degC");

/// Every pair.
pub const PAIRS: [Pair; 49] = [
    pair("unit-pass", "static-bias", UNIT, "SN-0001", 0, None),
    pair("unit-fail", "static-bias", UNIT, "SN-0001", 1, None),
    pair("unit-indeterminate", "static-bias", UNIT, "SN-0001", 3, None),
    pair("unit-faults", "static-bias", UNIT, "SN-0001", 3, None),
    pair("scale-factor-pass", "scale-factor", None, "SN-1", 0, RATE),
    pair("scale-factor-fail", "scale-factor", None, "SN-1", 1, RATE),
    pair("scale-factor-over-temperature-pass", "scale-factor-over-temperature", None, "SN-1", 0, RATE),
    pair("scale-factor-over-temperature-fail", "scale-factor-over-temperature", None, "SN-1", 1, RATE),
    pair("threshold-pass", "threshold", None, "SN-1", 0, RATE),
    pair("threshold-fail", "threshold", None, "SN-1", 1, RATE),
    pair("maximum-rate-pass", "maximum-rate", None, "SN-1", 0, RATE),
    pair("maximum-rate-fail", "maximum-rate", None, "SN-1", 1, RATE),
    pair("transfer-function-pass", "transfer-function", None, "SN-1", 0, None),
    pair("transfer-function-fail", "transfer-function", None, "SN-1", 1, None),
    pair("start-up-pass", "start-up", None, "SN-1", 0, None),
    pair("start-up-fail", "start-up", None, "SN-1", 1, None),
    pair("bench-check-pass", "bench-check", None, "REF-1", 0, RATE),
    pair("bench-check-fail", "bench-check", None, "REF-1", 1, RATE),
    pair("misalignment-pass", "misalignment", None, "SN-1", 0, OUTER),
    pair("misalignment-fail", "misalignment", None, "SN-1", 1, OUTER),
    scheduled(pair("multi-position-pass", "multi-position", None, "SN-1", 0, None), 60.0),
    scheduled(pair("multi-position-software", "multi-position", None, "SN-1", 3, None), 60.0),
    pair("output-noise-pass", "output-noise", None, "SN-0119", 0, None),
    pair("output-noise-fail", "output-noise", None, "SN-0120", 1, None),
    scheduled(pair("acceleration-pass", "acceleration", None, "SN-1", 0, None), 60.0),
    scheduled(pair("acceleration-fail", "acceleration", None, "SN-1", 1, None), 60.0),
    pair("temperature-pass", "temperature-ramp", OVEN, "SN-0101", 0, TEMP),
    pair("temperature-fail", "temperature-ramp", OVEN, "SN-0102", 1, TEMP),
    pair("temperature-aborted", "temperature-ramp", OVEN, "SN-0103", 3, TEMP),
    pair("temperature-soak-pass", "temperature-soak", OVEN, "SN-0104", 0, TEMP),
    pair("temperature-soak-fail", "temperature-soak", OVEN, "SN-0105", 1, TEMP),
    pair("warm-up-pass", "warm-up", WARM, "SN-0106", 0, None),
    pair("warm-up-fail", "warm-up", WARM, "SN-0107", 1, None),
    pair("bias-repeatability-pass", "bias-repeatability", None, "SN-0111", 0, None),
    pair("bias-repeatability-fail", "bias-repeatability", None, "SN-0112", 1, None),
    pair("magnetic-sensitivity-pass", "magnetic-sensitivity", None, "SN-0113", 0, FIELD),
    pair("magnetic-sensitivity-fail", "magnetic-sensitivity", None, "SN-0114", 1, FIELD),
    pair("supply-sensitivity-pass", "supply-sensitivity", None, "SN-0115", 0, VOLTS),
    pair("supply-sensitivity-fail", "supply-sensitivity", None, "SN-0116", 1, VOLTS),
    scheduled(pair("vibration-pass", "vibration", None, "SN-0117", 0, None), 120.0),
    scheduled(pair("vibration-fail", "vibration", None, "SN-0118", 1, None), 120.0),
    pair("pressure-sensitivity-pass", "pressure-sensitivity", None, "SN-0121", 0, BARO),
    pair("pressure-sensitivity-fail", "pressure-sensitivity", None, "SN-0122", 1, BARO),
    pair("electromagnetic-immunity-pass", "electromagnetic-immunity", None, "SN-0123", 0, SWITCH),
    pair("electromagnetic-immunity-fail", "electromagnetic-immunity", None, "SN-0124", 1, SWITCH),
    pair("scale-factor-under-pressure-pass", "scale-factor-under-pressure", None, "SN-0125", 0, BARO),
    pair("scale-factor-under-pressure-fail", "scale-factor-under-pressure", None, "SN-0126", 1, BARO),
    scheduled(pair("vibration-by-frequency-pass", "vibration-by-frequency", None, "SN-0127", 0, None), 24.0),
    scheduled(pair("vibration-by-frequency-fail", "vibration-by-frequency", None, "SN-0128", 1, None), 24.0),
];
