//! Recordings made in the test: white noise from a counter, the same on every machine.

/// White noise of unit variance: sample `i` of the sequence `seed`.
pub fn white(seed: u64, i: u64) -> f64 {
    let uniform = |k: u64| {
        // splitmix64 (Steele, Lea and Flood 2014).
        let mut z = seed
            .wrapping_mul(0xd134_2543_de82_ef95)
            .wrapping_add((12 * i + k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    };
    (0..12).map(uniform).sum::<f64>() - 6.0
}

/// The row of sample `i`: time, rate about 12.5 deg/h, temperature about 20 °C.
pub fn row(i: u64) -> String {
    format!("{i},{:.5},{:.3}", 12.5 + 0.1 * white(1, i), 20.0 + 0.01 * white(2, i))
}

/// Header of such recordings.
pub const HEADER: &str = "time_s,rate_deg_h,temp_degC";

/// A sound recording of `rows` samples at 1 Hz.
pub fn recording(rows: u64) -> String {
    with(rows, |_, row| row)
}

/// A recording of which every row passes through a hand that may change it; an empty text leaves the row out.
pub fn with(rows: u64, hand: impl Fn(u64, String) -> String) -> String {
    let mut text = format!("{HEADER}\n");
    for i in 0..rows {
        let row = hand(i, row(i));
        if !row.is_empty() {
            text.push_str(&row);
            text.push('\n');
        }
    }
    text
}
