//! Checks of the published tables: what follows from a row, and what does not.
//!
//! A printed number follows when some values that round to the printed ones give one that rounds to it. Against N a
//! printed σ has its sampling error as well: that of the least record length the paper names.

use super::published::{Checked, CheckedRow, NullRow, Printed, Range, Row2, Tables};
use crate::estimate::chi_square_quantile;
use crate::i18n::{Arg, Note, note};
use crate::noise::data::NoiseType;
use crate::noise::model::{TERMS, unit_allan_variance};
use crate::noise::russian::{angle_random_walk_from_10s, null_minimum};

/// σ10/σ100 of white noise.
const WHITE_NOISE_RATIO: f64 = 3.162_277_660_168_379_5;

/// A row in numbers.
struct Row {
    sigma100: Printed,
    bias: Printed,
    bias_inverse: Printed,
    bias_ratio: Printed,
    arw: Printed,
    n: Printed,
    arw_inverse: Printed,
    arw_ratio: Printed,
}

impl Row {
    fn of(r: &Row2) -> Option<Row> {
        Some(Row {
            sigma100: Printed::of(&r.sigma100)?,
            bias: Printed::of(&r.bias_instability)?,
            bias_inverse: Printed::of(&r.bias_inverse)?,
            bias_ratio: Printed::of(&r.bias_ratio)?,
            arw: Printed::of(&r.arw_russian)?,
            n: Printed::of(&r.n)?,
            arw_inverse: Printed::of(&r.arw_inverse)?,
            arw_ratio: Printed::of(&r.arw_ratio)?,
        })
    }
}

/// The quotients of all values that round to two printed ones.
fn quotients(above: Printed, below: Printed) -> Range {
    let (above, below) = (above.range(), below.range());
    Range { low: above.low / below.high, high: above.high / below.low }
}

/// The 95 % range of an observed standard deviation over its expectation, for n − 1 degrees of freedom.
fn sampling(windows: f64) -> Range {
    let dof = windows - 1.0;
    let at = |p| (chi_square_quantile(p, dof) / dof).sqrt();
    Range { low: at(0.025), high: at(0.975) }
}

/// The tables as data.
const PUBLISHED_TABLES: &str = include_str!("published.toml");

/// Checks the published tables; `None` only if the tables in the program cannot be read, which a test excludes.
pub fn checked() -> Option<Checked> {
    let tables: Tables = toml::from_str(PUBLISHED_TABLES).ok()?;
    check(&tables)
}

fn check(tables: &Tables) -> Option<Checked> {
    let rows = tables.table2.iter().map(|r| row(r, tables)).collect::<Option<Vec<CheckedRow>>>()?;
    let length_s = 3600.0 * tables.least_record_h;
    let null = [10.0, 8.0, 5.0, 3.0, 2.0]
        .into_iter()
        .filter_map(|span| {
            let null = null_minimum(1.0, length_s, length_s / span, 100.0)?;
            Some(NullRow { length_over_tau_max: span, ratio: null.ratio })
        })
        .collect::<Vec<NullRow>>();
    let remarks = remarks(tables, &rows, &null);
    Some(Checked {
        source: tables.source.clone(),
        least_record_h: tables.least_record_h,
        table1: tables.table1.clone(),
        rows,
        null,
        remarks,
    })
}

/// Remarks on a row, and whether one of them says that something does not follow.
#[derive(Default)]
struct Remarks {
    notes: Vec<Note>,
    flagged: bool,
}

impl Remarks {
    fn flag(&mut self, note: Note) {
        self.flagged = true;
        self.notes.push(note);
    }
}

/// A factor of which three digits are stated.
fn factor(v: f64) -> Arg {
    Arg::figures(v, 3)
}

