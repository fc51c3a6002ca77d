//! The functions of the module, each a call of the library.

use crate::columns::{columns, values};
use crate::errors::{argument, raised};
use crate::results::{Drawn, Results, drawn, language};
use crate::watch::{Teller, watched};
use arrow_array::{ArrayRef, Float64Array};
use pyo3::prelude::*;
use pyo3::types::PyList;
use pyo3_arrow::PyArray;
use sagnac::acceptance::column_choice::ColumnChoice;
use sagnac::acceptance::compare::Origin;
use sagnac::acceptance::verdict::row;
use sagnac::config::procedure::{EffectiveLimits, Procedure as ProcedureTables};
use sagnac::ingest::ReadOptions;
use sagnac::lot::tolerance::Promise;
use sagnac::measurand::{MEASURANDS, Test};
use sagnac::noise::family::Estimator;
use sagnac::noise::intervals::BoundedPoint;
use sagnac::noise::tau_grid::TauGrid;
use sagnac::noise::{self, AllanPlan};
use sagnac::record::MeasurandRecord;
use sagnac::report::svg;
use sagnac::units::Unit;
use sagnac::{
    Analysis, Compared, Error, Lang, Model, Procedure, Recording, RunResult, SheetSource, UnitUnderTest,
    data_sheet, mismatch,
};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::Arc;

/// Adds the functions to the module.
pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(toml_text, module)?)?;
    module.add_function(wrap_pyfunction!(allan, module)?)?;
    module.add_function(wrap_pyfunction!(identify, module)?)?;
    module.add_function(wrap_pyfunction!(inspect, module)?)?;
    module.add_function(wrap_pyfunction!(analyze, module)?)?;
    module.add_function(wrap_pyfunction!(run, module)?)?;
    module.add_function(wrap_pyfunction!(explain, module)?)?;
    module.add_function(wrap_pyfunction!(simulate, module)?)?;
    module.add_function(wrap_pyfunction!(compare, module)?)?;
    module.add_function(wrap_pyfunction!(datasheet, module)?)?;
    Ok(())
}

/// A recording: a path, several paths, or columns in memory.
fn recording(source: &Bound<'_, PyAny>, sample_rate_hz: Option<f64>) -> PyResult<Recording> {
    let py = source.py();
    let opened = if let Ok(path) = source.extract::<PathBuf>() {
        Recording::open(path)
    } else if let Ok(paths) = source.cast::<PyList>() {
        Recording::open_with(&paths.extract::<Vec<PathBuf>>()?, &ReadOptions::default())
    } else {
        Recording::from_memory(columns(source)?)
    };
    let opened = opened.map_err(|e| raised(py, &e))?;
    Ok(match sample_rate_hz {
        Some(hz) => opened.with_sample_rate(hz),
        None => opened,
    })
}

/// A file of the program: its path, or a name that stands for it and its text.
#[derive(FromPyObject)]
enum Document {
    Path(PathBuf),
    Text(String, String),
}

impl Document {
    fn model(&self) -> Result<Model, Error> {
        match self {
            Document::Path(path) => Model::load(path),
            Document::Text(name, text) => Model::parse(name, text),
        }
    }

    fn procedure(&self) -> Result<Procedure, Error> {
        match self {
            Document::Path(path) => Procedure::load(path),
            Document::Text(name, text) => Procedure::parse(name, text),
        }
    }

    fn limits_of(&self, procedure: Procedure) -> Result<Procedure, Error> {
        match self {
            Document::Path(path) => procedure.with_limits(path),
            Document::Text(name, text) => procedure.with_limits_of(name, text),
        }
    }
}

/// Tables in JSON as the text of a TOML file.
#[pyfunction]
fn toml_text(py: Python<'_>, tables: &str) -> PyResult<String> {
    let refused = |why: &dyn std::fmt::Display| argument(py, &format!("tables: no TOML has this: {why}"));
    let tables: Value = serde_json::from_str(tables).map_err(|e| refused(&e))?;
    toml::to_string(&tables).map_err(|e| refused(&e))
}

/// Averaging times: a word, or seconds.
#[derive(FromPyObject)]
enum Taus {
    Word(String),
    Seconds(Vec<f64>),
}

impl Taus {
    fn grid(self, py: Python<'_>) -> PyResult<TauGrid> {
        match self {
            Taus::Word(word) => word.parse().map_err(|e| argument(py, &format!("taus: {e}"))),
            Taus::Seconds(seconds) => Ok(TauGrid::List(seconds)),
        }
    }
}

fn point_json(p: &BoundedPoint, tau0_s: f64) -> Value {
    json!({
        "tau_s": p.point.m as f64 * tau0_s,
        "m": p.point.m,
        "terms": p.point.terms,
        "stride": p.point.stride,
        "deviation": p.point.deviation,
        "low": p.interval95.map(|i| i.low),
        "high": p.interval95.map(|i| i.high),
        "edf": p.edf,
        "noise": p.noise.id(),
    })
}

