//! Published and exact solutions that the solver must reproduce.

/// One number of the validation table.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Heading of the table it belongs to, such as "Cantilever with a dead tip force".
    pub group: &'static str,
    /// What is compared, such as "F L^2/EI = 2, tip deflection / L".
    pub name: String,
    pub reference: f64,
    pub ours: f64,
    /// Largest admissible |ours - reference|.
    pub tolerance: f64,
    /// Where the reference comes from.
    pub source: &'static str,
    /// Why the tolerance is what it is.
    pub reason: &'static str,
}

impl Case {
    /// Whether the two agree; false for anything that is not a number.
    pub fn ok(&self) -> bool {
        (self.ours - self.reference).abs() <= self.tolerance
    }
}