fn row(printed: &Row2, tables: &Tables) -> Option<CheckedRow> {
    let r = Row::of(printed)?;
    let before = tables.table1.iter().find(|t| t.device == printed.in_table1);
    let n_table1 = before.and_then(|t| Printed::of(&t.n));
    let b_table1 = before.and_then(|t| Printed::of(&t.bias_instability));
    let mut remarks = Remarks::default();
    ratios(&r, &mut remarks);
    against_table1(&r, n_table1, b_table1, &mut remarks);
    let steep = against_white_noise(&r, tables, &mut remarks);
    let six_n = 6.0 * r.n.value;
    Some(CheckedRow {
        device: printed.device.clone(),
        printed: printed.clone(),
        sigma100: r.sigma100.value,
        bias_instability: r.bias.value,
        ratio_printed: r.bias_ratio.value,
        ratio: r.sigma100.value / r.bias.value,
        arw_russian: r.arw.value,
        n: r.n.value,
        n_table1: n_table1.map(|p| p.value),
        arw_ratio_printed: r.arw_ratio.value,
        arw_ratio: r.arw.value / r.n.value,
        six_n,
        over_six_n: r.sigma100.value / six_n,
        crossover_h: (r.n.value / r.bias.value).powi(2),
        sigma10_over_sigma100: steep,
        remarks: remarks.notes,
        flagged: remarks.flagged,
    })
}

/// Whether the printed ratios follow from what they are the ratios of.
fn ratios(r: &Row, remarks: &mut Remarks) {
    let mut check = |key, above: Printed, below: Printed, ratio: Printed, inverse: Printed| {
        let follows = quotients(above, below).overlaps(ratio.range())
            && quotients(below, above).overlaps(inverse.range());
        if !follows {
            let note = Note::new(key).with("printed", Arg::Stated(ratio.value));
            remarks.flag(note.with("computed", factor(above.value / below.value)));
        }
    };
    check("compare.published.bias_ratio_wrong", r.sigma100, r.bias, r.bias_ratio, r.bias_inverse);
    check("compare.published.arw_ratio_wrong", r.arw, r.n, r.arw_ratio, r.arw_inverse);
}

/// Whether N and B are those of the same device in Table 1.
fn against_table1(r: &Row, n: Option<Printed>, b: Option<Printed>, remarks: &mut Remarks) {
    if let Some(first) = n.filter(|first| first.value != r.n.value) {
        let note = |key: &'static str| {
            Note::new(key)
                .with("first", Arg::Stated(first.value))
                .with("second", Arg::Stated(r.n.value))
                .with("factor", factor((first.value / r.n.value).max(r.n.value / first.value)))
        };
        if first.range().overlaps(r.n.range()) {
            remarks.notes.push(note("compare.published.n_differs_by_rounding"));
        } else {
            remarks.flag(note("compare.published.n_differs"));
        }
    }
    if let Some(first) = b.filter(|first| first.value != r.bias.value) {
        let note = note!(
            "compare.published.b_differs",
            first = Arg::Stated(first.value),
            second = Arg::Stated(r.bias.value)
        );
        remarks.flag(note);
    }
}

/// Whether σ over 100 s, and its fall from 10 s, are those of N alone; gives σ10/σ100.
fn against_white_noise(r: &Row, tables: &Tables, remarks: &mut Remarks) -> f64 {
    let sampling = sampling(36.0 * tables.least_record_h);
    let six_n = 6.0 * r.n.value;
    let over = quotients(r.sigma100, Printed { value: six_n, half: 6.0 * r.n.half });
    let note = |key: &'static str| {
        Note::new(key).with("ratio", factor(r.sigma100.value / six_n)).with("six_n", six_n)
    };
    if over.high < sampling.low {
        remarks.flag(note("compare.published.below_six_n"));
    } else if over.low > sampling.high {
        remarks.flag(note("compare.published.above_six_n"));
    } else {
        remarks.notes.push(note("compare.published.is_six_n"));
    }
    // σ10 as the paper's own formula gives it back.
    let per_arw = 1.0 / angle_random_walk_from_10s(1.0);
    let steep = per_arw * r.arw.value / r.sigma100.value;
    let sigma10 = Printed { value: per_arw * r.arw.value, half: per_arw * r.arw.half };
    if quotients(sigma10, r.sigma100).low > WHITE_NOISE_RATIO / sampling.low {
        let note = note!("compare.published.excess_at_10_s");
        remarks.flag(note.with("ratio", factor(steep)).with("white", factor(WHITE_NOISE_RATIO)));
    }
    steep
}

