//! Reads and writes files; every refusal names the file and the reason.

use hydrostat::Error;
use hydrostat::description::templates;
use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// Larger than any table of a bench.
const LARGEST_INPUT: u64 = 64 << 20;
/// Some ten million commands.
const LARGEST_TABLE: u64 = 1 << 30;

/// Reads a UTF-8 text: a robot, a bench or its table.
pub(crate) fn read_text(path: &Path) -> Result<String, Error> {
    read_up_to(path, LARGEST_INPUT, "a robot, a bench or its table")
}

/// Reads a table of commands.
pub(crate) fn read_table(path: &Path) -> Result<String, Error> {
    read_up_to(path, LARGEST_TABLE, "a table of commands; split it")
}

fn read_up_to(path: &Path, largest: u64, expected: &str) -> Result<String, Error> {
    let name = path.display();
    let refused = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => Error::new(format!("no file named {name}")).hint("check the path"),
        ErrorKind::PermissionDenied => Error::new(format!("no permission to read {name}")),
        _ => Error::new(format!("cannot read {name}: {error}")),
    };
    let file = fs::File::open(path).map_err(refused)?;
    if file.metadata().map_err(refused)?.is_dir() {
        return Err(Error::new(format!("{name} is a folder, expected a file")).hint("name a file inside it"));
    }
    let mut bytes = Vec::new();
    file.take(largest + 1).read_to_end(&mut bytes).map_err(refused)?;
    if bytes.len() as u64 > largest {
        let limit = largest >> 20;
        return Err(Error::new(format!("{name} is larger than {limit} MiB, expected {expected}")));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..good].iter().filter(|&&byte| byte == b'\n').count();
        Error::new(format!("{name} is not UTF-8 text: bad byte in line {line}"))
            .hint("save the file as UTF-8")
    })?;
    // spreadsheets mark UTF-8 so
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}

/// Refuses an output that would replace an input, by whatever path, before there is anything to write.
pub(crate) fn refuse_replacing(
    flag: &str,
    output: &Path,
    inputs: &[(&str, Option<&Path>)],
) -> Result<(), Error> {
    // what does not exist replaces nothing
    let Ok(output) = fs::canonicalize(output) else { return Ok(()) };
    let same = |input: &Option<&Path>| {
        input.is_some_and(|input| fs::canonicalize(input).is_ok_and(|input| input == output))
    };
    match inputs.iter().find(|(_, input)| same(input)) {
        Some((what, _)) => Err(Error::new(format!("{flag} would replace {what}")).hint("name another file")),
        None => Ok(()),
    }
}

/// Writes a file completely or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    // a device or pipe cannot be replaced
    if fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir()) {
        return fs::write(path, bytes).map_err(|error| refused_to_write(path, &error));
    }
    let mut new = NewFile::create(path)?;
    new.file.write_all(bytes).map_err(|error| refused_to_write(path, &error))?;
    new.finish()
}

/// A file that is written beside its place and renamed over it when it is complete; dropped before, nothing has changed.
pub(crate) struct NewFile {
    pub(crate) file: fs::File,
    path: PathBuf,
    target: PathBuf,
    pub(crate) beside: PathBuf,
}

impl NewFile {
    pub(crate) fn create(path: &Path) -> Result<NewFile, Error> {
        // a link stays a link
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let refused = |what: &str| Err(Error::new(format!("cannot write {}: {what}", path.display())));
        match fs::metadata(&target) {
            Ok(meta) if meta.is_dir() => return refused("it is a folder"),
            Ok(meta) if !meta.is_file() => return refused("it is a device or a pipe"),
            _ => {}
        }
        let Some(name) = target.file_name() else {
            return refused("it names no file");
        };
        let beside = target.with_file_name(format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id()));
        let file = fs::File::create_new(&beside).map_err(|error| refused_to_write(path, &error))?;
        Ok(NewFile { file, path: path.to_owned(), target, beside })
    }

    pub(crate) fn finish(self) -> Result<(), Error> {
        let done = self.file.sync_all().and_then(|()| fs::rename(&self.beside, &self.target));
        done.map_err(|error| refused_to_write(&self.path, &error))
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.beside); // gone already where it was renamed
    }
}

pub(crate) fn refused_to_write(path: &Path, error: &std::io::Error) -> Error {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if folder.is_some_and(|folder| !folder.exists()) {
        return Error::new(format!("cannot write {}: its folder does not exist", path.display()));
    }
    Error::new(format!("cannot write {}: {error}", path.display()))
}

