//! `hydrostat solve --batch`.

use crate::{Folder, ROD};
use std::fmt::Write;
use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

const TENDONS: &str = r#"
[[tendon]]
name = "a"
ends = "rod"
radius = "8 mm"

[[tendon]]
name = "b"
ends = "rod"
radius = "8 mm"
angle = "90 deg"

[[load]]
name = "push"
at = "200 mm"
force = "[0, 0, 0] N"
"#;

/// The rod with two tendons, and a table of commands.
fn folder(test: &str, commands: &str) -> Folder {
    let folder = Folder::with(test, "robot.toml", format!("{ROD}{TENDONS}"));
    fs::write(folder.path("commands.csv"), commands).unwrap();
    folder
}

/// Tensions of up to 2 N; a row before every hundredth has a cell that is no number.
fn tensions(rows: usize) -> String {
    let mut text = "tension.a [N],tension.b [mN]\n".to_owned();
    for row in 0..rows {
        let (a, b) = (row * 37 % 101, row * 53 % 103);
        let broken = if row % 100 == 50 { "?" } else { "" };
        writeln!(text, "{},{}{broken}", a as f64 / 50.0, 20 * b).unwrap();
    }
    text
}

const CSV: &str = "solve robot.toml --batch commands.csv --out rows.csv";

#[test]
fn one_row_out_per_row_in_and_in_order() {
    let folder = folder("batch_rows", &tensions(200));
    let run = folder.run(CSV);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.stdout.starts_with("rows.csv: 200 rows in "), "{}", run.stdout);
    let message = "column \"tension.b [mN]\": found \"1500?\", expected a number";
    let also = "column \"tension.b [mN]\": found \"380?\", expected a number";
    let warning = format!(
        "warning: 2 of 200 rows have no solution, 0 fail a check:\n  row 51: error: {message}\n  row 151: error: {also}\n"
    );
    assert_eq!(run.stderr, warning);

    let text = fs::read_to_string(folder.path("rows.csv")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let header: Vec<&str> = lines[0].split(',').collect();
    assert_eq!(header[..5], ["row", "status", "tip_x_m", "tip_y_m", "tip_z_m"]);
    assert_eq!(
        header[14..18],
        ["a.tension_n", "a.displacement_m", "a.length_m", "a.slack"].map(|name| format!("tendon.{name}"))
    );
    assert_eq!(header[22..], ["stable", "error_estimate_m"]);
    assert_eq!(lines.len(), 201);
    for (row, line) in lines[1..].iter().enumerate() {
        assert!(line.starts_with(&format!("{},", row + 1)), "{line}");
        if row % 100 == 50 {
            let quoted = if row == 50 { message } else { also }.replace('"', "\"\"");
            assert_eq!(*line, format!("{},\"error: {quoted}\"{}", row + 1, ",".repeat(22)));
        } else {
            let cells: Vec<&str> = line.split(',').collect();
            let tension: f64 = cells[18].parse().unwrap();
            assert_eq!((cells[1], cells.len(), tension), ("ok", 24, (row * 53 % 103) as f64 / 50.0));
        }
    }
    assert_eq!(folder.files(), ["commands.csv", "robot.toml", "rows.csv"]);
}

#[test]
fn the_same_to_the_last_bit_on_one_and_two_threads() {
    let folder = folder("batch_threads", &tensions(300));
    let rows = ["1", "2"].map(|threads| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hydrostat"));
        command.args(CSV.split_whitespace()).current_dir(&folder.0).env("RAYON_NUM_THREADS", threads);
        assert_eq!(command.output().unwrap().status.code(), Some(1));
        fs::read(folder.path("rows.csv")).unwrap()
    });
    assert!(rows[0] == rows[1]);
}

#[test]
fn a_column_of_a_tendon_that_a_flag_commands_is_warned_of() {
    let folder = folder("batch_flag", "tension.a [N],displacement.b [mm]\n1,0\n");
    let run = folder.run(&format!("{CSV} --tension a=2N --displacement b=1mm"));
    assert_eq!(run.code, 0);
    assert_eq!(run.stderr, "warning: the table's columns replace the flags' commands of a, b\n");
    fs::write(folder.path("commands.csv"), "tension.a [N]\n1\n").unwrap();
    folder.run(&format!("{CSV} --tension b=2N")).succeeds();
}

