//! `hydrostat fabricate`: the kit of a robot, all of it or nothing.

use crate::{End, Outcome, check, files};
use hydrostat::Error;
use hydrostat::fabricate;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Robot file, with a table [fabrication] for what differs from the defaults
    robot: PathBuf,
    /// Folder for the kit; it must be empty or not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace a folder that is not empty, with everything in it
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    files::refuse_full_folder(&args.out, args.force, &args.robot)?;
    let (robot, workshop) = check::read(&args.robot)?;
    let kit = fabricate::kit(&robot, &workshop)?;
    let source = args.robot.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let all = hydrostat_report::kit_files(&robot, &workshop, &kit, &source);
    let contents: Vec<(&str, &[u8])> = all.iter().map(|file| (file.path.as_str(), &file.bytes[..])).collect();
    files::write_folder(&args.out, &contents)?;
    let count = kit.parts.iter().map(|part| part.count).sum::<usize>();
    let stdout = format!(
        "{}\n{}\nwrote {} files to {}: {count} parts on {} sheets; open {} and cut the coupon first\n",
        check::in_words(&kit.checks),
        check::defaults(&workshop),
        all.len(),
        args.out.display(),
        kit.sheets.len(),
        args.out.join("index.html").display()
    );
    Ok(Outcome { stdout, end: End::Passed })
}
