//! Reads an experiment file, the robot file and the table that it names.

use super::Parsed;
use super::calibration::{self, CalibrationFlags, Wanted};
use super::data::{Column, Data};
use super::load::read_arc_length;
use super::quantity::{ANGLE, FORCE, FRACTION, Kind, LENGTH, MASS};
use super::reader::{Entry, Node, Source, Table};
use super::robot::{self, perpendicular};
use super::{budget, plan, tendon};
use crate::Error;
use crate::budget::Tolerance;
use crate::calibrate::Problem;
use crate::model::{Pose, Robot};
use crate::verify::{Experiment, Input, Point, Published, Row, Varied};
use nalgebra::{Matrix3, Rotation3, Vector3};

pub(super) const EXPERIMENT_KEYS: &[&str] = &[
    "name",
    "source",
    "robot",
    "data",
    "set",
    "bench",
    "vary",
    "measure",
    "published",
    "variant",
    "calibrate",
    "budget",
    "plan",
];
pub(super) const BENCH_KEYS: &[&str] = &["origin", "x", "y", "mount_angle"];
pub(super) const VARY_KEYS: &[&str] =
    &["quantity", "column", "unit", "tendon", "backlash", "at", "direction"];
pub(super) const MEASURE_KEYS: &[&str] = &["at", "x", "y", "z", "unit", "reading_error"];
pub(super) const PUBLISHED_KEYS: &[&str] = &["x", "y", "z", "error", "error_fraction", "mean_error"];
pub(super) const VARIANT_KEYS: &[&str] = &["name", "set"];

const AXES: [&str; 3] = ["x", "y", "z"];

/// Reads an experiment file; `file` is the name that messages show, `load` fetches a file by its path relative to it.
pub fn parse_experiment(
    text: &str,
    file: &str,
    load: &mut dyn FnMut(&str) -> Result<String, Error>,
) -> Result<Parsed<Experiment>, Error> {
    let Parsed { value: (experiment, _), warnings } = read(text, file, load, &CalibrationFlags::default())?;
    Ok(Parsed { value: experiment, warnings })
}

/// The same with what is to be calibrated, by its table `[calibrate]` and by flags.
pub fn parse_calibration(
    text: &str,
    file: &str,
    load: &mut dyn FnMut(&str) -> Result<String, Error>,
    flags: &CalibrationFlags,
) -> Result<Parsed<Problem>, Error> {
    let Parsed { value: (experiment, asked), warnings } = read(text, file, load, flags)?;
    Ok(Parsed { value: calibration::problem(experiment, asked.calibration, flags)?, warnings })
}

/// What the file asks of single commands.
pub(super) struct Asked {
    pub(super) calibration: Wanted,
    pub(super) tolerances: Vec<Tolerance>,
    pub(super) plan: plan::Wanted,
}

pub(super) fn read(
    text: &str,
    file: &str,
    load: &mut dyn FnMut(&str) -> Result<String, Error>,
    flags: &CalibrationFlags,
) -> Result<Parsed<(Experiment, Asked)>, Error> {
    let source = Source::new(file, text);
    let root = source.parse()?;
    let table = root.table(EXPERIMENT_KEYS)?;
    let name = table.require("name", "the experiment's name")?.text("a name")?;
    let origin = table.get("source").map(|node| node.text("a text")).transpose()?;

    let robot_file = Linked::load(&table, "robot", "a robot file, such as \"rod.toml\"", file, load)?;
    let robot_source = Source::new(&robot_file.name, &robot_file.text);
    let mut robot_root = robot_source.parse()?;
    replace(&mut robot_root, &table)?;
    let data_file = Linked::load(&table, "data", "a table, such as \"data.csv\"", file, load)?;
    let data_source = Source::new(&data_file.name, &data_file.text);
    let data = Data::parse(&data_source)?;

    let mut warnings = Vec::new();
    let robot = robot::read(&robot_root, &mut warnings)?;
    let length = robot.length();
    let bench = Bench::read(&table, &robot)?;
    let (inputs, input_columns) = read_inputs(&table, &data, &robot, &bench)?;
    let (points, point_columns) = read_points(&table, &data, length)?;
    let published = table.get("published").map(|node| read_published(node, &data, &points)).transpose()?;
    let variants = read_variants(&table, &robot_root, &bench, &mut warnings)?;
    let rows = rows(data.rows(), &input_columns, &point_columns);
    let holdout = match calibration::holdout(&table, flags)? {
        None => Vec::new(),
        Some(path) => {
            let held_out = Linked::fetch(path, file, load)?;
            let source = Source::new(&held_out.name, &held_out.text);
            let data = Data::parse(&source)?;
            let (_, inputs) = read_inputs(&table, &data, &robot, &bench)?;
            let (_, points) = read_points(&table, &data, length)?;
            self::rows(data.rows(), &inputs, &points)
        }
    };
    let experiment = Experiment {
        name: name.to_string(),
        source: origin.map(str::to_string),
        robot: bench.mount(robot),
        axes: bench.axes,
        inputs,
        points,
        rows,
        published,
        variants,
    };
    let asked = Asked {
        calibration: calibration::read(&experiment, &table, holdout)?,
        tolerances: budget::read(&experiment, &table)?,
        plan: plan::read(&experiment, &table)?,
    };
    Ok(Parsed { value: (experiment, asked), warnings })
}

