//! What is done to the samples: one function a corruption, the same bytes on every machine.

use super::recording::{Chance, RATE, Recording, TEMPERATURE, TIME, plain};
use std::io::Write;

const DEG: f64 = std::f64::consts::PI / 180.0;

/// A recording of another unit: the sample after this one.
fn other(sample: &str) -> Recording {
    Recording::sample(match sample {
        "pass" => "fail",
        "fail" => "pass",
        "indeterminate" => "faults",
        _ => "indeterminate",
    })
}

fn scaled(r: Recording, factor: f64) -> Vec<u8> {
    r.map(RATE, |_, v| v * factor).bytes()
}

/// Rows put in again behind themselves.
fn doubled(mut r: Recording, length: usize) -> Recording {
    let at = r.middle();
    let block: Vec<Vec<String>> = r.rows[at - length..at].to_vec();
    r.rows.splice(at..at, block);
    r
}

fn without(mut r: Recording, keep: impl Fn(usize) -> bool) -> Recording {
    let mut i = 0;
    r.rows.retain(|_| {
        i += 1;
        keep(i - 1)
    });
    r
}

/// The recording with each row replaced by several.
fn upsampled(mut r: Recording, times: usize, straight: bool) -> Vec<u8> {
    let step = r.interval_s / times as f64;
    let mut rows = Vec::with_capacity(times * r.rows.len());
    for i in 0..r.rows.len() - 1 {
        let (a, b) = (r.number(i, RATE), r.number(i + 1, RATE));
        for k in 0..times {
            let share = if straight { k as f64 / times as f64 } else { 0.0 };
            let time = plain((i * times + k) as f64 * step);
            let rate = if a.is_finite() && b.is_finite() {
                plain(a + (b - a) * share)
            } else {
                r.rows[i][RATE].clone()
            };
            rows.push(vec![time, rate, r.rows[i][TEMPERATURE].clone()]);
        }
    }
    r.rows = rows;
    r.bytes()
}

fn packed(r: &Recording) -> Vec<u8> {
    let mut e = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    e.write_all(&r.bytes()).unwrap();
    e.finish().unwrap()
}

/// A decimal comma for the point.
fn comma(text: &str) -> String {
    text.replace('.', ",")
}

