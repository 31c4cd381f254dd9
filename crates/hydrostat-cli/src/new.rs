//! `hydrostat new`: commented starter files, never over existing ones.

use crate::{End, Outcome, files};
use clap::ValueEnum;
use hydrostat::Error;
use hydrostat::description::templates;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// What to start
    what: What,
    /// Name of the files, without ending
    name: String,
}

#[derive(Clone, Copy, ValueEnum)]
enum What {
    /// A rod: NAME.toml for `solve`
    Rod,
    /// A rod with three tendons: NAME.toml for `solve`
    Tendon,
    /// A bench: NAME.toml and its table for `verify`
    Bench,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    let name = &args.name;
    if name.is_empty() || !name.chars().all(|c| c.is_alphanumeric() || c == '-' || c == '_') {
        return Err(Error::new(format!("\"{name}\" cannot name files: expected letters, digits, - and _")));
    }
    let (templates, next) = match args.what {
        What::Rod => (vec![templates::rod(name)], "solve"),
        What::Tendon => (vec![templates::tendon(name)], "solve"),
        What::Bench => (templates::bench(name).to_vec(), "verify"),
    };
    files::create_all(&templates)?;
    let wrote: Vec<&str> = templates.iter().map(|file| file.name.as_str()).collect();
    let stdout = format!("wrote {}; next: hydrostat {next} {name}.toml\n", wrote.join(", "));
    Ok(Outcome { stdout, end: End::Passed })
}