/// A file that the experiment file names.
struct Linked {
    name: String,
    text: String,
}

impl Linked {
    fn load(
        table: &Table,
        key: &str,
        expected: &str,
        file: &str,
        load: &mut dyn FnMut(&str) -> Result<String, Error>,
    ) -> Result<Linked, Error> {
        let node = table.require(key, expected)?;
        let path = node.text(expected)?;
        Linked::fetch(path, file, load).map_err(|error| error.or_at(|| node.place()))
    }

    /// A path relative to the experiment file.
    fn fetch(
        path: &str,
        file: &str,
        load: &mut dyn FnMut(&str) -> Result<String, Error>,
    ) -> Result<Linked, Error> {
        let folder = file.rfind(['/', '\\']).map_or("", |slash| &file[..=slash]);
        Ok(Linked {
            name: if path.starts_with('/') { path.to_string() } else { format!("{folder}{path}") },
            text: load(path)?,
        })
    }
}

fn rows(count: usize, inputs: &[Column], points: &[Coordinates]) -> Vec<Row> {
    let row = |i: usize| Row {
        inputs: inputs.iter().map(|column| column.values[i]).collect(),
        observed: points.iter().map(|columns| columns.position(i)).collect(),
    };
    (0..count).map(row).collect()
}

/// Puts the values of `set` into the robot's table.
fn replace<'s>(robot: &mut Node<'s>, table: &Table<'_, 's>) -> Result<(), Error> {
    let Some(set) = table.get("set") else {
        return Ok(());
    };
    let expected = "a table, such as { \"material.niti.density\" = \"6.4 g/cm^3\" }";
    set.entries(expected)?.iter().try_for_each(|entry: &Entry<'s>| robot.set(entry))
}

/// The bench's own axes, and the angle at which the robot is mounted on it.
struct Bench {
    axes: Pose,
    mount_angle: f64,
    /// Whether the file gives the angle.
    fixed: bool,
}

impl Bench {
    fn read(experiment: &Table, robot: &Robot) -> Result<Bench, Error> {
        let table = experiment.get("bench").map(|node| node.table(BENCH_KEYS)).transpose()?;
        let get = |key| table.and_then(|table| table.get(key));
        let position = get("origin").map_or(Ok(robot.base.position), |node| node.vector(&LENGTH))?;
        let x = get("x").map_or(Ok(Vector3::x()), Node::direction)?;
        let y = get("y").map_or(Ok(Vector3::y()), Node::direction)?;
        let y = perpendicular(&y, &x).ok_or_else(|| {
            get("y").or(get("x")).unwrap_or(experiment.node).error("the bench's x and y axes are parallel")
        })?;
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, x.cross(&y)]));
        let angle = get("mount_angle");
        Ok(Bench {
            axes: Pose { position, rotation },
            mount_angle: angle.map_or(Ok(0.0), |node| node.quantity(&ANGLE))?,
            fixed: angle.is_some(),
        })
    }

    fn mount(&self, mut robot: Robot) -> Robot {
        if self.mount_angle != 0.0 {
            robot.base = robot.base.turned(&self.axes, self.mount_angle);
        }
        robot
    }
}

