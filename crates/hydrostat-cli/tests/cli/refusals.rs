//! Wrong input: a clear message, exit code 2, nothing on stdout.

use crate::{Folder, ROD};

/// `solve` of a rod in which `old` is replaced by `new`; the message names that line.
#[track_caller]
fn refused(test: &str, old: &str, new: &str, words: &[&str]) {
    let text = ROD.replace(old, new);
    let line = 1 + text.lines().position(|line| line.contains(new)).unwrap();
    let folder = Folder::with(test, "rod.toml", text);
    folder.run("solve rod.toml --json").refuses(&[words, &[&format!("rod.toml:{line}:")]].concat());
}

/// `verify` of a bench with this table.
#[track_caller]
fn refused_table(test: &str, table: &str, words: &[&str]) {
    let folder = bench(test);
    std::fs::write(folder.path("try.csv"), table).unwrap();
    folder.run("verify try.toml --json").refuses(words);
}

/// The starter bench, which names the table `try.csv`.
pub(crate) fn bench(test: &str) -> Folder {
    let folder = Folder::new(test);
    folder.run("new bench try").succeeds();
    folder
}

fn header(folder: &Folder) -> String {
    let table = std::fs::read_to_string(folder.path("try.csv")).unwrap();
    table.lines().find(|line| !line.starts_with('#')).unwrap().to_owned()
}

#[test]
fn a_bare_number() {
    refused("bare", "length = \"390 mm\"", "length = 390", &["390", "unit", "section", "length"]);
}

#[test]
fn a_wrong_unit() {
    let words = ["6.80 mm", "density", "kg/m^3"];
    refused("wrong_unit", "6.45 g/cm^3", "6.80 mm", &words);
}

#[test]
fn a_negative_length() {
    refused("negative", "\"390 mm\"", "\"-390 mm\"", &["-390 mm", "length"]);
}

#[test]
fn not_a_number() {
    refused("nan", "poisson_ratio = 0.33", "poisson_ratio = nan", &["poisson_ratio", "nan"]);
    refused("nan_quantity", "\"390 mm\"", "\"nan mm\"", &["length", "nan"]);
}

#[test]
fn an_unknown_key() {
    let words = ["poison_ratio", "poisson_ratio", "hint: "];
    refused("unknown_key", "poisson_ratio", "poison_ratio", &words);
}

#[test]
fn an_empty_file() {
    let folder = Folder::with("empty", "rod.toml", "");
    folder.run("solve rod.toml").refuses(&["rod.toml", "empty"]);
    folder.run("verify rod.toml").refuses(&["rod.toml", "empty"]);
}

#[test]
fn a_missing_column() {
    let header = header(&bench("column_header"));
    let (fewer, last) = header.rsplit_once(',').unwrap();
    let row = vec!["12.7"; fewer.split(',').count()].join(",");
    let name = last.split(" [").next().unwrap();
    refused_table("column", &format!("{fewer}\n{row}\n"), &["try.csv", "column", name]);
}

#[test]
fn a_cell_that_is_no_number() {
    let header = header(&bench("cell_header"));
    let row = vec!["12.7"; header.split(',').count() - 1].join(",");
    refused_table("cell", &format!("{header}\n{row},much\n"), &["try.csv", "much", "2"]);
}

#[test]
fn an_absurd_density() {
    refused("absurd", "6.45 g/cm^3", "6.80 g/mm^3", &["density", "6.80 g/mm^3", "6.80 g/cm^3"]);
}

#[test]
fn a_folder_instead_of_a_file() {
    let folder = Folder::new("folder");
    std::fs::create_dir(folder.path("rods")).unwrap();
    folder.run("solve rods").refuses(&["rods is a folder", "expected a file"]);
    folder.run("verify rods").refuses(&["rods is a folder"]);
    folder.run("validate --data rods").refuses(&["rods", "no file named"]);
}

#[test]
fn a_missing_file() {
    let folder = Folder::new("missing");
    folder.run("solve rod.toml").refuses(&["no file named rod.toml"]);
    folder.run("verify bench.toml").refuses(&["no file named bench.toml"]);
}

#[test]
fn a_file_that_is_no_text() {
    let folder = Folder::with("binary", "rod.toml", b"name = \"rod\"\nlength = \xff\xfe\n");
    folder.run("solve rod.toml").refuses(&["rod.toml is not UTF-8", "line 2"]);
}

#[test]
fn a_huge_file() {
    let folder = Folder::new("huge");
    let file = std::fs::File::create(folder.path("rod.toml")).unwrap();
    file.set_len(1 << 32).unwrap(); // sparse: takes no room on the disk
    folder.run("solve rod.toml").refuses(&["rod.toml is larger than 64 MiB"]);
}

#[test]
fn wrong_flags() {
    let folder = Folder::with("flags", "rod.toml", ROD);
    for arguments in [
        "",
        "bend rod.toml",
        "solve",
        "solve rod.toml --tension a=2N",
        "solve rod.toml --json --csv",
        "solve rod.toml --csv --jacobian",
        "solve rod.toml --stations 1",
        "solve rod.toml --stations many",
        "solve rod.toml --tolerance -1",
        "solve rod.toml --tolerance nan",
        "solve rod.toml --method guess",
        "solve rod.toml --shooting-intervals 0",
        "solve rod.toml --shooting-intervals 3",
        "solve rod.toml --shooting-intervals 3 --method energy",
        "new robot x",
    ] {
        let run = folder.run(arguments);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{arguments}: {run:?}");
        assert!(!run.stderr.is_empty());
    }
}

#[test]
fn derivatives_need_the_energy_method() {
    let folder = Folder::with("derivatives_refused", "rod.toml", ROD);
    let by_shooting = folder.run("solve rod.toml --compliance --method shooting");
    by_shooting.refuses(&["derivatives come from the energy method", "solve with the energy method"]);
}
