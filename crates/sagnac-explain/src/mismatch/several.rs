//! Probability of the least of several p-values (Šidák 1967): 1 − (1 − p)ⁿ. Far out it is n p; near one it stays below one, so that
//! the p-value of a record without a mismatch is a number from 0 to 1 and not a heap at 1.

/// Probability that the least of `tests` independent p-values is as small as `p`.
pub fn least_of(p: f64, tests: f64) -> f64 {
    (-(tests.max(1.0) * (-p.clamp(0.0, 1.0)).ln_1p()).exp_m1()).clamp(0.0, 1.0)
}

/// Natural logarithm of [`least_of`], of a p-value that is given by its logarithm.
pub fn ln_least_of(ln_p: f64, tests: f64) -> f64 {
    /// ln p from which the two agree to nine digits, whatever the number of tests that a scan makes.
    const LN_FAR: f64 = -40.0;
    if ln_p < LN_FAR { ln_p + tests.max(1.0).ln() } else { least_of(ln_p.exp(), tests).ln().min(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_of_several_is_as_small_as_one_of_them_by_chance() {
        // 1 − 0.99³.
        assert!((least_of(0.01, 3.0) - 0.029_701).abs() < 1e-12);
        assert!((ln_least_of(0.01f64.ln(), 3.0).exp() - 0.029_701).abs() < 1e-12);
        // Far out, three times as probable.
        assert!((least_of(1e-20, 3.0) / 3e-20 - 1.0).abs() < 1e-9);
        assert!((ln_least_of(-50.0, 3.0) + 50.0 - 3f64.ln()).abs() < 1e-12);
        assert!((ln_least_of(-39.999, 1e6) - ln_least_of(-40.001, 1e6) - 0.002).abs() < 1e-9);
        // The median of the least of two is p = 1 − √½.
        assert!((least_of(1.0 - 0.5f64.sqrt(), 2.0) - 0.5).abs() < 1e-12);
        assert_eq!((least_of(1.0, 5.0), least_of(0.0, 5.0), ln_least_of(0.0, 5.0)), (1.0, 0.0, 0.0));
    }
}
