use super::*;
use proptest::prelude::*;

/// 2026-03-01T00:00:00Z, from `date -u -d 2026-03-01 +%s`.
const MARCH: i64 = 1_772_323_200;

fn at(text: &str) -> Option<(Shape, i64, f64)> {
    let shape = detect(text.as_bytes())?;
    let stamp = parse(text.as_bytes(), shape)?;
    Some((shape, stamp.seconds, stamp.after(stamp.seconds)))
}

#[test]
fn every_way_to_write_a_stamp_is_read() {
    use Order::*;
    use Shape::*;
    for (text, shape, seconds, fraction) in [
        ("2026-03-01T00:00:00Z", DateTime(YearFirst), MARCH, 0.0),
        ("2026-03-01 00:00:00", DateTime(YearFirst), MARCH, 0.0),
        ("2026/03/01 00:00:01.25", DateTime(YearFirst), MARCH + 1, 0.25),
        ("2026-03-01T03:00:00+03:00", DateTime(YearFirst), MARCH, 0.0),
        ("2026-02-28T19:30:00-0430", DateTime(YearFirst), MARCH, 0.0),
        ("2026-03-01T05:00:00+05", DateTime(YearFirst), MARCH, 0.0),
        ("2026-03-01 00:00:00 UTC", DateTime(YearFirst), MARCH, 0.0),
        ("2026-03-01T00:00", DateTime(YearFirst), MARCH, 0.0),
        ("20260301T000000", DateTime(YearFirst), MARCH, 0.0),
        ("20260301T000000.5Z", DateTime(YearFirst), MARCH, 0.5),
        ("20260301 00:00:02", DateTime(YearFirst), MARCH + 2, 0.0),
        ("01.03.2026 00:00:00,125", DateTime(DayFirst), MARCH, 0.125),
        ("1.3.2026 0:00:05", DateTime(DayFirst), MARCH + 5, 0.0),
        ("2026-03-01", Date(YearFirst), MARCH, 0.0),
        ("01.03.2026", Date(DayFirst), MARCH, 0.0),
        ("23:59:60.5", Clock, 86_400, 0.5),
        ("9:05:07", Clock, 32_707, 0.0),
        ("11:43:05.5 PM", Clock, 85_385, 0.5),
        ("12:00:01 am", Clock, 1, 0.0),
        ("57:20.5", MinuteClock, 3440, 0.5),
        ("12:34:56:250", Clock, 45_296, 0.25),
        ("01-Mar-2026 00:00:05.5", DateTime(DayFirst), MARCH + 5, 0.5),
        ("1 mar 2026 00:00:05", DateTime(DayFirst), MARCH + 5, 0.0),
        ("3/1/2026 12:00:00.000 AM", DateTime(MonthFirst), MARCH, 0.0),
        ("3/13/2026 1:00:00 PM", DateTime(MonthFirst), MARCH + 12 * 86_400 + 46_800, 0.0),
        ("31/3/2026 00:00:00", DateTime(DayFirst), MARCH + 30 * 86_400, 0.0),
        ("2024-02-29T12:00:00Z", DateTime(YearFirst), 1_709_208_000, 0.0),
        ("1969-12-31T23:59:59Z", DateTime(YearFirst), -1, 0.0),
    ] {
        assert_eq!(at(text), Some((shape, seconds, fraction)), "{text}");
    }
}

#[test]
fn what_is_no_stamp_is_left() {
    for text in [
        "",
        "1",
        "1.5",
        "-1.5",
        "1e-3",
        "12:30",
        "24:00:00",
        "12:60:00",
        "12:00:61",
        "2026-13-01",
        "2026-02-29",
        "32.01.2026",
        "03/01/2026",
        "3/1/2026 10:00:00",
        "2026-03-01T",
        "2026-03-01T10:00:00+99:00",
        "192.168.1.1",
        "1.2.3",
        "abc",
        "12:00:00.",
        "2026-03-01T10:00:00Zx",
        "10:00:00 x",
        "--",
        "2026-03/01",
    ] {
        assert_eq!(at(text), None, "{text}");
    }
    assert!(parse(b"03/01/2026 10:00:00", Shape::DateTime(Order::MonthFirst)).is_some());
}

#[test]
fn nanoseconds_survive() {
    let stamp = parse(b"2026-03-01T23:59:59.123456789Z", Shape::DateTime(Order::YearFirst)).unwrap();
    assert_eq!(stamp.after(MARCH), 86_399.123_456_789);
    let long = parse(b"00:00:01.1234567890123456789", Shape::Clock).unwrap();
    assert_eq!(long.after(0), 1.123_456_789_012_345_6);
}

proptest! {
    #[test]
    fn stamps_agree_with_another_calendar(seconds in -60_000_000_000i64..200_000_000_000, nano in 0u32..1_000_000_000) {
        let time = chrono::DateTime::from_timestamp(seconds, nano).unwrap();
        let years = chrono::Datelike::year(&time);
        prop_assume!((1..=9999).contains(&years));
        for (format, shape) in [
            ("%Y-%m-%dT%H:%M:%S%.9fZ", Shape::DateTime(Order::YearFirst)),
            ("%d.%m.%Y %H:%M:%S%.9f", Shape::DateTime(Order::DayFirst)),
            ("%Y%m%dT%H%M%S%.9f", Shape::DateTime(Order::YearFirst)),
        ] {
            let text = time.format(format).to_string();
            let stamp = parse(text.as_bytes(), shape).unwrap();
            prop_assert_eq!(stamp.seconds, seconds, "{}", text);
            prop_assert_eq!(stamp.after(seconds), f64::from(nano) / 1e9);
        }
    }

    #[test]
    fn no_text_panics(bytes: Vec<u8>, near in "[0-9TZ:.,+/ -]{0,30}") {
        for text in [bytes.as_slice(), near.as_bytes()] {
            let _ = detect(text);
            for order in [Order::YearFirst, Order::DayFirst, Order::MonthFirst] {
                let _ = parse(text, Shape::DateTime(order)).map(|s| s.after(0));
                let _ = parse(text, Shape::Date(order));
            }
        }
    }
}
