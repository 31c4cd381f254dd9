//! Random numbers from a seed: the same on every machine, wasm32 included.

use nalgebra::Vector3;
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::PI;

/// SplitMix64 (Steele, Lea & Flood 2014): ten lines instead of a dependency.
pub struct Random(u64);

impl Random {
    /// The stream of one index.
    pub fn new(seed: u64, index: usize) -> Random {
        let mut random = Random(seed.wrapping_mul(0xD134_2543_DE82_EF95).wrapping_add(index as u64));
        random.next();
        random
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.uniform(0.0, 1.0) < probability
    }

    /// Below `count`.
    pub fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    /// Uniform on the sphere (Archimedes).
    pub fn direction(&mut self) -> Vector3<f64> {
        let (z, angle) = (self.uniform(-1.0, 1.0), self.uniform(0.0, 2.0 * PI));
        let r = (1.0 - z * z).sqrt();
        Vector3::new(r * angle.cos(), r * angle.sin(), z)
    }

    /// A sample of the standard normal distribution with one value in each of `count` strata of equal chance, in random order
    /// (McKay, Beckman & Conover 1979).
    pub fn normal_strata(&mut self, count: usize) -> Vec<f64> {
        let normal = Normal::standard();
        let mut values: Vec<f64> = (0..count)
            .map(|i| normal.inverse_cdf((i as f64 + self.uniform(0.0, 1.0)) / count as f64))
            .collect();
        for i in (1..count).rev() {
            values.swap(i, self.below(i as u64 + 1) as usize);
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strata_have_the_moments_of_the_normal_distribution() {
        const COUNT: usize = 400;
        let values = Random::new(1, 0).normal_strata(COUNT);
        let moment = |power: i32| values.iter().map(|z| z.powi(power)).sum::<f64>() / COUNT as f64;
        // a plain sample would be off by 0.05, 0.07 and 0.5
        assert!(moment(1).abs() < 0.005, "{}", moment(1));
        assert!((moment(2) - 1.0).abs() < 0.02, "{}", moment(2));
        assert!((moment(4) - 3.0).abs() < 0.4, "{}", moment(4));
        assert_ne!(values, Random::new(1, 1).normal_strata(COUNT));
        let sorted = values.windows(2).filter(|pair| pair[0] < pair[1]).count();
        assert!((COUNT / 3..2 * COUNT / 3).contains(&sorted), "{sorted}");
    }
}
