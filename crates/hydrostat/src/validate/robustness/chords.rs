//! Tendons that are straight between plates: what they pull at each, and how long they are.

use crate::Robot;
use crate::model::Routing;
use nalgebra::{Matrix3, Vector3};

/// The forces of all chords on a plate.
pub(super) struct Plate {
    pub(super) s: f64,
    /// World frame; the moment about the backbone.
    pub(super) force: Vector3<f64>,
    pub(super) moment: Vector3<f64>,
}

#[derive(Default)]
pub(super) struct Chords {
    /// Without the one at the base, which is clamped.
    pub(super) plates: Vec<Plate>,
    /// Per tendon; 0 and 1 for those in channels.
    pub(super) lengths: Vec<f64>,
    pub(super) tip_shares: Vec<f64>,
}

impl Chords {
    /// Between plates with the given arc lengths, positions and rotations.
    pub(super) fn new(
        robot: &Robot,
        poses: Vec<(f64, Vector3<f64>, Matrix3<f64>)>,
        tensions: &[f64],
        capstan: &[f64],
    ) -> Chords {
        let mut plates: Vec<Plate> = poses
            .iter()
            .map(|(s, ..)| Plate { s: *s, force: Vector3::zeros(), moment: Vector3::zeros() })
            .collect();
        let mut lengths = vec![0.0; robot.tendons.len()];
        let mut tip_shares = vec![1.0; robot.tendons.len()];
        for (i, tendon) in robot.tendons.iter().enumerate() {
            if tendon.routing == Routing::Channel {
                continue;
            }
            let end = robot.tendon_end(tendon);
            let mut turned = 0.0;
            let mut before: Option<Vector3<f64>> = None;
            for k in 0..poses.len().saturating_sub(1) {
                if poses[k + 1].0 > end * (1.0 + 1e-9) {
                    break;
                }
                let arm = |k: usize| poses[k].2 * tendon.path.hole((poses[k].0 / end).min(1.0), end).0;
                let chord = poses[k + 1].1 + arm(k + 1) - poses[k].1 - arm(k);
                turned += before.map_or(0.0, |before| before.angle(&chord));
                before = Some(chord);
                lengths[i] += chord.norm();
                tip_shares[i] = (capstan[i] * turned).exp();
                let pull = tensions[i] * tip_shares[i] * chord.normalize();
                for (k, force) in [(k, pull), (k + 1, -pull)] {
                    plates[k].force += force;
                    plates[k].moment += arm(k).cross(&force);
                }
            }
        }
        if !plates.is_empty() {
            plates.remove(0);
        }
        Chords { plates, lengths, tip_shares }
    }
}
