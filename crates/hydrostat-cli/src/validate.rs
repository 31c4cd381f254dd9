//! `hydrostat validate`: published and exact solutions against ours.

use crate::{End, Outcome, files, text};
use hydrostat::Error;
use hydrostat::validate::{self, Case, robustness};
use std::path::PathBuf;

/// The shapes of a steel rod computed with SoRoSim, in the data folder.
const SOROSIM: &str = "sorosim_steel/statics.csv";

const TITLE: &str = "# Validation\n\nPublished and exact solutions against ours, printed by `hydrostat validate --markdown`;\n\
                     `cargo xtask docs` writes this file.\n\n";

/// The long sweeps, of rods and of tendon robots.
const RANDOM: usize = 10_000;
const SEED: u64 = 1;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Also the long sweeps over random rods and tendon robots
    #[arg(long)]
    full: bool,
    /// Print as Markdown
    #[arg(long)]
    markdown: bool,
    /// Folder of reference data with sorosim_steel/statics.csv
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    let sorosim = args.data.as_ref().map(|folder| files::read_text(&folder.join(SOROSIM))).transpose()?;
    let mut cases = validate::run(sorosim.as_deref());
    if args.full {
        cases.extend(robustness::sweep(RANDOM, SEED).cases());
        cases.extend(robustness::tendon_sweep(RANDOM, SEED).cases());
    }
    let stdout = if args.markdown { TITLE.to_owned() + &validate::markdown(&cases) } else { table(&cases) };
    Ok(Outcome { stdout, end: End::passed(cases.iter().all(Case::ok)) })
}

fn table(cases: &[Case]) -> String {
    let mut text = String::new();
    for group in cases.chunk_by(|a, b| a.group == b.group) {
        let header = ["case", "published or exact", "ours", "difference", "tolerance", ""];
        let mut table = vec![header.map(str::to_owned).to_vec()];
        table.extend(group.iter().map(|case| cells(case).to_vec()));
        text += &format!("{}\n{}", group[0].group, text::aligned(&table));
        let notes = |heading: &str, note: fn(&Case) -> &'static str| {
            let mut notes: Vec<_> = group.iter().map(note).collect();
            notes.dedup();
            notes.iter().map(|note| format!("  {heading}: {note}\n")).collect::<String>()
        };
        text += &(notes("reference", |case| case.source) + &notes("tolerance", |case| case.reason) + "\n");
    }
    let failing = cases.iter().filter(|case| !case.ok()).count();
    text + &match failing {
        0 => format!("all {} cases agree within their tolerance\n", cases.len()),
        _ => format!("{failing} of {} cases FAIL\n", cases.len()),
    }
}

fn cells(case: &Case) -> [String; 6] {
    [
        case.name.clone(),
        format!("{:.9}", case.reference),
        case.ours.as_ref().map_or_else(|message| message.replace('\n', " "), |ours| format!("{ours:.9}")),
        format!("{:.1e}", case.difference()),
        format!("{:.1e}", case.tolerance),
        if case.ok() { "ok" } else { "FAILS" }.to_owned(),
    ]
}
