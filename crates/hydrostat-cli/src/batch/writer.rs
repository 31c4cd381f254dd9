//! Writes the rows of a batch: the kind of file by its ending.

#[cfg(feature = "parquet")]
use super::parquet::Parquet;
use super::table::{Table, Values};
use crate::files::{NewFile, refused_to_write};
use hydrostat::Error;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A file of rows that is not under its name before it is complete.
pub(super) struct Writer {
    path: PathBuf,
    new: NewFile,
    kind: Kind,
}

enum Kind {
    Csv,
    #[cfg(feature = "parquet")]
    Parquet(Box<Parquet>),
}

/// Refuses a name whose ending says no kind, or one that cannot hold what is asked.
pub(super) fn check_name(path: &Path, stations: usize) -> Result<(), Error> {
    let name = path.display();
    match ending(path).as_deref() {
        Some("csv") if stations > 0 => Err(Error::new(format!("a table has no room for stations in {name}"))
            .hint("name a file .parquet, or leave --stations out")),
        Some("csv") => Ok(()),
        Some("parquet") if cfg!(feature = "parquet") => Ok(()),
        Some("parquet") => Err(Error::new("this build of hydrostat writes CSV only")
            .hint("name a file .csv, or build with `--features parquet`")),
        _ => Err(Error::new(format!("cannot write rows into {name}: expected a file .parquet or .csv"))),
    }
}

fn ending(path: &Path) -> Option<String> {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase())
}

impl Writer {
    /// `columns`: a table without rows.
    pub(super) fn create(path: &Path, columns: &Table) -> Result<Writer, Error> {
        let mut new = NewFile::create(path)?;
        let refused = |error: std::io::Error| refused_to_write(path, &error);
        let kind = match ending(path).as_deref() {
            #[cfg(feature = "parquet")]
            Some("parquet") => {
                let file = new.file.try_clone().map_err(refused)?;
                Kind::Parquet(Box::new(Parquet::create(file, columns).map_err(refused)?))
            }
            _ => {
                let names: Vec<&str> = columns.columns.iter().map(|(name, _)| name.as_str()).collect();
                new.file
                    .write_all(format!("row,status,{}\n", names.join(",")).as_bytes())
                    .map_err(refused)?;
                Kind::Csv
            }
        };
        Ok(Writer { path: path.to_owned(), new, kind })
    }

    /// Where the rows are until the file is complete.
    pub(super) fn beside(&self) -> &Path {
        &self.new.beside
    }

    pub(super) fn write(&mut self, table: &Table) -> Result<(), Error> {
        let written = match &mut self.kind {
            Kind::Csv => self.new.file.write_all(csv(table).as_bytes()),
            #[cfg(feature = "parquet")]
            Kind::Parquet(parquet) => parquet.write(table),
        };
        written.map_err(|error| refused_to_write(&self.path, &error))
    }

    /// Closes the file and puts it in its place.
    pub(super) fn finish(self) -> Result<(), Error> {
        #[cfg(feature = "parquet")]
        if let Kind::Parquet(parquet) = self.kind {
            parquet.close().map_err(|error| refused_to_write(&self.path, &error))?;
        }
        self.new.finish()
    }
}

/// The rows as text; what is not known is an empty cell.
fn csv(table: &Table) -> String {
    let mut text = String::new();
    for (i, (row, status)) in table.row.iter().zip(&table.status).enumerate() {
        let quoted = |status: &str| format!("\"{}\"", status.replace('"', "\"\""));
        let _ = write!(text, "{row},{}", if status == "ok" { "ok".to_owned() } else { quoted(status) });
        for (_, values) in &table.columns {
            let _ = match values {
                _ if !table.solved[i] => write!(text, ","),
                Values::Numbers(numbers) => write!(text, ",{:?}", numbers[i]),
                Values::Flags(flags) => match flags[i] {
                    Some(flag) => write!(text, ",{flag}"),
                    None => write!(text, ","),
                },
                Values::Lists(..) => unreachable!("`check_name` refuses stations"),
            };
        }
        text.push('\n');
    }
    text
}
