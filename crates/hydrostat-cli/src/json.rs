//! The JSON of docs/format.md: SI, the unit in the key.

use crate::files;
use hydrostat::budget::{Budget, Displacement, Tolerance};
use hydrostat::calibrate::{Calibration, Problem};
use hydrostat::model::Pose;
use hydrostat::plan::{Choice, Design, Limit, Plan, Request};
use hydrostat::solution::{Check, Method, Station, TendonState};
use hydrostat::verify::{Experiment, Point, PointError, Summary, Varied, Verification};
use hydrostat::{Equilibrium, Error, Robot};
use nalgebra::{Matrix3, Vector3};
use serde_json::{Map, Value, json};
use std::path::Path;
use std::time::Duration;

/// `solve --json`.
pub(crate) fn solution(robot: &Robot, shape: &Equilibrium, took: Duration) -> Value {
    let Pose { position, rotation } = &shape.tip;
    let report = &shape.report;
    json!({
        "robot": robot.name,
        "tip": { "position_m": json!(position.as_slice()), "rotation": json!(<[[f64; 3]; 3]>::from(rotation.transpose().into_inner())) },
        "stations": {
            "s_m": column(shape, |station| json!(station.s)),
            "position_m": column(shape, |station| json!(station.position.as_slice())),
            "rotation": column(shape, |station| json!(<[[f64; 3]; 3]>::from(station.rotation.transpose()))),
            "v": column(shape, |station| json!(station.v.as_slice())),
            "u_per_m": column(shape, |station| json!(station.u.as_slice())),
            "force_n": column(shape, |station| json!(station.force.as_slice())),
            "moment_nm": column(shape, |station| json!(station.moment.as_slice())),
        },
        "tendons": shape.tendons.iter().map(tendon).collect::<Vec<_>>(),
        "checks": shape.checks.iter().map(check).collect::<Vec<_>>(),
        "report": {
            "method": method(report.method),
            "iterations": report.iterations,
            "residual": report.residual,
            "error_estimate_m": report.error_estimate,
            "stable": report.stable,
            "smallest_eigenvalue": report.smallest_eigenvalue,
            "unstable_from": report.unstable_from,
            "snapped_from": report.snapped_from,
            "solve_time_us": took.as_nanos() as f64 / 1e3,
        },
    })
}

/// `verify --json`; one row per measured point.
pub(crate) fn verification(experiment: &Experiment, verification: &Verification) -> Value {
    let mut rows = Vec::new();
    for row in &verification.rows {
        for mut object in points(experiment, &row.inputs, &row.points) {
            object.insert("failed_checks".into(), row.failed.iter().map(check).collect());
            rows.push(Value::Object(object));
        }
    }
    let mut all = Map::new();
    all.insert("experiment".into(), json!(experiment.name));
    all.insert("length_m".into(), json!(experiment.robot.length()));
    all.insert("rows".into(), Value::Array(rows));
    all.extend(summary(&verification.model));
    all.insert("constant_curvature".into(), Value::Object(summary(&verification.constant_curvature)));
    all.insert(
        "constant_curvature_weightless".into(),
        Value::Object(summary(&verification.constant_curvature_weightless)),
    );
    let variant = |(name, errors): &(String, Summary)| {
        let mut object = Map::from_iter([("name".to_owned(), json!(name))]);
        object.extend(summary(errors));
        Value::Object(object)
    };
    all.insert("variants".into(), verification.variants.iter().map(variant).collect());
    all.insert("findings".into(), json!(verification.findings));
    all.insert("verdict".into(), json!(verification.verdict.join(" ")));
    Value::Object(all)
}