/// Slope of the Allan deviation of a term in decades per decade.
fn slope(term: NoiseType) -> f64 {
    0.5 * (unit_allan_variance(term, 1000.0) / unit_allan_variance(term, 100.0)).log10()
}

fn remarks(tables: &Tables, rows: &[CheckedRow], null: &[NullRow]) -> Vec<Note> {
    let mut out = vec![];
    let called = tables.slope_called_rate_ramp;
    if let Some(term) = TERMS.into_iter().find(|t| (slope(*t) - called).abs() < 1e-9)
        && term != NoiseType::RateRamp
    {
        let note = note!(
            "compare.published.slope_name",
            called = Arg::Stated(called),
            term = Arg::Key(super::part_key(term.id()).into()),
            ramp = Arg::Stated(slope(NoiseType::RateRamp))
        );
        out.push(note);
    }
    out.push(note!(
        "compare.published.no_correlation_time",
        seconds = Arg::Stated(tables.flicker_correlation_time_s)
    ));
    // The formula gives N back only at the bandwidth of the averaging: σ of white noise over 10 s is 60 N/√10.
    let bandwidth = (60.0 * angle_random_walk_from_10s(1.0)).powi(-2);
    out.push(note!("compare.published.bandwidth", hz = Arg::rounded(bandwidth, 3)));
    out.push(note!("compare.published.inverse_first"));
    let range = |of: fn(&CheckedRow) -> f64| {
        let fold = |f: fn(f64, f64) -> f64, from: f64| rows.iter().map(of).fold(from, f);
        (Arg::figures(fold(f64::min, f64::INFINITY), 3), Arg::figures(fold(f64::max, 0.0), 3))
    };
    let ((b0, b1), (a0, a1)) = (range(|r| r.ratio), range(|r| r.arw_ratio));
    out.push(note!(
        "compare.published.order_of_magnitude",
        bias_low = b0,
        bias_high = b1,
        arw_low = a0,
        arw_high = a1
    ));
    if let (Some(first), Some(last)) = (null.first(), null.last())
        && rows.iter().all(|r| (first.ratio[1]..=last.ratio[1]).contains(&r.ratio_printed))
    {
        out.push(note!(
            "compare.published.null",
            hours = Arg::Stated(tables.least_record_h),
            low = Arg::figures(first.ratio[1], 2),
            high = Arg::figures(last.ratio[1], 2),
            low_part = Arg::Stated(first.length_over_tau_max),
            high_part = Arg::Stated(last.length_over_tau_max)
        ));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};

    fn ids(notes: &[Note]) -> Vec<&str> {
        notes.iter().map(|n| n.id.rsplit('.').next().unwrap()).collect()
    }

    /// Recomputed by hand from the printed table: device, σ100/BI, ARW/N, 6N, σ100/6N, cross-over in h, σ10/σ100.
    const EXPECTED: [(&str, f64, f64, f64, f64, f64, f64); 5] = [
        ("OIUS-200", 8.00, 1.14, 0.0486, 0.99, 1.8, 3.6),
        ("TIUS-500, BChE-500", 12.80, 1.47, 0.0408, 0.78, 7.4, 5.9),
        ("OIUS-501, BChE-501", 12.73, 2.83, 0.0138, 1.01, 4.4, 8.8),
        ("OIUS-1000", 5.00, 1.45, 0.0033, 0.91, 0.84, 5.1),
        ("OIUS-2000", 6.25, 1.12, 0.0015, 1.00, 1.1, 3.5),
    ];

    #[test]
    fn every_number_of_table_2_is_reproduced() {
        let checked = checked().unwrap();
        assert_eq!((checked.table1.len(), checked.rows.len()), (15, 5));
        for (row, (device, ratio, arw, six_n, over, crossover, steep)) in checked.rows.iter().zip(EXPECTED) {
            assert_eq!(row.device, device);
            assert!((row.ratio - ratio).abs() < 0.005, "{device} {}", row.ratio);
            assert!((row.arw_ratio - arw).abs() < 0.006, "{device} {}", row.arw_ratio);
            assert!((row.six_n - six_n).abs() < 5e-5, "{device} {}", row.six_n);
            assert!((row.over_six_n - over).abs() < 0.006, "{device} {}", row.over_six_n);
            assert!((row.crossover_h / crossover - 1.0).abs() < 0.1, "{device} {}", row.crossover_h);
            assert!(
                (row.sigma10_over_sigma100 - steep).abs() < 0.06,
                "{device} {}",
                row.sigma10_over_sigma100
            );
        }
    }

    #[test]
    fn what_does_not_follow_is_flagged_and_nothing_else() {
        let checked = checked().unwrap();
        let remarks: Vec<(&str, Vec<&str>)> =
            checked.rows.iter().map(|r| (r.device.as_str(), ids(&r.remarks))).collect();
        // OIUS-200 is no OIUS-2000; of a row with two names the first counts.
        let first = |d: &str| d.split(',').next().unwrap_or_default().to_owned();
        let has = |device: &str, id: &str| {
            remarks.iter().any(|(d, list)| first(d) == first(device) && list.contains(&id))
        };
        for (device, _) in &remarks {
            let wrong = matches!(*device, "OIUS-1000" | "OIUS-2000");
            assert_eq!(has(device, "bias_ratio_wrong"), wrong, "{device}");
            assert!(!has(device, "arw_ratio_wrong"), "{device}");
            assert!(!has(device, "b_differs"), "{device}");
            assert_eq!(has(device, "below_six_n"), device.starts_with("TIUS-500"), "{device}");
            assert!(!has(device, "above_six_n"), "{device}");
        }
        for device in ["TIUS-500", "OIUS-501", "OIUS-1000"] {
            assert!(has(device, "excess_at_10_s"), "{device}");
        }
        assert!(!has("OIUS-2000", "excess_at_10_s"));
        for device in ["TIUS-500", "OIUS-1000", "OIUS-2000"] {
            assert!(has(device, "n_differs"), "{device}");
        }
        assert!(has("OIUS-200", "n_differs_by_rounding") && !has("OIUS-501", "n_differs"));
        let whole = ids(&checked.remarks);
        for id in
            ["slope_name", "no_correlation_time", "bandwidth", "inverse_first", "order_of_magnitude", "null"]
        {
            assert!(whole.contains(&id), "{id}");
        }
        let slope = checked.remarks.iter().find(|n| n.id.ends_with("slope_name")).unwrap();
        assert!(slope.say(Lang::En).contains("random walk"), "{slope:?}");
    }

    #[test]
    fn angle_random_walk_alone_gives_the_published_ratios_at_ten_hours() {
        // Simulated: 6.3, 7.0, 9.3, 13 and 24 at T/10, T/8, T/5, T/3 and T/2.
        let null = checked().unwrap().null;
        for (row, expected) in null.iter().zip([6.3, 7.0, 9.3, 13.0, 24.0]) {
            assert!((row.ratio[1] / expected - 1.0).abs() < 0.04, "{row:?}");
        }
    }

    #[test]
    fn printed_digits_say_how_far_a_number_was_rounded() {
        let p = Printed::of("0.0023").unwrap();
        assert!((p.half - 5e-5).abs() < 1e-18);
        assert_eq!(Printed::of("8").unwrap().half, 0.5);
        assert_eq!(Printed::of("many"), None);
    }
}