#[test]
fn a_failing_check_is_a_status() {
    let folder =
        folder("batch_check", "displacement.a [mm],tension.b [N],load.push.force z [N]\n-3,30,0\n1,0,0.1\n");
    let run = folder.run(CSV);
    assert_eq!(run.code, 1);
    assert_eq!(
        run.stderr,
        "warning: 0 of 2 rows have no solution, 1 fail a check:\n  row 1: check failed: strain\n"
    );
    let text = fs::read_to_string(folder.path("rows.csv")).unwrap();
    assert!(text.lines().nth(1).unwrap().starts_with("1,\"check failed: strain\",-0."), "{text}");
    assert!(text.lines().nth(2).unwrap().starts_with("2,ok,0."), "{text}");
}

/// The whole message; nothing is written.
#[track_caller]
fn refused(table: &str, out: &str, message: &str) {
    let folder = folder(&format!("batch_refused_{}", message.len()), table);
    let run = folder.run(&format!("solve robot.toml --batch commands.csv --out {out}"));
    assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{run:?}");
    assert_eq!(run.stderr, format!("error: {message}\n"));
    assert_eq!(folder.files(), ["commands.csv", "robot.toml"]);
}

#[test]
fn a_wrong_table_is_refused_before_anything_is_written() {
    let place = |column: usize, header: &str, width: usize| {
        let marks = format!("{}{}", " ".repeat(column - 1), "^".repeat(width));
        format!(" --> commands.csv:1:{column}\n  |\n1 | {header}\n  | {marks}")
    };
    for (header, column, width, message, hint) in [
        ("tension.a [N],tension.z [N]", 15, 13, "there is no tendon \"z\"", "tendons of this robot: a, b"),
        ("tensoin.a [N]", 1, 13, "unknown column \"tensoin.a\"", "did you mean \"tension.a\"?"),
        (
            "tension.a [N],displacement.a [mm]",
            15,
            19,
            "the columns \"tension.a [N]\" and \"displacement.a [mm]\" set the same",
            "keep one of them; a tendon has a tension or a displacement",
        ),
        (
            "tension.a [N],tension.a [N]",
            15,
            13,
            "the columns \"tension.a [N]\" and \"tension.a [N]\" set the same",
            "keep one of them; a tendon has a tension or a displacement",
        ),
        (
            "tension.a",
            1,
            9,
            "the column \"tension.a\" has no unit, expected a force, such as \"0.5 N\"",
            "write the unit in brackets, as in \"tension.a [N]\"",
        ),
    ] {
        let table = format!("{header}\n1,2\n");
        refused(&table, "rows.csv", &format!("{message}\n{}\nhint: {hint}", place(column, header, width)));
    }
    let message = "found a length, expected a force, such as \"0.5 N\"";
    refused("tension.a [mm]\n1\n", "rows.csv", &format!("{message}\n{}", place(1, "tension.a [mm]", 14)));
}

#[test]
fn a_wrong_file_is_refused() {
    let table = tensions(2);
    refused(&table, "rows.xlsx", "cannot write rows into rows.xlsx: expected a file .parquet or .csv");
    refused(&table, "no/rows.csv", "cannot write no/rows.csv: its folder does not exist");
    refused(
        &table,
        "rows.csv --stations 5",
        "a table has no room for stations in rows.csv\nhint: name a file .parquet, or leave --stations out",
    );
    let folder = folder("batch_alone", &table);
    folder.run("solve robot.toml --batch commands.csv").refuses(&["--out"]);
    folder.run("solve robot.toml --out rows.csv").refuses(&["--batch"]);
}