/// A row, one object per measured point.
fn points(experiment: &Experiment, inputs: &[f64], points: &[PointError]) -> Vec<Map<String, Value>> {
    let object = |(point, measured): (&PointError, &Point)| {
        let mut object = Map::new();
        for (input, value) in experiment.inputs.iter().zip(inputs) {
            object.insert(input_key(&input.column, input.quantity), json!(value));
        }
        // the axes that any point has; null where this one was not read
        let axes = |v: &[f64]| -> Value {
            let read = |axis: &usize| experiment.points.iter().any(|point| point.axes.contains(axis));
            let value = |axis| if measured.axes.contains(&axis) { json!(v[axis]) } else { Value::Null };
            (0..3).filter(read).map(value).collect()
        };
        object.insert("at_m".into(), json!(point.at));
        object.insert("predicted_m".into(), axes(point.predicted.as_slice()));
        object.insert("observed_m".into(), axes(point.observed.as_slice()));
        object.insert("error_m".into(), json!(point.error));
        object
    };
    points.iter().zip(&experiment.points).map(object).collect()
}

/// `calibrate --json`; calibrations after the first stand under `further`.
pub(crate) fn calibrations(done: &[(Problem, Calibration)]) -> Value {
    let mut all =
        done.iter().map(|(problem, calibration)| Value::Object(of_calibration(problem, calibration)));
    let mut first = all.next().unwrap_or(Value::Null);
    let further: Vec<Value> = all.collect();
    if !further.is_empty() {
        first["further"] = Value::Array(further);
    }
    first
}

fn of_calibration(problem: &Problem, calibration: &Calibration) -> Map<String, Value> {
    let parameters = calibration.parameters.iter().map(|estimate| {
        json!({
            "name": estimate.parameter.name,
            "value": estimate.value,
            "unit": estimate.parameter.unit(),
            "standard_error": estimate.standard_error,
            "interval_95": estimate.interval_95,
            "interval_95_cut": estimate.cut,
            "before": estimate.before,
            "paths": estimate.parameter.paths(&problem.experiment),
        })
    });
    let correlation = calibration.correlation.row_iter().map(|row| json!(row.iter().collect::<Vec<_>>()));
    let mut all = Map::new();
    all.insert("experiment".into(), json!(problem.experiment.name));
    all.insert("parameters".into(), parameters.collect());
    all.insert("correlation".into(), correlation.collect());
    all.extend(summary(&calibration.after));
    all.insert("before".into(), Value::Object(summary(&calibration.before)));
    all.insert("chi_square".into(), json!(calibration.chi_square));
    all.insert("degrees_of_freedom".into(), json!(calibration.degrees_of_freedom));
    all.insert("chi_square_chance".into(), json!(calibration.chance));
    all.insert("error_scale".into(), json!(calibration.error_scale));
    all.insert("unexplained_m".into(), json!(calibration.unexplained));
    all.insert("systematic".into(), json!(calibration.systematic));
    all.insert(
        "left_out".into(),
        calibration.left_out.as_ref().map_or(Value::Null, |errors| Value::Object(summary(errors))),
    );
    let held_out = calibration.holdout.as_ref().map(|[before, after]| {
        let mut errors = summary(after);
        errors.insert("before".into(), Value::Object(summary(before)));
        Value::Object(errors)
    });
    let folds = calibration.folds.as_ref().map(|errors| Value::Object(summary(errors)));
    all.insert("folds".into(), folds.unwrap_or(Value::Null));
    all.insert("holdout".into(), held_out.unwrap_or(Value::Null));
    let rows = calibration.rows.iter();
    let rows = rows.flat_map(|row| points(&problem.experiment, &row.inputs, &row.after)).map(Value::Object);
    all.insert("rows".into(), rows.collect());
    all.insert("verdict".into(), json!(calibration.verdict));
    all.insert("warnings".into(), json!(calibration.warnings));
    all
}

/// The solver's name as in `--method`.
pub(crate) fn method(method: Method) -> &'static str {
    match method {
        Method::Energy => "energy",
        Method::Shooting => "shooting",
    }
}

fn summary(errors: &Summary) -> Map<String, Value> {
    Map::from_iter([
        ("mean_error_m".to_owned(), json!(errors.mean)),
        ("rms_error_m".to_owned(), json!(errors.rms)),
        ("max_error_m".to_owned(), json!(errors.max)),
        ("mean_error_percent".to_owned(), json!(errors.mean_fraction * 100.0)),
        ("rms_in_reading_errors".to_owned(), json!(errors.in_reading_errors)),
        ("mean_offset_m".to_owned(), json!(errors.offset.as_slice())),
        ("rms_without_offset_m".to_owned(), json!(errors.rms_without_offset)),
    ])
}

