//! What `solve --jacobian --compliance` adds to its output.

use crate::text::{self, MM, significant};
use hydrostat::model::Command;
use hydrostat::solution::{Derivative, PoseDerivative, TendonDerivative};
use hydrostat::statics::{self, Input, Workspace};
use hydrostat::{Error, Robot};
use nalgebra::Vector3;
use serde_json::{Map, Value, json};

/// Of the tip; None where not asked for.
pub(crate) struct Derivatives {
    /// Per tendon.
    jacobian: Option<Vec<Derivative>>,
    /// Per force, then per moment, along x y z.
    compliance: Option<Vec<Derivative>>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Derivatives {
    pub(crate) fn find(
        robot: &Robot,
        workspace: &mut Workspace,
        jacobian: bool,
        compliance: bool,
    ) -> Result<Self, Error> {
        let mut of = |asked: bool, inputs: &[Input]| {
            let found = || statics::derivatives(robot, workspace, &[robot.length()], inputs);
            asked.then(found).transpose()
        };
        Ok(Derivatives {
            jacobian: of(jacobian, &Input::commands(robot))?,
            compliance: of(compliance, &Input::tip_wrench())?,
        })
    }

    /// As keys of the JSON of `solve`.
    pub(crate) fn add_to(&self, all: &mut Value, robot: &Robot) {
        if let Some(jacobian) = &self.jacobian {
            let group = |by_tension: bool, per: &str| {
                let chosen = |i: &usize| is_tension(&robot.actuation[*i]) == by_tension;
                let chosen: Vec<usize> = (0..robot.tendons.len()).filter(chosen).collect();
                let columns: Vec<&Derivative> = chosen.iter().map(|&i| &jacobian[i]).collect();
                let names: Vec<&str> = chosen.iter().map(|&i| robot.tendons[i].name.as_str()).collect();
                let mut group = Map::from_iter([("tendons".to_owned(), json!(names))]);
                group.extend(matrices(&columns, per, robot.tendons.len()));
                group
            };
            all["jacobian"] = json!({ "tension": group(true, "n"), "displacement": group(false, "m") });
        }
        if let Some(compliance) = &self.compliance {
            let columns: Vec<&Derivative> = compliance.iter().collect();
            let (force, moment) = columns.split_at(AXES.len());
            let group = |columns, per| matrices(columns, per, robot.tendons.len());
            all["compliance"] = json!({ "force": group(force, "n"), "moment": group(moment, "nm") });
        }
    }

    /// Lines of the summary.
    pub(crate) fn text(&self, robot: &Robot) -> String {
        let mut text = String::new();
        let mut line = |input: String, pose: &PoseDerivative, unit: &str, per: f64| {
            let unit = if unit.contains(' ') { format!("({unit})") } else { unit.to_owned() };
            let position = significant(pose.position.as_slice(), MM / per);
            let rotation = significant(pose.rotation.as_slice(), 1_f64.to_degrees() / per);
            text += &text::line(
                &format!("tip per {input}"),
                &format!("{position} mm/{unit}, {rotation} deg/{unit}"),
            );
        };
        for ((tendon, command), derivative) in
            robot.tendons.iter().zip(&robot.actuation).zip(self.jacobian.iter().flatten())
        {
            let (unit, per) = if is_tension(command) { ("N", 1.0) } else { ("mm", MM) };
            line(format!("{unit} {}", tendon.name), &derivative.poses[0], unit, per);
        }
        for (i, derivative) in self.compliance.iter().flatten().enumerate() {
            let unit = if i < AXES.len() { "N" } else { "N mm" };
            let per = if i < AXES.len() { 1.0 } else { MM };
            line(format!("{unit} {}", AXES[i % AXES.len()]), &derivative.poses[0], unit, per);
        }
        text
    }
}

fn is_tension(command: &Command) -> bool {
    matches!(command, Command::Tension { .. })
}

/// One column per input.
fn matrices(columns: &[&Derivative], per: &str, tendons: usize) -> Map<String, Value> {
    let row = |of: &dyn Fn(&Derivative) -> f64| -> Value {
        columns.iter().map(|derivative| json!(of(derivative))).collect()
    };
    let of_pose = |of: fn(&PoseDerivative) -> &Vector3<f64>| -> Value {
        (0..AXES.len()).map(|axis| row(&|derivative| of(&derivative.poses[0])[axis])).collect()
    };
    let of_tendons = |of: fn(&TendonDerivative) -> f64| -> Value {
        (0..tendons).map(|i| row(&|derivative| of(&derivative.tendons[i]))).collect()
    };
    Map::from_iter([
        (format!("tip_position_m_per_{per}"), of_pose(|pose| &pose.position)),
        (format!("tip_rotation_rad_per_{per}"), of_pose(|pose| &pose.rotation)),
        (format!("tension_n_per_{per}"), of_tendons(|tendon| tendon.tension)),
        (format!("displacement_m_per_{per}"), of_tendons(|tendon| tendon.displacement)),
        (format!("length_m_per_{per}"), of_tendons(|tendon| tendon.length)),
    ])
}