/// Rows in the file, and how many there are after Ctrl-C in the middle.
#[cfg(unix)]
fn interrupted(folder: &Folder, out: &str) -> usize {
    fs::write(folder.path(out), "an older file").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_hydrostat"));
    command.args(["solve", "robot.toml", "--batch", "commands.csv", "--out", out]).current_dir(&folder.0);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while folder.files().len() < 4 {
        std::thread::sleep(Duration::from_millis(5)); // the new file beside the older one is not there yet
    }
    std::thread::sleep(Duration::from_millis(300));
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert_eq!(folder.files().len(), 3);
    let (_, message) = stderr.split_once("interrupted: ").unwrap();
    let (rows, rest) = message.split_once(' ').unwrap();
    assert_eq!(rest, format!("of 60000 rows are in {out}\n"));
    rows.parse().unwrap()
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_the_rows_that_are_done() {
    let folder = folder("batch_ctrl_c", &tensions(60_000));
    let done = interrupted(&folder, "rows.csv");
    let text = fs::read_to_string(folder.path("rows.csv")).unwrap();
    assert!(text.ends_with('\n'));
    for (row, line) in text.lines().skip(1).enumerate() {
        assert!(line.starts_with(&format!("{},", row + 1)));
        assert_eq!(line.split(',').count(), if row % 100 == 50 { 25 } else { 24 }, "{line}");
    }
    assert_eq!(text.lines().count() - 1, done);
    assert!(0 < done && done < 60_000, "{done}");
}

/// Ends between the first Ctrl-C and the end of the rows that are being solved; before that the older file is not touched.
#[cfg(unix)]
#[test]
fn a_second_ctrl_c_leaves_no_new_file() {
    let folder = folder("batch_ctrl_c_twice", &tensions(60_000));
    let mut command = Command::new(env!("CARGO_BIN_EXE_hydrostat"));
    command.args(CSV.split_whitespace()).current_dir(&folder.0);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while folder.files().len() < 3 {
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(300));
    let twice = format!("kill -INT {0}; sleep 0.002; kill -INT {0}", child.id());
    Command::new("sh").args(["-c", &twice]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let left = folder.files();
    assert!(left.iter().all(|name| !name.ends_with(".tmp")), "{left:?}");
}

#[cfg(feature = "parquet")]
mod parquet {
    use super::*;
    use ::parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
    use arrow_array::cast::AsArray;
    use arrow_array::types::{Float64Type, UInt64Type};
    use arrow_array::{Array, RecordBatch};

    /// Of a position, m: the tip and the last station are computed in two ways.
    const ROUNDING: f64 = 1e-14;

    fn read(folder: &Folder) -> Vec<RecordBatch> {
        let file = fs::File::open(folder.path("rows.parquet")).unwrap();
        let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap().build().unwrap();
        reader.map(Result::unwrap).collect()
    }

    /// What is in the Parquet file is what is in the CSV file, and the stations end at the tip.
    #[test]
    fn parquet_has_what_csv_has() {
        let folder = folder("batch_parquet", &tensions(150));
        assert_eq!(folder.run(CSV).code, 1);
        let run = "solve robot.toml --batch commands.csv --out rows.parquet --stations 5";
        assert_eq!(folder.run(run).code, 1);
        let text = fs::read_to_string(folder.path("rows.csv")).unwrap();
        let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        let mut lines = text.lines().skip(1);
        for batch in read(&folder) {
            let schema = batch.schema();
            let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
            let stations = ["stations_x_m", "stations_y_m", "stations_z_m"];
            assert_eq!(names, [header.clone(), stations.to_vec()].concat());
            let number = |name: &str| batch.column_by_name(name).unwrap().as_primitive::<Float64Type>();
            let status = batch.column_by_name("status").unwrap().as_string::<i32>();
            for row in 0..batch.num_rows() {
                let line = lines.next().unwrap();
                if row % 100 == 50 {
                    assert!(
                        status.value(row).starts_with("error: column ") && number("tip_x_m").is_null(row)
                    );
                    continue;
                }
                let cells: Vec<&str> = line.split(',').collect();
                let value = |name: &str| cells[header.iter().position(|known| *known == name).unwrap()];
                for name in ["tip_x_m", "tip_r32", "tendon.b.displacement_m", "error_estimate_m"] {
                    assert_eq!(number(name).value(row), value(name).parse::<f64>().unwrap(), "{name}");
                }
                let slack = batch.column_by_name("tendon.a.slack").unwrap().as_boolean();
                assert_eq!(
                    (status.value(row), slack.value(row).to_string().as_str()),
                    ("ok", value("tendon.a.slack"))
                );
                let list = batch.column_by_name("stations_x_m").unwrap().as_fixed_size_list().value(row);
                let list = list.as_primitive::<Float64Type>();
                assert_eq!(list.len(), 5);
                assert!((list.value(4) - number("tip_x_m").value(row)).abs() < ROUNDING);
            }
        }
        assert_eq!(lines.next(), None);
    }

    #[cfg(unix)]
    #[test]
    fn ctrl_c_leaves_a_file_that_opens() {
        let folder = folder("batch_ctrl_c_parquet", &tensions(60_000));
        let done = interrupted(&folder, "rows.parquet");
        let rows = read(&folder).into_iter().flat_map(|batch| {
            let row = batch.column_by_name("row").unwrap().as_primitive::<UInt64Type>();
            row.values().to_vec()
        });
        assert!(rows.eq(1..=done as u64));
        assert!(0 < done && done < 60_000, "{done}");
    }
}
