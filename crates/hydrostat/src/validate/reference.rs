//! The mathematics of the references: quadrature, elliptic integrals, roots. Nothing here is used by the solver.

use std::f64::consts::FRAC_PI_2;

/// Root of a function that changes sign once in the interval; NaN where it does not.
pub(super) fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let sign = f(low).signum();
    if sign == f(high).signum() {
        return f64::NAN;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if f(middle).signum() == sign {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Nodes and weights of Gauss-Legendre quadrature on [0, 1]; the nodes are Newton's roots of the Legendre polynomial.
fn gauss_legendre<const N: usize>() -> [(f64, f64); N] {
    std::array::from_fn(|i| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (N as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut p, mut before) = (1.0, 0.0);
            for k in 1..=N {
                let k = k as f64;
                (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
            }
            slope = N as f64 * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

/// Integral over [0, 1] of three smooth functions at once, 16 panels of 16 nodes.
pub(super) fn integrate(f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    const PANELS: usize = 16;
    let rule = gauss_legendre::<16>();
    let mut sum = [0.0; 3];
    for panel in 0..PANELS {
        for (node, weight) in rule {
            let values = f((panel as f64 + node) / PANELS as f64);
            for (total, value) in sum.iter_mut().zip(values) {
                *total += weight / PANELS as f64 * value;
            }
        }
    }
    sum
}

/// Legendre's incomplete elliptic integrals F(phi, k) and E(phi, k), 0 <= phi <= pi/2, by Carlson's duplication
/// (Carlson 1995, Numerical Algorithms 10). Thirty lines; a crate would be a dependency of every user for one table.
pub(super) fn elliptic(phi: f64, k: f64) -> (f64, f64) {
    let (sine, cosine) = if phi == FRAC_PI_2 { (1.0, 0.0) } else { phi.sin_cos() };
    let (x, y) = (cosine * cosine, 1.0 - (k * sine).powi(2));
    let (rf, rd) = carlson(x, y);
    (sine * rf, sine * rf - k * k / 3.0 * sine.powi(3) * rd)
}

/// Carlson's symmetric integrals R_F(x, y, 1) and R_D(x, y, 1).
fn carlson(mut x: f64, mut y: f64) -> (f64, f64) {
    let mut z: f64 = 1.0;
    let (mut sum, mut scale) = (0.0, 1.0);
    // Each duplication divides the spread of x, y, z by four: 30 leave it below rounding.
    for _ in 0..30 {
        let lambda = (x * y).sqrt() + (y * z).sqrt() + (z * x).sqrt();
        sum += scale / (z.sqrt() * (z + lambda));
        scale /= 4.0;
        (x, y, z) = ((x + lambda) / 4.0, (y + lambda) / 4.0, (z + lambda) / 4.0);
    }
    (1.0 / z.sqrt(), 3.0 * sum + scale / (z * z.sqrt()))
}

/// Integral of the planar weight-loaded elastica from its tip: phi_tt = -beta t cos(phi), phi(0) = phi_tip, phi_t(0) = 0,
/// by Taylor series; returns phi(1) and the integrals of cos(phi) and sin(phi) over [0, 1].
pub(super) fn weight_elastica(beta: f64, phi_tip: f64) -> [f64; 3] {
    const STEPS: usize = 16;
    const ORDER: usize = 20;
    let h = 1.0 / STEPS as f64;
    let (mut phi, mut slope, mut x, mut y) = (phi_tip, 0.0, 0.0, 0.0);
    for step in 0..STEPS {
        let t = step as f64 * h;
        // Coefficients of phi, cos(phi), sin(phi) in powers of the step.
        let (mut p, mut c, mut s) = ([0.0; ORDER + 2], [0.0; ORDER], [0.0; ORDER]);
        (p[0], p[1]) = (phi, slope);
        for k in 0..ORDER {
            if k == 0 {
                (s[0], c[0]) = phi.sin_cos();
            } else {
                for j in 1..=k {
                    let weight = j as f64 / k as f64 * p[j];
                    c[k] -= weight * s[k - j];
                    s[k] += weight * c[k - j];
                }
            }
            let before = if k == 0 { 0.0 } else { c[k - 1] };
            p[k + 2] = -beta * (t * c[k] + before) / ((k + 2) * (k + 1)) as f64;
        }
        phi = p.iter().rev().fold(0.0, |sum, a| sum * h + a);
        slope = (1..ORDER + 2).rev().fold(0.0, |sum, k| sum * h + k as f64 * p[k]);
        x += (0..ORDER).rev().fold(0.0, |sum, k| sum * h + c[k] / (k + 1) as f64) * h;
        y += (0..ORDER).rev().fold(0.0, |sum, k| sum * h + s[k] / (k + 1) as f64) * h;
    }
    [phi, x, y]
}

/// Value at 1 of the power series of phi'' + lambda t^power phi = 0, phi(0) = 1, phi'(0) = 0 (Bessel functions of order
/// -1/(power + 2) in disguise).
pub(super) fn buckling_mode(lambda: f64, power: usize) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for n in 1..60 {
        let exponent = (n * (power + 2)) as f64;
        term *= -lambda / (exponent * (exponent - 1.0));
        sum += term;
    }
    sum
}

/// Saint-Venant's torsion constant of a rectangle (Timoshenko & Goodier, Theory of Elasticity, art. 109).
pub(super) fn torsion_constant(width: f64, height: f64) -> f64 {
    let (a, b) = (width.max(height), width.min(height));
    let series: f64 =
        (0..200).map(|i| (2 * i + 1) as f64).map(|n| (n * FRAC_PI_2 * a / b).tanh() / n.powi(5)).sum();
    a * b.powi(3) / 3.0 * (1.0 - 192.0 / std::f64::consts::PI.powi(5) * b / a * series)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz & Stegun, tables 17.1, 17.5 and 17.6: rounding of the printed digits.
    #[test]
    fn elliptic_integrals_match_tables() {
        let (f, e) = elliptic(FRAC_PI_2, 0.5_f64.sqrt());
        assert!((f - 1.854_074_677_301_372).abs() < 1e-14 && (e - 1.350_643_881_047_675).abs() < 1e-14);
        let (f, e) = elliptic(30_f64.to_radians(), 45_f64.to_radians().sin());
        assert!((f - 0.535_622_73).abs() < 1e-8 && (e - 0.512_049_32).abs() < 1e-8);
    }

    /// First zeros behind the classical constants 2.4674, 7.8373 and 4.0126 (Timoshenko & Gere 1961).
    #[test]
    fn buckling_modes_have_the_classical_zeros() {
        let zero = |power, high| bisect(0.1, high, |lambda| buckling_mode(lambda, power));
        assert!((zero(0, 4.0) - std::f64::consts::PI.powi(2) / 4.0).abs() < 1e-13);
        assert!((zero(1, 12.0) - 7.8373).abs() < 1e-4);
        assert!((zero(2, 30.0).sqrt() - 4.0126).abs() < 1e-4);
    }

    /// The square's published constant, 0.140577 (Timoshenko & Goodier, table in art. 109: 0.1406).
    #[test]
    fn torsion_of_a_square() {
        assert!((torsion_constant(1.0, 1.0) - 0.140_577_0).abs() < 1e-6);
    }

    /// A node rule of order 32 integrates t^31 exactly.
    #[test]
    fn quadrature_is_exact_for_polynomials() {
        let [a, b, c] = integrate(|t| [1.0, t, t.powi(31)]);
        assert!((a - 1.0).abs() < 1e-14 && (b - 0.5).abs() < 1e-14 && (c - 1.0 / 32.0).abs() < 1e-15);
    }
}