/// Writes files that must not exist yet; on failure none of them is left.
pub(crate) fn create_all(files: &[templates::File]) -> Result<(), Error> {
    for (i, templates::File { name, text }) in files.iter().enumerate() {
        let Err((made, error)) = write_new(Path::new(name), text.as_bytes()) else {
            continue;
        };
        let ours = if made { &files[..=i] } else { &files[..i] };
        for templates::File { name, .. } in ours {
            let _ = fs::remove_file(name);
        }
        return Err(match error.kind() {
            ErrorKind::AlreadyExists => Error::new(format!("{name} exists already and is left as it is"))
                .hint("choose another name or move the file away"),
            _ => Error::new(format!("cannot write {name}: {error}")),
        });
    }
    Ok(())
}

/// Refuses a path that cannot become a folder, before there is anything to put into it.
pub(crate) fn refuse_file(folder: &Path) -> Result<(), Error> {
    if folder.exists() && !folder.is_dir() {
        let message = format!("{} exists and is not a folder", folder.display());
        return Err(Error::new(message).hint("name another folder"));
    }
    Ok(())
}

/// Makes a folder and those above it.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Error> {
    fs::create_dir_all(folder)
        .map_err(|error| Error::new(format!("cannot make the folder {}: {error}", folder.display())))
}

/// Writes a file that must not exist; an error says whether the file was made before it.
fn write_new(path: &Path, bytes: &[u8]) -> Result<(), (bool, std::io::Error)> {
    let mut file = fs::File::create_new(path).map_err(|error| (false, error))?;
    file.write_all(bytes).and_then(|()| file.sync_all()).map_err(|error| (true, error))
}

/// Refuses a folder that something would be lost from, before there is anything to put into it.
pub(crate) fn refuse_full_folder(folder: &Path, force: bool, input: &Path) -> Result<(), Error> {
    refuse_file(folder)?;
    if !folder.exists() {
        return Ok(());
    }
    let name = folder.display();
    let cannot_read = |error| Error::new(format!("cannot read the folder {name}: {error}"));
    let mut entries = fs::read_dir(folder).map_err(cannot_read)?;
    if entries.next().is_none() {
        return Ok(());
    }
    if !force {
        return Err(Error::new(format!("the folder {name} is not empty and is left as it is"))
            .hint("name another folder, or replace this one with all that is in it by --force"));
    }
    let holds = |path: &Path| match (fs::canonicalize(folder), fs::canonicalize(path)) {
        (Ok(folder), Ok(path)) => path.starts_with(folder),
        _ => false,
    };
    let here = std::env::current_dir().unwrap_or_default();
    match [("the robot file", input), ("the current folder", &here)].into_iter().find(|(_, path)| holds(path))
    {
        Some((what, _)) => Err(Error::new(format!("--force would remove {what}, which lies in {name}"))
            .hint("name another folder")),
        None => Ok(()),
    }
}

/// Writes a folder completely or not at all: beside its place first, then renamed. What stood there is removed last.
pub(crate) fn write_folder(folder: &Path, contents: &[(&str, &[u8])]) -> Result<(), Error> {
    // a link stays a link
    let target = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    let refused = |error: std::io::Error| refused_to_write(folder, &error);
    let Some(name) = target.file_name().map(|name| name.to_string_lossy().into_owned()) else {
        return Err(
            Error::new(format!("{} cannot be replaced", folder.display())).hint("name a folder in it")
        );
    };
    let beside = |what: &str| target.with_file_name(format!(".{name}.{}.{what}", std::process::id()));
    let (new, old) = (beside("new"), beside("old"));
    let write = || -> std::io::Result<()> {
        fs::create_dir(&new)?;
        for (path, bytes) in contents {
            let path = new.join(path);
            fs::create_dir_all(path.parent().unwrap_or(&new))?;
            let mut file = fs::File::create_new(&path)?;
            file.write_all(bytes)?;
        }
        if target.exists() {
            fs::rename(&target, &old)?;
        }
        fs::rename(&new, &target)
    };
    if let Err(error) = write() {
        let _ = fs::remove_dir_all(&new);
        if old.exists() && !target.exists() {
            let _ = fs::rename(&old, &target);
        }
        return Err(refused(error));
    }
    if old.exists() {
        fs::remove_dir_all(&old).map_err(refused)?;
    }
    Ok(())
}
