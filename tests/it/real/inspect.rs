//! `sagnac inspect` on real recordings, where the folder named by SAGNAC_REAL_DATA holds them.

fn told(file: &str) -> Option<String> {
    let (name, inner) = file.split_once('/').unwrap();
    let path = crate::support::real::set(name)?.join(inner);
    let text =
        sagnac::acceptance::inspect::inspect(&path, None, sagnac::i18n::Lang::En, &mut |_, _| {}).unwrap();
    Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
}

#[track_caller]
fn says(text: &str, wanted: &[&str]) {
    for w in wanted {
        assert!(text.contains(w), "`{w}` is not in:\n{text}");
    }
}

#[test]
fn a_turned_fibre_optic_unit_shows_its_clock_error() {
    let Some(text) = told("fog_kvh1750_known_angle/direct_imu_rate.csv.gz") else { return };
    says(
        &text,
        &[
            "static test No: `delta_angle_x_deg` moved",
            "Not at rest: another axis of the unit was rotated.",
            "If it is mains hum (120 Hz), the sample clock is off by 3.9 %",
            "they are nominal",
            "`delta_angle_x_deg` covers 179.2 deg",
        ],
    );
    // The author measured 962.4 Hz.
    let rate: f64 =
        text.split("the true rate is ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((rate - 962.4).abs() < 1.0, "{rate}");
}

#[test]
fn the_same_unit_with_an_outer_clock_raises_no_remark() {
    let Some(text) = told("fog_kvh1750_known_angle/direct_ext_rate.csv.gz") else { return };
    assert!(!text.contains("sample clock is off"), "{text}");
}

#[test]
fn a_rate_table_set_supports_the_scale_factor() {
    let Some(text) = told("fog_fizoptika_rate_table_temp/segments.csv") else { return };
    says(
        &text,
        &[
            "rows are counted (516)",
            "`rate_table_deg_s` was held at 85 rates from -151.2 to 151.2 deg/s, both signs",
            "`gyro_raw_counts` looks like a gyro output in counts",
            "static test No: the table moves",
        ],
    );
}

#[test]
fn a_chamber_sweep_is_told_from_a_turn() {
    let Some(text) = told("mems_thermal_chamber_sweep/sweep_xy.csv.gz") else { return };
    says(
        &text,
        &["Not proven to be at rest", "temperature test Yes, for the bias: `temp_degC` spans 91.4 °C"],
    );
}

#[test]
fn no_column_of_text_and_no_other_instrument_fails() {
    let Some(text) = told("mems_ferraris_known_angle/session.csv.gz") else { return };
    says(&text, &["section text", "static test No"]);
    for file in ["phase_dat.csv", "ocxo_frequency.csv.gz", "tic53230a_phase.csv.gz"] {
        let text = told(&format!("ref_stable32_frequency_data/{file}")).unwrap();
        says(&text, &["No column was recognised as a gyro output", "tests None"]);
    }
}

#[test]
fn a_ring_laser_at_rest_shows_the_earth() {
    for file in ["x_up", "x_down"] {
        let Some(text) = told(&format!("rlg_ln100_two_position/{file}.parquet")) else { return };
        says(
            &text,
            &["Earth rate The mean vector of the three axes has a length of 1", "static test Partly"],
        );
    }
}
