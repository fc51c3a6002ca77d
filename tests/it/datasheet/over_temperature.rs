//! Bias over temperature of a lot, from results with compensation tables beside them.

use crate::datasheet::sheet;
use crate::support::pairs::sample_once;
use crate::support::sagnac;

#[test]
fn units_with_compensation_tables_are_told_over_temperature() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    let result = |name: &str| format!("{}/result.json", sample_once(name).path());
    let (pass, fail) = (result("temperature-pass"), result("temperature-fail"));
    let said = sagnac(at, &["datasheet", &pass, &fail, "--out", "s"]);
    assert_eq!(said.code, 0, "{said:?}");
    let sheet = sheet(&at.join("s"));
    let curve = &sheet["temperature_curves"][0];
    let (points, units) = (curve["points"].as_array().unwrap(), curve["units"].as_array().unwrap());
    assert_eq!((points.len(), units.len()), (25, 2));
    for unit in units {
        let values = unit["points"].as_array().unwrap().iter().map(|p| p[1].as_f64().unwrap());
        let (sum, most) = values.fold((0.0, 0.0f64), |(s, m), v| (s + v, m.max(v.abs())));
        assert!(most > 0.0 && sum.abs() < 1e-9 * most, "{unit}");
    }
    let page = std::fs::read_to_string(at.join("s/datasheet.html")).unwrap();
    assert!(page.contains("Bias over temperature of the units"));
    assert_eq!(sagnac(at, &["verify", "s"]).code, 0);
}