fn read_inputs(
    table: &Table,
    data: &Data,
    robot: &Robot,
    bench: &Bench,
) -> Result<(Vec<Input>, Vec<Column>), Error> {
    let nodes = table.get("vary").map_or(Ok(&[][..]), |node| node.tables("vary"))?;
    let mut read: (Vec<Input>, Vec<Column>) = (Vec::new(), Vec::new());
    for node in nodes {
        let (input, column) = read_input(&node.table(VARY_KEYS)?, data, robot, bench)?;
        if let Some(tendon) = input
            .quantity
            .tendon()
            .filter(|tendon| read.0.iter().any(|other: &Input| other.quantity.tendon() == Some(*tendon)))
        {
            return Err(node.error(format!("tendon \"{}\" is varied twice", robot.tendons[tendon].name)));
        }
        read.0.push(input);
        read.1.push(column);
    }
    Ok(read)
}

fn read_input(table: &Table, data: &Data, robot: &Robot, bench: &Bench) -> Result<(Input, Column), Error> {
    let expected = "\"hung_mass\", \"mount_angle\", \"force\", \"displacement\" or \"tension\"";
    let quantity = table.require("quantity", expected)?;
    let name = quantity.text(expected)?;
    let (kind, allowed): (&Kind, &[&str]) = match name {
        "hung_mass" => (&MASS, &["at"]),
        "mount_angle" => (&ANGLE, &[]),
        "force" => (&FORCE, &["at", "direction"]),
        "displacement" => (&LENGTH, &["tendon", "backlash"]),
        "tension" => (&FORCE, &["tendon"]),
        _ => return Err(quantity.refuse(expected)),
    };
    for key in ["at", "direction", "tendon", "backlash"] {
        if let Some(node) = table.get(key).filter(|_| !allowed.contains(&key)) {
            return Err(node.error(format!("\"{key}\" does not apply to {name}")));
        }
    }
    let at = || {
        read_arc_length(table.require("at", "\"tip\" or an arc length, such as \"120 mm\"")?, robot.length())
    };
    let tendon = || {
        let expected = "the name of a tendon";
        let node = table.require("tendon", expected)?;
        tendon::find(&robot.tendons, node.text(expected)?).map_err(|error| error.at(node.place()))
    };
    let varied = match name {
        "hung_mass" => Varied::HungMass { at: at()? },
        "force" => Varied::Force {
            at: at()?,
            direction: table.require("direction", "three numbers, such as [0, -1, 0]")?.direction()?,
        },
        "displacement" => Varied::Displacement {
            tendon: tendon()?,
            backlash: table.get("backlash").map_or(Ok(0.0), |node| node.not_negative(&LENGTH))?,
        },
        "tension" => Varied::Tension { tendon: tendon()? },
        _ if bench.fixed => {
            return Err(quantity.error("the mount angle is both varied here and fixed in [bench]"));
        }
        _ => Varied::MountAngle,
    };
    let key = table.require("column", "the name of a column")?;
    let column = data.column(key, kind, table.get("unit"))?;
    let negative = || column.values.iter().position(|value| *value < 0.0);
    if let Some(row) = negative().filter(|_| ["hung_mass", "tension"].contains(&name)) {
        let what = name.trim_start_matches("hung_");
        return Err(data.error_in(key, row, &format!("found a negative {what}, expected at least 0")));
    }
    if let Varied::Displacement { tendon, .. } = varied {
        let of = &robot.tendons[tendon];
        for (row, &value) in column.values.iter().enumerate() {
            tendon::check_displacement(value, of, robot.tendon_end(of))
                .map_err(|error| data.error_in(key, row, &error.to_string()))?;
        }
    }
    let input = Input {
        column: column.name.clone(),
        unit: (column.unit_text.clone(), column.unit.size()),
        quantity: varied,
    };
    Ok((input, column))
}

/// Coordinates of one point, row by row.
struct Coordinates(Vec<(usize, Column)>);

impl Coordinates {
    fn read(table: &Table, data: &Data) -> Result<Coordinates, Error> {
        let keys = AXES.iter().enumerate().filter_map(|(axis, key)| Some((axis, table.get(key)?)));
        let unit = table.get("unit");
        let columns = keys.map(|(axis, key)| Ok((axis, data.column(key, &LENGTH, unit)?)));
        Ok(Coordinates(columns.collect::<Result<_, Error>>()?))
    }

