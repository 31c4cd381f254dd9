//! Round numbers along an axis.

/// The smallest of 1, 2, 5 times a power of ten that is not below `least`.
pub(crate) fn nice_step(least: f64) -> f64 {
    if !least.is_finite() || least <= 0.0 {
        return 1.0;
    }
    let power = 10f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|m| m * power >= least * (1.0 - 1e-9));
    step.unwrap_or(10.0) * power
}

/// Multiples of `step` from `low` to `high`; none where there would be thousands.
pub(crate) fn ticks(low: f64, high: f64, step: f64) -> Vec<f64> {
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    if !(first.is_finite() && last.is_finite() && last - first < 5000.0) {
        return Vec::new();
    }
    (0..=(last - first).max(-1.0) as i64)
        .map(|i| (first + i as f64) * step)
        .take_while(|t| *t <= last * step)
        .collect()
}

/// Decimals that tell multiples of `step` apart.
pub(crate) fn decimals(step: f64) -> usize {
    if step > 0.0 && step.is_finite() {
        (-(step * 1.0001).log10().floor()).clamp(0.0, 9.0) as usize
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_ticks_are_round() {
        assert_eq!(nice_step(3.0), 5.0);
        assert_eq!(nice_step(0.0), 1.0);
        assert!((nice_step(0.012) - 0.02).abs() < 1e-15);
        assert_eq!(ticks(-1.0, 11.0, 5.0), [0.0, 5.0, 10.0]);
        assert!(ticks(0.0, f64::NAN, 1.0).is_empty());
        assert_eq!((decimals(0.02), decimals(1.0), decimals(50.0)), (2, 0, 0));
    }
}