/// Deviations of samples: JSON, a list of curves; and their drawing.
#[pyfunction]
fn allan(
    py: Python<'_>,
    rate: &Bound<'_, PyAny>,
    tau0_s: f64,
    taus: Taus,
    estimators: Vec<String>,
    exact: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, String)> {
    let mut chosen = vec![];
    for name in &estimators {
        let known = Estimator::ALL.iter().copied().find(|e| e.id() == name);
        chosen.push(known.ok_or_else(|| {
            let ids: Vec<&str> = Estimator::ALL.iter().map(|e| e.id()).collect();
            argument(py, &format!("no deviation `{name}`: {} are known", ids.join(", ")))
        })?);
    }
    let plan = AllanPlan { taus: taus.grid(py)?, estimators: chosen, exact };
    let rate = values(rate, "rate")?;
    let curves = watched(py, progress, move |teller: &mut Teller| {
        noise::allan(&rate, tau0_s, &plan, &mut |done, total| teller.tell("reading", done, total))
    })?;
    let drawn = svg::render(&noise::draw(&curves, tau0_s), Lang::En);
    let curves = curves.iter().map(|c| {
        let points: Vec<Value> = c.points.iter().map(|p| point_json(p, tau0_s)).collect();
        json!({ "estimator": c.estimator.id(), "points": points })
    });
    Ok((Value::from_iter(curves).to_string(), drawn))
}

/// Noise of a gyro at rest: JSON with `measurands`, `allan`, `lines`; and figures (id, file name, SVG).
#[pyfunction]
fn identify(
    py: Python<'_>,
    rate: &Bound<'_, PyAny>,
    tau0_s: f64,
    unit: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Vec<Drawn>)> {
    let factor = Unit::parse(unit).and_then(|given| given.factor_to(&Unit::parse("deg/h")?));
    let factor = factor.map_err(|e| argument(py, &format!("unit: {e}")))?;
    let rate = values(rate, "rate")?;
    watched(py, progress, move |teller: &mut Teller| {
        let noise = noise::identify_in_memory(&rate, tau0_s, factor, &mut |done, total| {
            teller.tell("reading", done, total);
        })?;
        let (limits, procedure) = (EffectiveLimits::default(), ProcedureTables::default());
        let at_rest = MEASURANDS.iter().filter(|m| m.test() == Test::Static && !m.from_site);
        let rows: Vec<MeasurandRecord> =
            at_rest.filter_map(|m| noise.measure(m.id)).map(|e| row(&e, &limits, &procedure)).collect();
        let allan: Vec<Value> = noise.allan().iter().map(|p| point_json(p, tau0_s)).collect();
        let lines = noise
            .lines()
            .iter()
            .map(|l| json!({ "frequency_hz": l.frequency_hz, "amplitude_deg_h": l.amplitude_deg_h }));
        let text = json!({ "measurands": rows, "allan": allan, "lines": Value::from_iter(lines) });
        Ok((text.to_string(), vec![drawn(&noise.figure(), Lang::En)]))
    })
}

/// What a recording holds: the text of `inspect`, and its columns as JSON.
#[pyfunction]
fn inspect(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    sample_rate_hz: Option<f64>,
    lang: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, String)> {
    let lang = language(py, lang)?;
    let recording = recording(source, sample_rate_hz)?;
    watched(py, progress, move |teller: &mut Teller| {
        let text = recording.inspect(lang, &mut |done, total| teller.tell("reading", done, total))?;
        let columns = recording.described_columns().iter().map(|c| {
            let told = c.inferred();
            json!({
                "name": c.name,
                "numeric": c.numeric,
                "storage": c.storage,
                "role": told.role.id(),
                "unit": told.unit_is_named.then(|| told.unit.text().to_owned()),
            })
        });
        Ok((text, Value::from_iter(columns).to_string()))
    })
}

/// The columns that an analysis is asked for.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Columns {
    rate: Vec<String>,
    angle: Vec<String>,
    unit: Option<String>,
    counter: Option<String>,
    time: Option<String>,
    warm_up_s: f64,
}

/// An analysis without a procedure.
#[pyfunction]
fn analyze(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    sample_rate_hz: Option<f64>,
    columns: Columns,
    taus: Taus,
    exact: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Results> {
    let recording = recording(source, sample_rate_hz)?;
    let Columns { rate, angle, unit, counter, time, warm_up_s } = columns;
    let columns = ColumnChoice {
        rate,
        angle,
        unit,
        counter,
        time,
        sample_rate_hz,
        warm_up_s,
        ..ColumnChoice::default()
    };
    let analysis = Analysis { columns, taus: Some(taus.grid(py)?), exact, evaluated_at: None };
    watched(py, progress, move |teller: &mut Teller| {
        let result =
            analysis.run_watched(&recording, &mut |done, total| teller.tell("reading", done, total))?;
        Ok(Results { results: result.into_results() })
    })
}

/// Facts about a test besides its recording.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Session {
    serial: Option<String>,
    lot: Option<String>,
    operator: Option<String>,
    station: Option<String>,
}

