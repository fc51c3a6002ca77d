//! Published oracles re-run on this machine: what a QA auditor files with the report.

use crate::estimate::{Spread, chi_square_quantile, normal_quantile};
use crate::i18n::{Lang, Localize, Note, decimal, note};
use crate::noise::allan::{AllanAccumulator, AllanPlan};
use crate::noise::data::NoiseType;
use crate::noise::family::Estimator;
use crate::noise::model::{NoiseModel, unit_allan_variance};
use crate::noise::static_bias::{Orientation, Uncertain, earth_rate};
use crate::noise::tau_grid::TauGrid;
use crate::noise::windows::edf_of_window_std;
use crate::units::Unit;

/// One oracle.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// The quantity that is computed.
    pub name: Note,
    /// Where the number was published.
    pub source: Note,
    /// Published value.
    pub published: f64,
    /// Value computed here.
    pub computed: f64,
    /// Largest relative difference allowed: half a unit in the last digit published, or as stated there.
    pub tolerance: f64,
}

impl Check {
    /// Relative difference.
    pub fn difference(&self) -> f64 {
        (self.computed / self.published - 1.0).abs()
    }

    /// True when the difference is within the tolerance.
    pub fn passed(&self) -> bool {
        self.difference() <= self.tolerance
    }
}

/// All oracles.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfTest {
    /// One by one.
    pub checks: Vec<Check>,
}

impl SelfTest {
    /// True when all passed.
    pub fn passed(&self) -> bool {
        self.checks.iter().all(Check::passed)
    }

    /// A table for the QA file, in a language.
    pub fn text(&self, lang: Lang) -> String {
        let words = |key: &'static str| Note::new(key).say(lang);
        let number = |ascii: String| decimal(&ascii, lang);
        let title = note!(
            "selftest.title",
            version = env!("CARGO_PKG_VERSION"),
            system = std::env::consts::OS,
            machine = std::env::consts::ARCH
        );
        let mut out = format!(
            "{}\n\n{:<52} {:>16} {:>20} {:>9} {:>9}  {}\n",
            title.say(lang),
            words("selftest.quantity"),
            words("selftest.published"),
            words("selftest.computed"),
            words("selftest.difference"),
            words("selftest.allowed"),
            words("selftest.source"),
        );
        for c in &self.checks {
            out.push_str(&format!(
                "{:<52} {:>16} {:>20} {:>9} {:>9}  {}{}\n",
                c.name.say(lang),
                number(c.published.to_string()),
                number(format!("{:.12}", c.computed)),
                number(format!("{:.1e}", c.difference())),
                number(format!("{:.1e}", c.tolerance)),
                c.source.say(lang),
                if c.passed() { String::new() } else { format!("  {}", words("selftest.differs")) }
            ));
        }
        let failed = self.checks.iter().filter(|c| !c.passed()).count();
        let sum = note!("selftest.sum", n = self.checks.len(), failed);
        out.push_str(&format!("\n{}\n", sum.say(lang)));
        out
    }
}

/// The nine values of NIST SP 1065 table 30.
const SP1065_VALUES: [f64; 9] = [892.0, 809.0, 823.0, 798.0, 671.0, 644.0, 883.0, 903.0, 677.0];

/// The 1000-point suite of NIST SP 1065 section 12.4.
fn thousand() -> Vec<f64> {
    let mut n: u64 = 1_234_567_890;
    (0..1000)
        .map(|_| {
            let value = n as f64 / 2_147_483_647.0;
            n = 16_807 * n % 2_147_483_647;
            value
        })
        .collect()
}

fn deviation(values: &[f64], m: u64, estimator: Estimator) -> f64 {
    let mut accumulator = AllanAccumulator::new(AllanPlan {
        tau0_s: 1.0,
        grid: TauGrid::List(vec![m as f64]),
        exact: true,
        estimators: vec![estimator],
    });
    accumulator.push(values, 0, false);
    let set = accumulator.finish();
    set.curve(estimator).and_then(|c| c.points.first()).map_or(f64::NAN, |p| p.deviation)
}

fn points(name: &'static str, n: u64, m: u64) -> Note {
    note!("selftest.points", name = Note::new(name), n, m)
}

/// Runs every oracle.
pub fn run() -> SelfTest {
    let mut checks = Vec::new();
    let mut add = |name: Note, source: &'static str, published: f64, computed: f64, tolerance: f64| {
        checks.push(Check { name, source: Note::new(source), published, computed, tolerance });
    };
    deviations(&mut add);
    noise(&mut add);
    decisions(&mut add);
    rates(&mut add);
    SelfTest { checks }
}