/// The column's name as a key, with the SI unit behind it.
fn input_key(column: &str, quantity: Varied) -> String {
    let unit = match quantity {
        Varied::HungMass { .. } => "kg",
        Varied::MountAngle => "rad",
        Varied::Force { .. } | Varied::Tension { .. } => "n",
        Varied::Displacement { .. } => "m",
    };
    format!("{}_{unit}", column.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "_"))
}

fn tendon(tendon: &TendonState) -> Value {
    json!({
        "name": tendon.name,
        "tension_n": tendon.tension,
        "tip_tension_n": tendon.tip_tension,
        "displacement_m": tendon.displacement,
        "length_m": tendon.length,
        "slack": tendon.slack,
    })
}

/// The stations of an earlier `solve --json`: arc length, rotation and v.
pub(crate) fn read_stations(path: &Path) -> Result<Vec<Station>, Error> {
    let text = files::read_text(path)?;
    let malformed = |what: &str| {
        Error::new(format!("{}: {what}", path.display()))
            .hint("expected the output of `hydrostat solve ROBOT.toml --json`")
    };
    let value: Value =
        serde_json::from_str(&text).map_err(|error| malformed(&format!("not JSON: {error}")))?;
    let column = |name: &str| serde_json::from_value(value["stations"][name].clone());
    let missing = |_| malformed("no stations with s_m, rotation and v");
    let s: Vec<f64> = column("s_m").map_err(missing)?;
    let v: Vec<[f64; 3]> = serde_json::from_value(value["stations"]["v"].clone()).map_err(missing)?;
    let rotations: Vec<[[f64; 3]; 3]> =
        serde_json::from_value(value["stations"]["rotation"].clone()).map_err(missing)?;
    if v.len() != s.len() || rotations.len() != s.len() {
        return Err(malformed("the columns of the stations differ in length"));
    }
    let station = |((s, v), rows): ((f64, [f64; 3]), [[f64; 3]; 3])| Station {
        s,
        position: Vector3::zeros(),
        rotation: Matrix3::from_fn(|i, j| rows[i][j]),
        v: v.into(),
        u: Vector3::zeros(),
        force: Vector3::zeros(),
        moment: Vector3::zeros(),
    };
    Ok(s.into_iter().zip(v).zip(rotations).map(station).collect())
}

fn check(check: &Check) -> Value {
    json!({ "name": check.name, "value": check.value, "limit": check.limit, "ok": check.ok, "at_m": check.at })
}

fn column(shape: &Equilibrium, of: impl Fn(&Station) -> Value) -> Value {
    shape.stations.iter().map(of).collect()
}

/// `budget --json`; one row per measured point.
pub(crate) fn budget(experiment: &Experiment, budget: &Budget) -> Value {
    let tolerances = budget.contributions.iter().map(|part| {
        let mut object = Map::new();
        object.insert("name".into(), json!(part.name()));
        object.insert("value".into(), json!(part.value));
        object.insert("standard_deviation".into(), json!(part.tolerance.as_ref().map(|t| t.deviation)));
        object.insert("unit".into(), json!(part.tolerance.as_ref().map(Tolerance::unit)));
        object.extend(displacement(&part.displacement));
        object.insert("share".into(), json!(part.share));
        Value::Object(object)
    });
    let mut rows = Vec::new();
    for (i, row) in experiment.rows.iter().enumerate() {
        for (j, point) in experiment.points.iter().enumerate() {
            let mut object = Map::new();
            for (input, value) in experiment.inputs.iter().zip(&row.inputs) {
                object.insert(input_key(&input.column, input.quantity), json!(value));
            }
            let both = |part: &Displacement| json!({ "first_order_m": part.first_order[i][j], "monte_carlo_m": part.monte_carlo[i][j] });
            let by =
                budget.contributions.iter().map(|part| (part.name().to_owned(), both(&part.displacement)));
            object.insert("at_m".into(), json!(point.at));
            object.insert("by_tolerance".into(), Value::Object(by.collect()));
            object.insert("total".into(), both(&budget.total));
            object.insert("error_m".into(), json!(budget.errors[i][j]));
            rows.push(Value::Object(object));
        }
    }
    json!({
        "experiment": experiment.name,
        "samples": budget.samples,
        "seed": budget.seed,
        "failed_samples": budget.failed,
        "tolerances": tolerances.collect::<Vec<_>>(),
        "total": Value::Object(displacement(&budget.total)),
        "rows": rows,
        "verify": Value::Object(summary(&budget.verified)),
        "chance_of_mean_error": budget.chance_of_mean,
        "chi_square": budget.chi_square,
        "degrees_of_freedom": budget.degrees_of_freedom,
        "chi_square_chance": budget.chance_of_shape,
        "verdict": budget.verdict,
    })
}