/// A procedure on a recording.
#[pyfunction]
fn run(
    py: Python<'_>,
    procedure: Document,
    source: &Bound<'_, PyAny>,
    limits: Option<Document>,
    session: Session,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Results, Vec<String>)> {
    let failed = |e: Error| raised(py, &e);
    let mut procedure = procedure.procedure().map_err(failed)?;
    if let Some(limits) = limits {
        procedure = limits.limits_of(procedure).map_err(failed)?;
    }
    let Session { serial, lot, operator, station } = session;
    if let Some(operator) = operator {
        procedure = procedure.operator(operator);
    }
    if let Some(station) = station {
        procedure = procedure.station(station);
    }
    let warnings = procedure.warnings().iter().map(ToString::to_string).collect();
    let recording = recording(source, None)?;
    let unit = UnitUnderTest { serial, lot, ..UnitUnderTest::default() };
    let results = watched(py, progress, move |teller: &mut Teller| {
        let result = procedure
            .run_watched(&recording, &unit, &mut |done, total| teller.tell("reading", done, total))?;
        Ok(Results { results: result.into_results() })
    })?;
    Ok((results, warnings))
}

/// A recording against a model: the explanation, and the model with what was found.
#[pyfunction]
fn explain(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    model: Document,
    alpha: f64,
    max_effects: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Results, Option<PyArray>, Option<PyArray>)> {
    if !(alpha > 0.0 && alpha < 1.0) {
        return Err(argument(py, &format!("alpha: a probability between 0 and 1, not {alpha}")));
    }
    let model = model.model().map_err(|e| raised(py, &e))?;
    let recording = recording(source, None)?;
    let options = mismatch::Options { alpha, max_effects, ..mismatch::Options::default() };
    let (results, time_s, correction) = watched(py, progress, move |teller: &mut Teller| {
        let found = sagnac::explain_watched(&recording, &model, &options, &mut |p| {
            let doing = if p.doing.ends_with("locating") { "locating" } else { "explaining" };
            teller.tell(doing, p.done, p.total);
        })?;
        let (time_s, correction): (Vec<f64>, Vec<f64>) =
            found.correction().unwrap_or_default().iter().copied().unzip();
        Ok((Results { results: found.into_results() }, time_s, correction))
    })?;
    if time_s.is_empty() {
        return Ok((results, None, None));
    }
    Ok((results, Some(array(time_s)), Some(array(correction))))
}

fn array(values: Vec<f64>) -> PyArray {
    let values: ArrayRef = Arc::new(Float64Array::from(values));
    PyArray::from_array_ref(values)
}

/// A recording made from a model: (name, values) of each column, and the seed that was taken.
#[pyfunction]
fn simulate(
    py: Python<'_>,
    model: Document,
    seed: Option<u64>,
    duration_s: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<(String, PyArray)>, u64)> {
    let mut model = model.model().map_err(|e| raised(py, &e))?;
    let seed = seed.unwrap_or_else(|| model.seed());
    if let Some(duration_s) = duration_s {
        model = model.lasting(duration_s);
    }
    let columns = watched(py, progress, move |teller: &mut Teller| {
        model.simulate_columns(seed, &mut |done, total| teller.tell("simulating", done, total))
    })?;
    Ok((columns.into_iter().map(|(name, values)| (name, array(values))).collect(), seed))
}

/// Russian against Allan figures of results: each with the name of its unit, its path, and whether it was made from a recording for
/// the comparison.
#[pyfunction]
fn compare(py: Python<'_>, units: Vec<(Py<Results>, String, String, bool)>) -> PyResult<Results> {
    let mut runs = vec![];
    for (results, name, path, analysed) in &units {
        let sagnac::report::Results::Run(run) = &results.get().results else {
            return Err(argument(py, &format!("{path}: not the result of a run or an analysis")));
        };
        let origin = if *analysed { Origin::Recording } else { Origin::Result };
        runs.push((RunResult::of_record(run.outcome.record.clone()), name, path, origin));
    }
    let compared: Vec<Compared<'_>> = runs
        .iter()
        .map(|(result, name, path, origin)| Compared { result, name, path, origin: *origin })
        .collect();
    let results = sagnac::compare(&compared).map_err(|e| raised(py, &e))?;
    Ok(Results { results })
}

/// A result that a data sheet is made of: a path, or results and their name.
#[derive(FromPyObject)]
enum Tested {
    Path(PathBuf),
    Results(Py<Results>, String),
}

impl Tested {
    fn source(&self) -> SheetSource<'_> {
        match self {
            Tested::Path(path) => SheetSource::Path(path),
            Tested::Results(results, name) => SheetSource::Result(&results.get().results, name),
        }
    }
}

/// The data sheet of results.
#[pyfunction]
fn datasheet(py: Python<'_>, results: Vec<Tested>, proportion: f64, confidence: f64) -> PyResult<Results> {
    watched(py, None, move |_| {
        let sources: Vec<SheetSource<'_>> = results.iter().map(Tested::source).collect();
        data_sheet(&sources, Promise { proportion, confidence }).map(|results| Results { results })
    })
}