/// Takes a check: name, source, published value, computed value, tolerance.
type Add<'a> = &'a mut dyn FnMut(Note, &'static str, f64, f64, f64);

/// Deviations of the data sets of NIST SP 1065.
fn deviations(add: Add<'_>) {
    const SP1065_SOURCE: &str = "selftest.from.sp1065";
    let thousand = thousand();
    let family = [
        (Estimator::Allan, "selftest.allan", [91.22945, 85.95287], [2.922319e-1, 9.159953e-2, 3.241343e-2]),
        (
            Estimator::Modified,
            "selftest.modified",
            [91.22945, 74.78849],
            [2.922319e-1, 6.172376e-2, 2.170921e-2],
        ),
        (
            Estimator::Hadamard,
            "selftest.hadamard",
            [70.80607, 85.61487],
            [2.943883e-1, 9.581083e-2, 3.237638e-2],
        ),
        (Estimator::Total, "selftest.total", [91.22945, 93.90379], [2.922319e-1, 9.134743e-2, 3.406530e-2]),
    ];
    for (estimator, name, nine, suite) in family {
        for (m, value) in [1, 2].into_iter().zip(nine) {
            add(points(name, 9, m), SP1065_SOURCE, value, deviation(&SP1065_VALUES, m, estimator), 1e-7);
        }
        for (m, value) in [1, 10, 100].into_iter().zip(suite) {
            add(points(name, 1000, m), SP1065_SOURCE, value, deviation(&thousand, m, estimator), 3e-7);
        }
    }
}

/// Window means and the Allan floor of noise models.
fn noise(add: Add<'_>) {
    let white = NoiseModel { n: 1.0, ..NoiseModel::default() };
    for (n, published) in [(36, 11.4), (100, 18.3), (360, 29.5), (864, 38.8)] {
        let flicker = NoiseModel { b: 1.0, ..NoiseModel::default() };
        let edf = edf_of_window_std(n, 100.0, |t| flicker.mean_variance(t)).unwrap_or(f64::NAN);
        add(note!("selftest.degrees", n), "selftest.from.quadratic_form", published, edf, 5e-3);
    }
    let sigma_100 = white.mean_variance(100.0).sqrt();
    add(note!("selftest.sigma_100"), "selftest.from.closed_form", 6.0, sigma_100, 1e-12);
    let floor = unit_allan_variance(NoiseType::Flicker, 1.0).sqrt();
    add(note!("selftest.flicker_floor"), "selftest.from.ieee_952", 0.6642824703, floor, 1e-10);
}

/// Quantiles and guard bands.
fn decisions(add: Add<'_>) {
    let chi_square = chi_square_quantile(0.975, 10.0);
    add(note!("selftest.chi_square"), "selftest.from.sematech", 20.483, chi_square, 3e-5);
    add(note!("selftest.normal"), "selftest.from.iso_14253", 1.645, normal_quantile(0.95), 1e-4);
    let guard = Spread::Normal { standard_uncertainty: 1.0 }.bound(0.0, 0.95).unwrap_or(f64::NAN);
    add(note!("selftest.guard_band"), "selftest.from.iso_14253", 1.645, guard, 1e-4);
}

/// Earth rate and units of rate.
fn rates(add: Add<'_>) {
    let exact = |value| Uncertain { value, uncertainty: 0.0 };
    let vertical =
        Orientation { latitude_deg: exact(56.0), heading_deg: exact(0.0), elevation_deg: exact(90.0) };
    let north = Orientation { elevation_deg: exact(0.0), ..vertical };
    let upward = earth_rate(&vertical).value;
    add(note!("selftest.earth_vertical"), "selftest.from.geometry", 12.47, upward, 5e-4);
    add(note!("selftest.earth_north"), "selftest.from.geometry", 8.41, earth_rate(&north).value, 6e-4);
    let factor = |a: &str, b: &str| {
        Unit::parse(a).and_then(|a| Unit::parse(b).and_then(|b| a.factor_to(&b))).unwrap_or(f64::NAN)
    };
    let rad_s = factor("rad/s", "deg/h");
    add(note!("selftest.rad_s"), "selftest.from.definition", 206_264.806_247_096_36, rad_s, 1e-14);
    add(note!("selftest.arcsec_s"), "selftest.from.definition", 1.0, factor("arcsec/s", "deg/h"), 1e-15);
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_oracle_is_met() {
        let result = super::run();
        assert!(result.checks.len() > 30);
        assert!(result.passed(), "{}", result.text(crate::i18n::Lang::En));
    }
}
