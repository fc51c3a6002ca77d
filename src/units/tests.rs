use super::*;

fn factor(from: &str, to: &str) -> f64 {
    Unit::parse(from).unwrap().factor_to(&Unit::parse(to).unwrap()).unwrap()
}

#[test]
fn conversions_that_gyro_work_lives_on_are_exact() {
    assert_eq!(factor("deg/s", "deg/h"), 3600.0);
    assert_eq!(factor("arcsec/s", "deg/h"), 1.0);
    assert!((factor("rad/s", "deg/h") / 206_264.806_247_096_36 - 1.0).abs() < 1e-14);
    assert!((factor("deg/sqrt(s)", "deg/sqrt(h)") - 60.0).abs() < 1e-12);
    assert!((factor("(deg/h)/sqrt(Hz)", "deg/sqrt(h)") - 1.0 / 60.0).abs() < 1e-16);
    assert!((factor("deg/h^1.5", "deg/h/sqrt(h)") - 1.0).abs() < 1e-15);
    assert_eq!(factor("deg/h/(degC/h)", "deg/h/(degC/min)"), 60.0);
}

#[test]
fn other_spellings_mean_the_same() {
    for (a, b) in [
        ("град/ч", "deg/h"),
        ("град/√ч", "deg/sqrt(h)"),
        ("°/√h", "deg/sqrt(h)"),
        ("deg/hr", "deg/h"),
        ("dph", "deg/h"),
        ("deg/h²", "deg/h/h"),
        ("deg/h^(3/2)", "deg/h/sqrt(h)"),
    ] {
        assert!((factor(a, b) - 1.0).abs() < 1e-14, "{a} {b}");
    }
}

#[test]
fn temperatures_carry_their_offset_and_differences_do_not() {
    let (c, k, f) = (Unit::parse("degC").unwrap(), Unit::parse("K").unwrap(), Unit::parse("degF").unwrap());
    assert!((c.convert(20.0, &k).unwrap() - 293.15).abs() < 1e-12);
    assert!((f.convert(68.0, &c).unwrap() - 20.0).abs() < 1e-12);
    assert_eq!(factor("ppm/K", "ppm/degC"), 1.0);
}

#[test]
fn a_wrong_dimension_is_named() {
    let e = Unit::parse("deg/sqrt(h)")
        .unwrap()
        .factor_to(&Unit::parse("deg/h").unwrap())
        .unwrap_err()
        .to_string();
    assert!(e.contains("an angle random walk") && e.contains("an angular rate"), "{e}");
}

#[test]
fn nonsense_is_refused_with_a_hint() {
    assert_eq!(
        Unit::parse("dge/h").unwrap_err(),
        UnitError::Unknown { symbol: "dge".into(), suggestion: Some("deg".into()) }
    );
    for bad in ["", "deg/", "(deg", "deg/h)", "deg^0.3", "((((((((((deg))))))))))", "sqrt", "deg//h", "/h"] {
        assert!(Unit::parse(bad).is_err(), "{bad}");
    }
}
