//! Effects of recorded columns other than temperature.

use crate::laboratory::bench::Bench;
use crate::laboratory::effect::{Effect, Facts, Shape, range_of, spread_of};
use crate::laboratory::motion::Programme;
use crate::laboratory::unit::body::Pace;
use crate::laboratory::unit::curve::without_line;
use crate::laboratory::unit::response::Law;

/// Columns that may drive.
const DRIVERS: [&str; 5] = ["pressure_hPa", "field_uT", "humidity_pct", "rack_degC", "current_mA"];

/// A recorded driver among decoys, and perhaps a thermometer.
pub fn among_decoys(bench: &mut Bench) {
    if bench.dice.chance(0.4) {
        bench.warm(false, Pace::Quick);
    }
    let count = bench.dice.count(1, 3);
    bench.record("supply_v");
    let driver = *bench.dice.one_of(&DRIVERS);
    bench.record(driver);
    bench.record_others(count);
}

/// The driver that the scene recorded besides the supply: the first of the list that is there.
fn driver(bench: &mut Bench) -> (String, Vec<f64>) {
    let there: Vec<String> =
        DRIVERS.iter().filter(|d| bench.columns.contains_key(**d)).map(|d| (*d).to_owned()).collect();
    let name = bench.dice.one_of(&there).clone();
    let course = bench.surroundings[&name].clone();
    (name, course)
}

/// The response of a law to a course, of spread 1, and its coefficient per size.
fn followed(law: Law, course: &[f64], bench: &mut Bench) -> (Shape, f64) {
    let mut dice = bench.dice.fork();
    let sign = dice.sign();
    let mut response = law.respond(&mut dice, &bench.span, course);
    if matches!(law, Law::Curve | Law::Hysteresis) {
        response = without_line(&response, course);
    }
    // Slow quantities change by parts of their unit: sizes are of the same order for all.
    let scale = spread_of(&response).max(1e-12);
    let rows = bench.at_rows(&response);
    (Shape::Course(rows.iter().map(|r| sign * r / scale).collect()), sign / scale)
}

/// Bias that follows the supply.
pub fn supply(bench: &mut Bench) -> Effect {
    let course = bench.surroundings["supply_v"].clone();
    let (shape, per_size) = followed(Law::Linear, &course, bench);
    let mut effect = Effect::new("supply_sensitivity", shape, move |bench, size| {
        let [low, high] = range_of(&bench.columns["supply_v"]);
        Facts::default().at("supply", low, high).with("coefficient_deg_h_per_V", size * per_size)
    });
    effect.column = Some("supply_v".to_owned());
    effect
}

fn column(bench: &mut Bench, law: Law) -> Effect {
    let (name, course) = driver(bench);
    let (shape, per_size) = followed(law, &course, bench);
    let of = name.clone();
    let mut effect = Effect::new("column_driver", shape, move |bench, size| {
        let [low, high] = range_of(&bench.columns[&of]);
        let facts = Facts::default().at("driver", low, high).at("time", 0.0, bench.duration_s());
        match law {
            Law::Linear | Law::Rate => facts.with("coefficient", size * per_size),
            _ => facts,
        }
    });
    effect.column = Some(name);
    effect.law = Some(law.name());
    effect
}

/// Bias in proportion to a column.
pub fn column_linear(bench: &mut Bench) -> Effect {
    column(bench, Law::Linear).of("column_linear")
}

/// Bias in proportion to the change of a column.
pub fn column_rate(bench: &mut Bench) -> Effect {
    column(bench, Law::Rate).of("column_rate")
}

/// Bias that follows a column late.
pub fn column_lag(bench: &mut Bench) -> Effect {
    column(bench, Law::Lag).of("column_lag")
}

/// Bias that is a curve over a column.
pub fn column_curve(bench: &mut Bench) -> Effect {
    column(bench, Law::Curve).of("column_curve")
}

/// Bias with loops over a column.
pub fn column_hysteresis(bench: &mut Bench) -> Effect {
    column(bench, Law::Hysteresis).of("column_hysteresis")
}

/// Level of noise that follows a column.
pub fn noise_level(bench: &mut Bench) -> Effect {
    let (name, course) = driver(bench);
    let rows = bench.at_rows(&course);
    let (middle, spread) = (rows.iter().sum::<f64>() / rows.len() as f64, spread_of(&rows).max(1e-12));
    let sign = bench.dice.sign();
    let level: Vec<f64> = rows.iter().map(|r| sign * (r - middle) / spread).collect();
    let of = name.clone();
    let levels = level.clone();
    let spread_of_size = move |_: &Bench, size: f64| -> Vec<f64> {
        // A pump or light source that gets weaker: the level grows faster than in proportion.
        levels.iter().map(|l| (1.0 + 0.1 * size * (l + 0.15 * l * l)).max(0.2)).collect()
    };
    let again = level;
    let mut effect =
        Effect::new("noise_variance_driver", Shape::Spread(Box::new(spread_of_size)), move |b, size| {
            let [low, high] = range_of(&b.columns[&of]);
            let [least, most] = range_of(&again).map(|l| (1.0 + 0.1 * size * (l + 0.15 * l * l)).max(0.2));
            Facts::default()
                .at("driver", low, high)
                .at("time", 0.0, b.duration_s())
                .with("ratio", (most / least).max(least / most))
        });
    effect.column = Some(name);
    effect
}

/// A unit on a rate table with its supply recorded.
pub fn table_with_supply(bench: &mut Bench) {
    bench.turn(Programme::Steps);
    bench.record("supply_v");
    let count = bench.dice.count(0, 2);
    bench.record_others(count);
}

/// Scale factor that follows the supply.
pub fn scale_by_supply(bench: &mut Bench) -> Effect {
    scale(bench, "supply_v", true)
}

/// A unit on a rate table, the weather not recorded.
pub fn table_alone(bench: &mut Bench) {
    bench.turn(Programme::Steps);
}

/// Scale factor that follows the temperature of the room, which is not recorded.
pub fn scale_hidden(bench: &mut Bench) -> Effect {
    bench.record("rack_degC");
    bench.columns.remove("rack_degC");
    scale(bench, "rack_degC", false)
}

fn scale(bench: &mut Bench, name: &'static str, recorded: bool) -> Effect {
    let course = bench.surroundings[name].clone();
    let rows = bench.at_rows(&course);
    let middle = rows.iter().sum::<f64>() / rows.len() as f64;
    let spread = spread_of(&rows).max(1e-12);
    let sign = bench.dice.sign();
    let rate = &bench.columns["table_rate_deg_s"];
    let course = rows.iter().zip(rate).map(|(x, r)| sign * (x - middle) / spread * 3.6e-3 * r).collect();
    let mut effect = Effect::new("sf_driver", Shape::Course(course), move |bench, size| {
        let [low, high] = range_of(&bench.columns["table_rate_deg_s"]);
        let facts = Facts::default().at("input_rate", low, high).at("time", 0.0, bench.duration_s());
        let Some(values) = bench.columns.get(name) else { return facts };
        let [from, to] = range_of(values);
        let domain = if name == "supply_v" { "supply" } else { "driver" };
        facts.at(domain, from, to).with("coefficient_ppm", sign * size / spread)
    });
    effect.column = recorded.then(|| name.to_owned());
    effect.latent = !recorded;
    effect.of(if recorded { "sf_supply" } else { "sf_hidden" })
}