    fn position(&self, row: usize) -> Vector3<f64> {
        let mut position = Vector3::zeros();
        for (axis, column) in &self.0 {
            position[*axis] = column.values[row];
        }
        position
    }
}

fn read_points(table: &Table, data: &Data, length: f64) -> Result<(Vec<Point>, Vec<Coordinates>), Error> {
    let nodes = table.require("measure", "at least one table [[measure]]")?.tables("measure")?;
    if nodes.is_empty() {
        return Err(table.node.error("the experiment measures nothing"));
    }
    let mut read = (Vec::new(), Vec::new());
    for node in nodes {
        let table = node.table(MEASURE_KEYS)?;
        let columns = Coordinates::read(&table, data)?;
        if columns.0.is_empty() {
            return Err(node.error("this point has no column: give one or more of x, y and z"));
        }
        read.0.push(Point {
            at: read_arc_length(
                table.require("at", "\"tip\" or an arc length, such as \"120 mm\"")?,
                length,
            )?,
            axes: columns.0.iter().map(|(axis, _)| *axis).collect(),
            reading_error: table.quantity("reading_error", &LENGTH)?.positive(&LENGTH)?,
        });
        read.1.push(columns);
    }
    Ok(read)
}

fn read_published(node: &Node, data: &Data, points: &[Point]) -> Result<Published, Error> {
    let table = node.table(PUBLISHED_KEYS)?;
    let predicted = Coordinates::read(&table, data)?;
    let axes: Vec<usize> = predicted.0.iter().map(|(axis, _)| *axis).collect();
    if points.first().is_some_and(|point| !axes.is_empty() && point.axes != axes) {
        return Err(node
            .error("published predictions need the axes of the first measured point, no more and no fewer"));
    }
    let column = |key, kind| table.get(key).map(|node| data.column(node, kind, None)).transpose();
    let (error, fraction) = (column("error", &LENGTH)?, column("error_fraction", &FRACTION)?);
    let rounding = |column: &Option<Column>| column.as_ref().map_or(0.0, |column| column.rounding);
    let coordinate_rounding = predicted.0.iter().map(|(_, column)| column.rounding).fold(0.0, f64::max);
    Ok(Published {
        predicted: match predicted.0[..] {
            [] => Vec::new(),
            _ => (0..data.rows()).map(|row| predicted.position(row)).collect(),
        },
        rounding: [coordinate_rounding, rounding(&error), rounding(&fraction)],
        error: error.map(|column| column.values).unwrap_or_default(),
        error_fraction: fraction.map(|column| column.values).unwrap_or_default(),
        mean_errors: read_mean_errors(&table)?,
    })
}

/// `{ text = "2.1 mm" }` -> ("mean error in the text", 0.0021)
fn read_mean_errors(table: &Table) -> Result<Vec<(String, f64)>, Error> {
    let Some(node) = table.get("mean_error") else {
        return Ok(Vec::new());
    };
    let entries = node.entries("a table, such as { text = \"2.1 mm\" }")?.iter();
    let read = |entry: &Entry| {
        let value = entry.node.not_negative(&LENGTH)?;
        Ok((format!("mean error in the {}", entry.name), value))
    };
    entries.map(read).collect()
}

fn read_variants<'s>(
    table: &Table<'_, 's>,
    robot: &Node<'s>,
    bench: &Bench,
    warnings: &mut Vec<Error>,
) -> Result<Vec<(String, Robot)>, Error> {
    let nodes = table.get("variant").map_or(Ok(&[][..]), |node| node.tables("variant"))?;
    let mut variants = Vec::new();
    for node in nodes {
        let variant = node.table(VARIANT_KEYS)?;
        let name = variant.require("name", "a name")?.text("a name")?;
        variant.require("set", "a table, such as { \"section.rod.length\" = \"390 mm\" }")?;
        let mut changed = robot.clone();
        replace(&mut changed, &variant)?;
        let mut found = Vec::new();
        variants.push((name.to_string(), bench.mount(robot::read(&changed, &mut found)?)));
        found.retain(|warning| !warnings.contains(warning));
        warnings.append(&mut found);
    }
    Ok(variants)
}
