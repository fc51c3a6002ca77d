//! Arithmetic of intervals: the ends of a result for any values between the ends of its operands. An end may be infinite.

/// All values from `low` to `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends {
    pub low: f64,
    pub high: f64,
}

impl Ends {
    /// Every value.
    pub const ALL: Ends = Ends { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// One value.
    pub fn exactly(value: f64) -> Ends {
        Ends { low: value, high: value }
    }

    /// The smallest interval with all of these values; a product of 0 and infinity is 0.
    fn around(values: &[f64]) -> Ends {
        let finite = values.iter().map(|v| if v.is_nan() { 0.0 } else { *v });
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        Ends { low, high }
    }

    pub fn negative(self) -> Ends {
        Ends { low: -self.high, high: -self.low }
    }

    pub fn plus(self, other: Ends) -> Ends {
        Ends { low: self.low + other.low, high: self.high + other.high }
    }

    pub fn minus(self, other: Ends) -> Ends {
        self.plus(other.negative())
    }

    pub fn times(self, other: Ends) -> Ends {
        Ends::around(&[
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ])
    }

    /// The reciprocal; unbounded where 0 lies within.
    fn inverse(self) -> Ends {
        if self.low > 0.0 || self.high < 0.0 {
            Ends { low: 1.0 / self.high, high: 1.0 / self.low }
        } else if self.low == 0.0 && self.high > 0.0 {
            Ends { low: 1.0 / self.high, high: f64::INFINITY }
        } else if self.high == 0.0 && self.low < 0.0 {
            Ends { low: f64::NEG_INFINITY, high: 1.0 / self.low }
        } else {
            Ends::ALL
        }
    }

    pub fn over(self, other: Ends) -> Ends {
        self.times(other.inverse())
    }

    pub fn magnitude(self) -> Ends {
        let (a, b) = (self.low.abs(), self.high.abs());
        let crosses = self.low < 0.0 && self.high > 0.0;
        Ends { low: if crosses { 0.0 } else { a.min(b) }, high: a.max(b) }
    }

    /// A power. Of values below 0, only whole ones are real; the rest of the interval counts.
    pub fn power(self, exponent: f64) -> Ends {
        if exponent < 0.0 {
            return self.power(-exponent).inverse();
        }
        if exponent == 0.0 {
            return Ends::exactly(1.0);
        }
        let raised = |ends: Ends| Ends { low: ends.low.powf(exponent), high: ends.high.powf(exponent) };
        if exponent.fract() != 0.0 {
            if self.high < 0.0 {
                return Ends::ALL;
            }
            return raised(Ends { low: self.low.max(0.0), high: self.high });
        }
        if exponent % 2.0 == 0.0 { raised(self.magnitude()) } else { raised(self) }
    }

    pub fn largest(all: &[Ends]) -> Ends {
        all.iter()
            .copied()
            .reduce(|a, b| Ends { low: a.low.max(b.low), high: a.high.max(b.high) })
            .unwrap_or(Ends::ALL)
    }

    pub fn smallest(all: &[Ends]) -> Ends {
        let negative: Vec<Ends> = all.iter().map(|e| e.negative()).collect();
        Ends::largest(&negative).negative()
    }

    pub fn sum(all: &[Ends]) -> Ends {
        all.iter().copied().fold(Ends::exactly(0.0), Ends::plus)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn ends(low: f64, high: f64) -> Ends {
        Ends { low, high }
    }

    /// The ends of a function over a grid of its operands.
    fn searched(a: Ends, b: Ends, f: impl Fn(f64, f64) -> f64) -> Ends {
        let grid = |e: Ends| (0..=200).map(move |i| e.low + (e.high - e.low) * f64::from(i) / 200.0);
        let values: Vec<f64> =
            grid(a).flat_map(|x| grid(b).map(move |y| (x, y))).map(|(x, y)| f(x, y)).collect();
        Ends::around(&values)
    }

    #[test]
    fn ends_are_those_of_all_values_between() {
        let of = [ends(1.0, 3.0), ends(-2.0, 5.0), ends(-4.0, -0.5), ends(0.0, 2.0)];
        for a in of {
            for b in of {
                let near = |made: Ends, found: Ends, what: &str| {
                    let apart = (made.low - found.low).abs() + (made.high - found.high).abs();
                    assert!(apart < 1e-9, "{what} {a:?} {b:?}: {made:?} {found:?}");
                };
                near(a.plus(b), searched(a, b, |x, y| x + y), "+");
                near(a.minus(b), searched(a, b, |x, y| x - y), "-");
                near(a.times(b), searched(a, b, |x, y| x * y), "*");
                if b.low > 0.0 || b.high < 0.0 {
                    near(a.over(b), searched(a, b, |x, y| x / y), "/");
                }
                near(Ends::largest(&[a, b]), searched(a, b, f64::max), "max");
                near(Ends::smallest(&[a, b]), searched(a, b, f64::min), "min");
            }
            let alone = |f: fn(f64) -> f64| searched(a, Ends::exactly(0.0), |x, _| f(x));
            // The grid of −2 … 5 does not hold 0: within a step of it.
            assert!((a.power(2.0).low - alone(|x| x * x).low).abs() < 1e-3);
            assert_eq!(a.power(2.0).high, alone(|x| x * x).high);
            assert_eq!(a.power(3.0).low, a.low.powi(3));
        }
    }

    #[test]
    fn unknown_operands_leave_what_is_certain() {
        let at_least_0 = ends(0.0, f64::INFINITY);
        assert_eq!(Ends::largest(&[ends(3.0, 4.0), at_least_0]), ends(3.0, f64::INFINITY));
        assert_eq!(Ends::smallest(&[ends(3.0, 4.0), at_least_0]), ends(0.0, 4.0));
        assert_eq!(ends(0.0, 0.0).times(at_least_0), ends(0.0, 0.0));
        assert_eq!(ends(1.0, 2.0).over(ends(0.0, 4.0)), ends(0.25, f64::INFINITY));
        assert_eq!(ends(1.0, 1.0).over(ends(-1.0, 1.0)), Ends::ALL);
        assert_eq!(Ends::ALL.power(2.0), at_least_0);
        assert_eq!(ends(-4.0, 9.0).power(0.5), ends(0.0, 3.0));
        assert_eq!(ends(-4.0, -1.0).power(0.5), Ends::ALL);
    }
}
