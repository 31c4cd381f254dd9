//! Instructions per solve, by valgrind: the same on every run, whatever else the machine does.

use super::{capture, command, run};

/// Cases of `crates/hydrostat/examples/count.rs`, and what they are called.
const CASES: [(&str, &str); 7] = [
    ("channel-cold", "SCR in channels, cold"),
    ("channel-warm", "the same, warm"),
    ("displacement-warm", "the same by displacement, warm"),
    ("jacobian-cold", "the same with Jacobian and compliance, cold"),
    ("guides-cold", "SCR between 30 guides, cold"),
    ("guides-warm", "the same, warm"),
    ("two-sections-warm", "two sections, 6 tendons, 20 guides, warm"),
];
/// Lengths of the two loops whose difference is taken: what happens once falls out.
const FEW: usize = 20;
const MANY: usize = 120;

/// Prints a table of them.
pub(super) fn count() -> Result<(), String> {
    capture(&["valgrind", "--version"])
        .map_err(|error| format!("{error}\nhint: install valgrind, on Debian `apt-get install valgrind`"))?;
    run(&["cargo", "build", "--release", "--quiet", "-p", "hydrostat", "--example", "count"])?;
    println!("| case | instructions per solve |\n|---|---:|");
    for (case, name) in CASES {
        let per_solve = (instructions(case, MANY)? - instructions(case, FEW)?) / (MANY - FEW) as u64;
        println!("| {name} | {} |", grouped(per_solve));
    }
    Ok(())
}

fn instructions(case: &str, times: usize) -> Result<u64, String> {
    let times = times.to_string();
    let words =
        ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", "target/release/examples/count"];
    let output = command(&words).args([case, &times]).output();
    let output = output.map_err(|error| format!("cannot run `{}`: {error}", words.join(" ")))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let collected = text.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok());
    collected.filter(|_| output.status.success()).ok_or_else(|| format!("valgrind counted nothing:\n{text}"))
}

/// Thousands apart.
fn grouped(number: u64) -> String {
    if number < 1000 {
        number.to_string()
    } else {
        format!("{},{:03}", grouped(number / 1000), number % 1000)
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn thousands_are_apart() {
        assert_eq!(super::grouped(12_034_005), "12,034,005");
        assert_eq!(super::grouped(999), "999");
    }
}