fn displacement(part: &Displacement) -> Map<String, Value> {
    Map::from_iter([
        ("first_order_rms_m".to_owned(), json!(part.rms_first_order)),
        ("monte_carlo_rms_m".to_owned(), json!(part.rms_monte_carlo)),
        ("sampling_error_m".to_owned(), json!(part.sampling_error)),
    ])
}

/// `plan --json`.
pub(crate) fn plan(request: &Request, plan: &Plan) -> Value {
    let parameters = plan.parameters.iter().map(|planned| {
        let half =
            |error: Option<f64>, times: Option<f64>| error.zip(times).map(|(error, times)| error * times);
        let [now, after_d, after_a] = plan.quantiles;
        json!({
            "name": planned.parameter.name,
            "value": planned.value,
            "unit": planned.parameter.unit(),
            "standard_error_now": planned.now,
            "standard_error_after_d_optimal": planned.after_d,
            "standard_error_after_a_optimal": planned.after_a,
            "half_interval_95_now": half(planned.now, now),
            "half_interval_95_after_d_optimal": half(planned.after_d, after_d),
            "half_interval_95_after_a_optimal": half(planned.after_a, after_a),
        })
    });
    let key = |limit: &Limit| input_key(&limit.input.column, limit.input.quantity);
    let points = &request.problem.experiment.points;
    let design = |design: &Design| {
        let rows = design.rows.iter().map(|row| {
            let inputs = request.limits.iter().zip(&row.inputs);
            let mut object: Map<String, Value> =
                inputs.map(|(limit, value)| (key(limit), json!(value))).collect();
            let predicted = points.iter().zip(&row.predicted).map(|(point, predicted)| {
                let read = point.axes.iter().map(|&axis| predicted[axis]).collect::<Vec<f64>>();
                json!({ "at_m": point.at, "predicted_m": read })
            });
            object.insert("points".into(), predicted.collect());
            Value::Object(object)
        });
        json!({ "rows": rows.collect::<Vec<_>>(), "confidence_volume_ratio": design.volume })
    };
    let limits = request.limits.iter().map(|limit| (key(limit), json!(limit.choice.range())));
    let values = request.limits.iter().filter_map(|limit| match &limit.choice {
        Choice::Range(_) => None,
        Choice::Values(values) => Some((key(limit), json!(values))),
    });
    let left_out = plan.left_out.iter().map(|(reason, count)| json!({ "reason": reason, "count": count }));
    json!({
        "experiment": request.problem.experiment.name,
        "limits": Value::Object(limits.collect()),
        "values": Value::Object(values.collect()),
        "repeats": request.repeats,
        "error_scale": plan.error_scale,
        "candidates": plan.candidates,
        "left_out": left_out.collect::<Vec<_>>(),
        "d_optimal": design(&plan.d_optimal),
        "a_optimal": design(&plan.a_optimal),
        "parameters": parameters.collect::<Vec<_>>(),
        "verdict": plan.verdict,
        "warnings": plan.warnings,
    })
}
