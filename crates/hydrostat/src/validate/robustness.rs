//! Random rods, each answer checked without the solver.
