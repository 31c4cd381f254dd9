use super::*;
use crate::description::{CalibrationFlags, builtin};

#[test]
fn gray() {
    for freed in builtin::FREED {
        let flags = CalibrationFlags { free: vec![freed.to_owned()], ..CalibrationFlags::default() };
        let problem = builtin::calibration(&flags).expect("is valid").value;
        let now = std::time::Instant::now();
        let found = calibrate(&problem, &Settings::default()).expect("fits");
        eprintln!("{:?} {:?}\n{found:#?}", now.elapsed(), found.parameters);
    }
}