/// The bytes of the sample `name` with the corruption `what`.
#[allow(clippy::too_many_lines, reason = "one list of cases or data")]
pub fn corrupt(what: &str, name: &str) -> Vec<u8> {
    let mut r = Recording::sample(name);
    let mut chance = Chance::new(0x5a61_67e1);
    let n = r.rows.len();
    match what {
        "rate_in_deg_s" => scaled(r, 1.0 / 3600.0),
        "rate_in_rad_s" => scaled(r, DEG / 3600.0),
        "rate_in_mrad_s" => scaled(r, 1e3 * DEG / 3600.0),
        "rate_in_urad_s" => scaled(r, 1e6 * DEG / 3600.0),
        "rate_in_deg_min" => scaled(r, 1.0 / 60.0),
        "rate_in_rad_h" => scaled(r, DEG),
        "rate_in_mdeg_h" => scaled(r, 1e3),
        "rate_in_mdeg_s" => scaled(r, 1e3 / 3600.0),
        "rate_in_arcmin_h" => scaled(r, 60.0),
        "rate_in_arcsec_h" => scaled(r, 3600.0),
        "rate_in_arcsec_s" => scaled(r, 1.0),
        "rate_converted_from_rad_s_twice" => scaled(r, 3600.0 / DEG),
        "sign_flipped" => scaled(r, -1.0),
        "earth_rate_taken_out" => r.map(RATE, |_, v| v - 12.4674).bytes(),
        "axis_north" => r.map(RATE, |_, v| v - 12.4674 + 8.4145).bytes(),
        "rate_and_temperature_exchanged" => {
            r.rows.iter_mut().for_each(|row| row.swap(RATE, TEMPERATURE));
            r.bytes()
        }
        "rate_and_temperature_exchanged_with_header" => {
            r.rows.iter_mut().for_each(|row| row.swap(RATE, TEMPERATURE));
            r.header = "time_s,temp_degC,rate_deg_h".into();
            r.bytes()
        }
        "time_and_rate_exchanged" => {
            r.rows.iter_mut().for_each(|row| row.swap(TIME, RATE));
            r.bytes()
        }
        "hour_dropped" | "hour_dropped_stamps_anew" => {
            let hour = r.hours(5.0, 6.0);
            let r = without(r, |i| !hour.contains(&i));
            if what == "hour_dropped" { r.bytes() } else { r.stamped_anew().bytes() }
        }
        "block_of_50_doubled" => doubled(r, 50).bytes(),
        "block_of_50_doubled_stamps_anew" => doubled(r, 50).stamped_anew().bytes(),
        "block_of_2000_doubled" => doubled(r, 2000).bytes(),
        "block_of_2000_doubled_stamps_anew" => doubled(r, 2000).stamped_anew().bytes(),
        "file_appended_to_itself_stamps_anew" => {
            let again = r.rows.clone();
            r.rows.extend(again);
            r.stamped_anew().bytes()
        }
        "every_row_twice" => {
            r.rows = r.rows.iter().flat_map(|row| [row.clone(), row.clone()]).collect();
            r.bytes()
        }
        "clock_ahead_5_h" => {
            let at = r.middle();
            r.map(TIME, |i, t| if i >= at { t + 18_000.0 } else { t }).bytes()
        }
        "clock_ahead_60_years" => {
            let at = r.middle();
            r.map(TIME, |i, t| if i >= at { t + 1.9e9 } else { t }).bytes()
        }
        "clock_back_2_h" => {
            let at = r.middle();
            r.map(TIME, |i, t| if i >= at { t - 7200.0 } else { t }).bytes()
        }
        "clock_in_ms" => r.map(TIME, |_, t| t * 1e3).bytes(),
        "clock_in_us" => r.map(TIME, |_, t| t * 1e6).bytes(),
        "clock_in_thousands_of_s" => r.map(TIME, |_, t| t * 1e-3).bytes(),
        "clock_4_percent_slow" => r.map(TIME, |_, t| t * 1.04).bytes(),
        "constant_added_to_stamps" => r.map(TIME, |_, t| t + 1.7e9).bytes(),
        "stamps_rounded_to_100_s" => r.map(TIME, |_, t| (t / 100.0).floor() * 100.0).bytes(),
        "stamps_jittered" => {
            let shift: Vec<f64> = (0..n).map(|_| chance.uniform() - 0.5).collect();
            let interval = r.interval_s;
            r.map(TIME, |i, t| t + 0.1 * interval * shift[i]).bytes()
        }
        "clipped" => r.map(RATE, |_, v| v.clamp(12.45, 12.62)).bytes(),
        "clipped_above" => r.map(RATE, |_, v| v.min(12.6)).bytes(),
        "stuck_for_200" => {
            let held = r.rows[n / 3][RATE].clone();
            r.map_text(RATE, |i, f| if (n / 3..n / 3 + 200).contains(&i) { held.clone() } else { f.into() })
                .bytes()
        }
        "stuck_for_all" => r.map_text(RATE, |_, _| "12.54321".into()).bytes(),
        "thermometer_stuck" => r.map_text(TEMPERATURE, |_, _| "20.012".into()).bytes(),
        "temperature_in_degF" => r.map(TEMPERATURE, |_, v| v * 1.8 + 32.0).bytes(),
        "temperature_in_K" => r.map(TEMPERATURE, |_, v| v + 273.15).bytes(),
        "temperature_1_degC_too_high" => r.map(TEMPERATURE, |_, v| v + 1.0).bytes(),
        "decimal_point_lost_in_10_rows" => {
            r.map_text(RATE, |i, f| if i % (n / 10) == 77 { f.replace('.', "") } else { f.into() }).bytes()
        }
        "decimal_point_lost_in_1_percent" => {
            let lost = chance.picks(n, 0.01);
            r.map_text(RATE, |i, f| if lost[i] { f.replace('.', "") } else { f.into() }).bytes()
        }
        "decimal_point_lost_in_all" => r.map_text(RATE, |_, f| f.replace('.', "")).bytes(),
        "decimal_comma_in_some_rows" => {
            r.map_text(RATE, |i, f| if i % 1000 == 500 { comma(f) } else { f.into() }).bytes()
        }
        "thousands_separators" => {
            let group = |f: &str| {
                if f.len() > 3 {
                    format!("\"{},{}\"", &f[..f.len() - 3], &f[f.len() - 3..])
                } else {
                    f.into()
                }
            };
            r.map_text(TIME, |_, f| group(f)).bytes()
        }
        "half_a_file" => {
            let text = r.text();
            let half = text.len() / 2;
            let line = half + text[half..].find('\n').unwrap() + 1;
            // Cut inside the rate of the next line.
            let cut = line + text[line..].find('.').unwrap() + 2;
            text[..cut].into()
        }
        "unfinished_last_line" => {
            let text = r.text();
            text[..text.rfind(',').unwrap() - 3].into()
        }
        "no_newline_at_the_end" => r.text().trim_end().into(),
        "second_header" => {
            let (at, header) = (r.middle(), r.header.clone());
            r.rows.insert(at, header.split(',').map(str::to_owned).collect());
            r.bytes()
        }
        "another_units_file" => {
            let mut r = other(name);
            r.comments = vec!["# serial: SN-0002".into()];
            r.bytes()
        }
        "serial_line_missing" => {
            r.comments.clear();
            r.bytes()
        }
        "another_recording_appended" => {
            r.rows.extend(other(name).rows);
            r.bytes()
        }
        "another_recording_appended_stamps_anew" => {
            r.rows.extend(other(name).rows);
            r.stamped_anew().bytes()
        }
        "rows_shuffled" => {
            chance.shuffle(&mut r.rows);
            r.bytes()
        }
        "rows_reversed" => {
            r.rows.reverse();
            r.bytes()
        }
        "every_third_row_lost" => without(r, |i| i % 3 != 2).bytes(),
        "1_percent_of_rows_lost" => {
            let lost = chance.picks(n, 0.01);
            without(r, |i| !lost[i]).bytes()
        }
        "5_percent_nan" => {
            let lost = chance.picks(n, 0.05);
            r.map_text(RATE, |i, f| if lost[i] { "NaN".into() } else { f.into() }).bytes()
        }
        "20_spikes" => r.map(RATE, |i, v| if i % (n / 20) == 99 { v + 5.0 } else { v }).bytes(),
        "half_a_percent_spikes" => {
            let hit = chance.picks(n, 0.005);
            r.map(RATE, |i, v| if hit[i] { v - 4.0 } else { v }).bytes()
        }
        "fields_swapped_in_1_percent" => {
            let hit = chance.picks(n, 0.01);
            r.rows
                .iter_mut()
                .zip(hit)
                .filter(|(_, hit)| *hit)
                .for_each(|(row, _)| row.swap(RATE, TEMPERATURE));
            r.bytes()
        }
        "quantised_to_0.1" => r.map(RATE, |_, v| (v * 10.0).round() / 10.0).bytes(),
        "averaged_by_10" => {
            let values: Vec<f64> = (0..n).map(|i| r.number(i, RATE)).collect();
            let mean = |i: usize| {
                let span: Vec<f64> =
                    values[i.saturating_sub(9)..=i].iter().copied().filter(|v| v.is_finite()).collect();
                span.iter().sum::<f64>() / span.len() as f64
            };
            r.map(RATE, |i, _| mean(i)).bytes()
        }
        "upsampled_by_repetition" => upsampled(r, 4, false),
        "upsampled_by_interpolation" => upsampled(r, 4, true),
        "bias_step" => {
            let at = r.middle();
            r.map(RATE, |i, v| if i >= at { v + 1.0 } else { v }).bytes()
        }
        "warm_up_cut_off" | "warm_up_cut_off_stamps_anew" => {
            let start = r.hours(0.5, 0.5).start;
            let r = without(r, |i| i >= start);
            if what == "warm_up_cut_off" { r.bytes() } else { r.stamped_anew().bytes() }
        }
        "long_warm_up" => {
            let interval = r.interval_s;
            r.map(RATE, |i, v| v + 2.0 * (-(i as f64) * interval / 3600.0).exp()).bytes()
        }
        "crlf" => r.text_with(",", "\r\n").into(),
        "bom" => [b"\xef\xbb\xbf".to_vec(), r.bytes()].concat(),
        "semicolons_and_decimal_commas" => {
            r.rows.iter_mut().flatten().for_each(|f| *f = comma(f));
            r.text_with(";", "\n").into()
        }
        "tabs" => r.text_with("\t", "\n").into(),
        "utf16" => [0xfeff].into_iter().chain(r.text().encode_utf16()).flat_map(u16::to_le_bytes).collect(),
        "gzip" => packed(&r),
        "trailing_garbage" => [r.bytes(), b"*** end of transfer ***\n".to_vec()].concat(),
        "trailing_nul_bytes" => [r.bytes(), vec![0; 512]].concat(),
        "rate_column_empty" => r.map_text(RATE, |_, _| String::new()).bytes(),
        "temperature_column_empty" => r.map_text(TEMPERATURE, |_, _| String::new()).bytes(),
        "empty_column_added" => {
            r.header += ",remark";
            r.rows.iter_mut().for_each(|row| row.push(String::new()));
            r.bytes()
        }
        "header_says_deg_s" | "header_says_deg_s_column_by_position" => {
            r.header = "time_s,rate_deg_s,temp_degC".into();
            r.bytes()
        }
        _ => panic!("no corruption `{what}`"),
    }
}
