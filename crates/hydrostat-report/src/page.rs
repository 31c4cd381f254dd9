//! What all printable pages share: style, head, what went in, how it was computed.

use crate::describe;
use crate::text::{fixed, significant};
use hydrostat::verify::Experiment;
use minijinja::{Environment, Value, context};

const LAYOUT: &str = include_str!("layout.html");

/// How a result came about; printed at the end of the page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Of Hydrostat.
    pub version: String,
    /// In words, such as "special Cosserat rod, energy method".
    pub method: String,
    /// Largest estimated position error, as a fraction of the length.
    pub tolerance: f64,
    /// The files that were read.
    pub files: Vec<String>,
    /// What to type to get this page again.
    pub command: Option<String>,
    pub date: Option<String>,
}

/// One self-contained HTML page (inline CSS and SVG, no scripts) that also prints on A4; `main` fills the layout's block.
pub(crate) fn render(
    kind: &str,
    experiment: &Experiment,
    computed: Vec<Value>,
    main: &str,
    content: Value,
) -> String {
    let page = context! {
        kind,
        title => if experiment.name.trim().is_empty() { "Experiment without a name" } else { &experiment.name },
        source => experiment.source.clone(),
        tables => describe::tables(experiment),
        computed,
        ..content
    };
    let mut environment = Environment::new();
    // names with `<` or `&` are escaped because the templates' names end in .html
    let rendered = environment
        .add_template("layout.html", LAYOUT)
        .and_then(|()| environment.render_named_str("main.html", main, page));
    rendered.expect("the templates are part of the program")
}

pub(crate) fn svg(drawing: String) -> Value {
    Value::from_safe_string(drawing)
}

pub(crate) fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") }
}

/// Two decimals, three below a tenth of a millimetre.
pub(crate) fn error_mm(m: f64) -> String {
    fixed(1e3 * m, if m.abs() < 1e-4 && m != 0.0 { 3 } else { 2 })
}

/// Facts about the computation; `settings` are those of one kind of page.
pub(crate) fn computed(provenance: &Provenance, settings: Vec<Value>) -> Vec<Value> {
    let mut facts = vec![
        context! { name => "program", value => format!("Hydrostat {}", provenance.version) },
        context! { name => "method", value => provenance.method.clone() },
        context! { name => "tolerance", value =>
        format!("{} of the length, estimated largest position error", significant(provenance.tolerance)) },
    ];
    facts.extend(settings);
    if !provenance.files.is_empty() {
        facts.push(context! { name => "files", value => provenance.files.join(", "), code => true });
    }
    if let Some(command) = &provenance.command {
        facts.push(context! { name => "command", value => command, code => true });
    }
    if let Some(date) = &provenance.date {
        facts.push(context! { name => "date", value => date });
    }
    facts
}
