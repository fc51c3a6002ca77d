//! Tests of the axes.

use super::*;
use crate::figure::Axis;

fn rule(scale: Scale, unit: &str, data: (f64, f64), direction: Direction, length: f64) -> Ruled {
    let axis = Axis { label: "x".into(), unit: unit.into(), scale, range: None };
    Ruled::new(&axis, Some(data), direction, length, Lang::En)
}

fn words(r: &Ruled) -> Vec<&str> {
    r.ticks.iter().filter_map(|t| t.label.as_deref()).collect()
}

#[test]
fn decades_are_marked_and_written() {
    let r = rule(Scale::Log, "s", (1.0, 12_000.0), Direction::Across, 650.0);
    assert_eq!(words(&r), ["1", "10", "100", "1000", "10\u{202f}000"]);
    assert_eq!(r.title, "x, s");
    let minor = r.ticks.iter().filter(|t| t.label.is_none()).count();
    assert!(minor >= 32, "{minor}");
}

#[test]
fn under_a_decade_the_marks_are_finer() {
    let r = rule(Scale::Log, "", (2.3, 4.1), Direction::Up, 300.0);
    assert!(words(&r).len() >= 2, "{:?}", words(&r));
    let r = rule(Scale::Log, "", (2.31, 2.34), Direction::Up, 300.0);
    assert!(words(&r).len() >= 2, "{:?}", words(&r));
    let r = rule(Scale::Log, "", (0.7, 9.0), Direction::Up, 300.0);
    assert_eq!(words(&r), ["1", "2", "5"]);
}

#[test]
fn many_decades_do_not_crowd() {
    let r = rule(Scale::Log, "", (1e-14, 1e9), Direction::Up, 200.0);
    assert!((4..=12).contains(&words(&r).len()), "{:?}", words(&r));
    assert!(words(&r).iter().all(|w| w.starts_with("10")));
}

#[test]
fn time_is_written_in_the_unit_that_suits() {
    let title = |end| rule(Scale::Linear, "s", (0.0, end), Direction::Across, 650.0).title;
    assert_eq!(title(36_000.0), "x, h");
    assert_eq!(title(1800.0), "x, min");
    assert_eq!(title(60.0), "x, s");
    assert_eq!(title(864_000.0), "x, d");
    let r = rule(Scale::Linear, "s", (0.0, 36_000.0), Direction::Across, 650.0);
    assert_eq!(words(&r), ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10"]);
}

#[test]
fn small_and_large_numbers_move_their_power_to_the_title() {
    let r = rule(Scale::Linear, "deg/h", (-4e-6, 4e-6), Direction::Up, 200.0);
    assert_eq!(r.title, "x, 10⁻⁶ °/h");
    assert!(words(&r).contains(&"−2"), "{:?}", words(&r));
    let r = rule(Scale::Linear, "deg/h", (12.470_100, 12.470_101), Direction::Up, 200.0);
    assert!(r.title.starts_with("x − 12.4701"), "{}", r.title);
    assert!(words(&r).iter().all(|w| w.chars().count() <= 6), "{:?}", words(&r));
}

#[test]
fn degenerate_data_has_an_axis() {
    for scale in [Scale::Linear, Scale::Log] {
        for data in [(0.0, 0.0), (5.0, 5.0), (1e308, 1e308), (-1e308, 1e308), (5e-324, 5e-324)] {
            let r = rule(scale, "", data, Direction::Up, 200.0);
            assert!(!r.ticks.is_empty() && r.ticks.len() < 200, "{scale:?} {data:?}");
            assert!(
                r.ticks.iter().all(|t| t.at.is_finite() && r.place(t.at).is_some()),
                "{scale:?} {data:?}"
            );
            assert!(r.low < r.high, "{scale:?} {data:?}");
        }
    }
    assert_eq!(rule(Scale::Log, "", (1.0, 10.0), Direction::Up, 200.0).place(-1.0), None);
    assert_eq!(rule(Scale::Linear, "", (1.0, 10.0), Direction::Up, 200.0).place(f64::NAN), None);
}

#[test]
fn words_along_an_axis_never_overlap() {
    for (low, high) in [(0.0, 1.0), (-123_456.7, 99.0), (0.001, 0.001_02), (1e-3, 4e4)] {
        for scale in [Scale::Linear, Scale::Log] {
            let r = rule(scale, "deg/h", (low, high), Direction::Across, 640.0);
            let placed: Vec<(f64, f64)> = r
                .ticks
                .iter()
                .filter_map(|t| Some((r.place(t.at)? * 640.0, width(t.label.as_ref()?, FONT))))
                .collect();
            for pair in placed.windows(2) {
                assert!(pair[1].0 - pair[0].0 > 0.5 * (pair[0].1 + pair[1].1), "{:?}", words(&r));
            }
        }
    }
}

#[test]
fn a_fixed_range_is_kept_and_a_senseless_one_is_not() {
    let axis = |range| Axis { label: "x".into(), unit: String::new(), scale: Scale::Linear, range };
    let r = Ruled::new(&axis(Some((-2.0, 3.0))), Some((0.0, 1.0)), Direction::Up, 200.0, Lang::En);
    assert_eq!((r.low, r.high), (-2.0, 3.0));
    let r = Ruled::new(&axis(Some((3.0, f64::NAN))), Some((0.0, 1.0)), Direction::Up, 200.0, Lang::En);
    assert!(r.low < 0.0 && r.high > 1.0);
}
