//! Special functions: Hurwitz zeta at 3 and cosine integral for the closed forms of noise, normal numbers of χ² and F, Legendre
//! polynomials.

/// Euler's constant γ.
pub const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;

/// Hurwitz zeta function ζ(3, q) = Σ_{j≥0} (j + q)^−3 for q > 0; infinite at q ≤ 0.
///
/// Direct sum of the first terms, Euler-Maclaurin for the rest; relative error below 1e-14.
pub fn hurwitz_zeta_3(q: f64) -> f64 {
    if q <= 0.0 {
        return f64::INFINITY;
    }
    const DIRECT_TERMS: u32 = 16;
    let mut sum = 0.0;
    for j in (0..DIRECT_TERMS).rev() {
        sum += (q + f64::from(j)).powi(-3);
    }
    let a = q + f64::from(DIRECT_TERMS);
    let inverse2 = 1.0 / (a * a);
    // ∫ x^-3 from a, half the first term, then Bernoulli terms: s/12, s(s+1)(s+2)/720, s..(s+4)/30240, ...
    sum + inverse2
        * (0.5
            + 0.5 / a
            + inverse2 * (0.25 + inverse2 * (-1.0 / 12.0 + inverse2 * (1.0 / 12.0 - 0.15 * inverse2))))
}

/// Cosine integral Ci(x) = γ + ln x + ∫₀ˣ (cos t − 1)/t dt for x > 0; minus infinity at 0, NaN below.
///
/// Power series up to 4, beyond it the continued fraction of E₁(ix) by Lentz' method.
pub fn cosine_integral(x: f64) -> f64 {
    if x.is_nan() || x < 0.0 {
        return f64::NAN;
    }
    if x == 0.0 {
        return f64::NEG_INFINITY;
    }
    if x <= 4.0 {
        let (mut term, mut sum) = (1.0, 0.0);
        for n in 1..40 {
            let two_n = 2.0 * f64::from(n);
            term *= -x * x / (two_n * (two_n - 1.0));
            sum += term / two_n;
            if term.abs() < 1e-18 {
                break;
            }
        }
        return EULER_GAMMA + x.ln() + sum;
    }
    // E1(ix) = e^{-ix} · 1/(ix+1 − 1/(ix+3 − 4/(ix+5 − ...))), Ci(x) = −Re E1(ix).
    type C = (f64, f64);
    let multiply = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let invert = |a: C| {
        let n = a.0 * a.0 + a.1 * a.1;
        (a.0 / n, -a.1 / n)
    };
    let mut b: C = (1.0, x);
    let mut c: C = (1e300, 0.0);
    let mut d = invert(b);
    let mut h = d;
    for i in 1..500 {
        let a = -f64::from(i * i);
        b.0 += 2.0;
        d = invert((a * d.0 + b.0, a * d.1 + b.1));
        let inverse = invert(c);
        c = (b.0 + a * inverse.0, b.1 + a * inverse.1);
        let step = multiply(c, d);
        h = multiply(h, step);
        if (step.0 - 1.0).abs() + step.1.abs() < 1e-15 {
            break;
        }
    }
    -multiply(h, (x.cos(), -x.sin())).0
}

/// Standard normal number of a χ² of some degrees of freedom (Wilson and Hilferty 1931).
pub fn chi_square_normal(sum: f64, dof: f64) -> f64 {
    let a = 2.0 / (9.0 * dof);
    ((sum / dof).cbrt() - (1.0 - a)) / a.sqrt()
}

/// The standard normal number of a ratio of variances (Paulson 1942).
pub fn f_normal(ratio: f64, dof: f64, others: f64) -> f64 {
    let (a, b) = (2.0 / (9.0 * dof), 2.0 / (9.0 * others));
    let root = ratio.cbrt();
    ((1.0 - b) * root - (1.0 - a)) / (b * root * root + a).sqrt()
}

/// Legendre polynomial of an order from 1 on, for |x| ≤ 1, by the recurrence of three terms.
pub fn legendre(order: usize, x: f64) -> f64 {
    let (mut last, mut here) = (1.0, x);
    for k in 1..order {
        let k = k as f64;
        (last, here) = (here, ((2.0 * k + 1.0) * x * here - k * last) / (k + 1.0));
    }
    here
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_variances_become_normal_numbers() {
        // Upper 5 % and 1 % points of F(10, 20) and F(30, 60) (Pearson and Hartley, table 18).
        for (ratio, dof, others, z) in
            [(2.348, 10.0, 20.0, 1.6449), (3.368, 10.0, 20.0, 2.3263), (1.649, 30.0, 60.0, 1.6449)]
        {
            assert!(
                (f_normal(ratio, dof, others) - z).abs() < 0.01,
                "{ratio}: {}",
                f_normal(ratio, dof, others)
            );
        }
        // The ratio the other way round has the opposite number.
        assert!((f_normal(0.5, 12.0, 30.0) + f_normal(2.0, 30.0, 12.0)).abs() < 1e-12);
    }

    #[test]
    fn hurwitz_zeta_agrees_with_known_values() {
        // Apéry's constant, and ζ(3, 1/2) = 7 ζ(3).
        let apery = 1.202_056_903_159_594_3;
        assert!((hurwitz_zeta_3(1.0) / apery - 1.0).abs() < 1e-14);
        assert!((hurwitz_zeta_3(0.5) / (7.0 * apery) - 1.0).abs() < 1e-14);
        assert!((hurwitz_zeta_3(0.3) - 0.3_f64.powi(-3) - hurwitz_zeta_3(1.3)).abs() < 1e-12);
    }

    #[test]
    fn cosine_integral_agrees_with_tables() {
        // Abramowitz and Stegun, table 5.1: Ci(1), Ci(5), Ci(10).
        for (x, expected) in [(1.0, 0.337_403_922_9), (5.0, -0.190_029_749_7), (10.0, -0.045_456_433_0)] {
            assert!((cosine_integral(x) - expected).abs() < 1e-10, "Ci({x}) = {}", cosine_integral(x));
        }
        assert!((cosine_integral(4.0) - cosine_integral(4.0 + 1e-12)).abs() < 1e-11);
    }

    #[test]
    fn legendre_polynomials_are_those_of_the_tables() {
        // P₄(½) = −0.2890625, P₅(½) = 0.08984375 (Abramowitz and Stegun, table 8.1).
        assert!(
            (legendre(4, 0.5) + 0.289_062_5).abs() < 1e-12 && (legendre(5, 0.5) - 0.089_843_75).abs() < 1e-12
        );
        assert!((1..=6).all(|k| (legendre(k, 1.0) - 1.0).abs() < 1e-12));
    }
}
