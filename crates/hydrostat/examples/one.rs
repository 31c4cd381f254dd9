#[path = "scratch.rs"]
#[allow(dead_code)]
mod scratch;
use hydrostat::statics::*;
fn main() {
    let tolerance: f64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let warm = std::env::args().nth(2).unwrap() == "warm";
    let s = Settings { tolerance, stations: 0, ..Settings::default() };
    let mut w = Workspace::default();
    let rs = [scratch::gray(0.02, 0.1176), scratch::gray(0.0202, 0.1176)];
    let n: usize = std::env::args().nth(3).unwrap().parse().unwrap();
    solve_in(&rs[1], &s, &mut w).unwrap();
    let t = std::time::Instant::now();
    for i in 0..n {
        if warm { solve_near(&rs[i % 2], &s, &mut w) } else { solve_in(&rs[0], &s, &mut w) }.unwrap();
    }
    println!("{:?}", t.elapsed() / n as u32);
}
