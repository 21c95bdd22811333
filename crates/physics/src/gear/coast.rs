//! The pair on its other flanks: the pinion is driven, with the same direction of rotation (negative torque, coast
//! side).
//!
//! Seen in the mirror of the plane through both axes, the coast flanks take the place of the drive flanks, the hands of
//! the helices are exchanged and the gears turn the other way. The contact of the coast flanks is therefore the
//! drive-flank contact of a pair of its own, [`Pair::coast`], run backwards in time: its pairs leave the mesh where and
//! when those of the real gears enter it. Left and right half, inner and outer ends, and the circles and lengths of the
//! engagement stay as they are; in the mirrored pair the other ends of the teeth enter first, as it has the other hands
//! at the mirrored rotation.
//!
//! Along the path of contact of the mirrored pair, its `x_m` is the roll length of the pinion's coast flank. In a
//! transverse section the drive flank of a pinion's tooth is at the roll length `x = r_b1 (θ + ψ_b1 + α_wt)`, its coast
//! flank at `x' = r_b1 (-θ + ψ_b1 + α_wt)`, with the polar angle θ of the tooth's centreline from the line of centres
//! and the half tooth angle ψ_b1 at the base circle. From the lines of contact of both, `x = x_A + (φ + k) p_bt - (b -
//! entry) tanβ_b`, and the exchange of `entry` for `b - entry`, the phase follows: `φ' = -φ + [2 r_b1 (α_wt + ψ_b1) - 2
//! x_A + b tanβ_b] / p_bt`, whole base pitches left out.

use super::pair::Pair;
use super::spec::{Assembly, GearSpec, PairSpec};

impl Pair {
    /// The mirrored pair whose drive flanks are the coast flanks of this one (see the module). The coast pair of the
    /// coast pair is the pair itself.
    pub fn coast(&self) -> Pair {
        let spec = &self.spec;
        Pair {
            spec: PairSpec {
                rotation: spec.rotation.reversed(),
                pinion: mirrored(&spec.pinion),
                gear: mirrored(&spec.gear),
                assembly: spec.assembly.on_coast_flanks(self.working_pressure_angle_rad),
                ..*spec
            },
            ..self.clone()
        }
    }

    /// Phase of the [coast pair](Pair::coast) when this one is at `phase`, both by the angle of the pinion; from 0
    /// to below 1. It falls as `phase` grows. The function is its own inverse, and the same for both pairs. The
    /// pinion's tooth has the thickness as cut by the rack; backlash does not enter.
    pub fn coast_phase(&self, phase: f64) -> f64 {
        let of_tooth_m =
            2.0 * self.pinion.base_radius_m * (self.working_pressure_angle_rad + self.pinion.base_half_angle_rad)
                - 2.0 * self.path_start_m;
        let slant_m = self.spec.face_width_m * self.base_helix_angle_rad.tan();
        let coast = ((of_tooth_m + slant_m) / self.base_pitch_m - phase).rem_euclid(1.0);
        // The remainder of a tiny negative number rounds up to the divisor.
        if coast < 1.0 { coast } else { 0.0 }
    }
}

fn mirrored(gear: &GearSpec) -> GearSpec {
    GearSpec {
        flanks: gear.coast_flanks.unwrap_or(gear.flanks),
        coast_flanks: gear.coast_flanks.map(|_| gear.flanks),
        ..*gear
    }
}

impl Assembly {
    /// The same errors seen from the mirrored pair.
    ///
    /// - Misalignment: the pinion's axis is turned by one vector, given by its components in and out of the plane of
    ///   action of the drive flanks. The plane of action of the coast flanks is inclined against it by π - 2 α_wt, so
    ///   that the
    ///   components there are `f' = -f cos 2α_wt + e sin 2α_wt` in the plane (what opens the drive flanks at one end
    ///   opens the
    ///   coast flanks at the other) and `e' = f sin 2α_wt + e cos 2α_wt` out of it. `e > 0` is counted as turning the
    ///   left half's
    ///   outer end away from the gear.
    /// - Apex offset: an axial shift that opens the flanks of one hand on one side of the teeth opens those of the
    ///   other hand on the other side.
    /// - Centre-distance error: the same.
    fn on_coast_flanks(&self, working_pressure_angle_rad: f64) -> Assembly {
        let (sin, cos) = (2.0 * working_pressure_angle_rad).sin_cos();
        let (f, e) = (self.in_plane_misalignment_m, self.out_of_plane_misalignment_m);
        Assembly {
            center_distance_error_m: self.center_distance_error_m,
            in_plane_misalignment_m: e * sin - f * cos,
            out_of_plane_misalignment_m: f * sin + e * cos,
            apex_offset_m: -self.apex_offset_m,
        }
    }
}
