//! The pair: derived geometry of both members and of their engagement.

use super::spec::{Half, Infeasibility, Material, PairSpec, Rotation, Warning};

/// One member with its derived geometry (ISO 21771). Lengths in m, angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    pub teeth: u32,
    pub profile_shift: f64,
    pub reference_radius_m: f64,
    pub base_radius_m: f64,
    pub tip_radius_m: f64,
    pub root_radius_m: f64,
    /// Where fillet and involute join.
    pub root_form_radius_m: f64,
    pub bore_radius_m: f64,
    /// Half tooth angle at the base circle, psi_b.
    pub base_half_angle_rad: f64,
}

impl Member {
    /// Half angle of the tooth (from its centreline to the flank) at radius `r_m`, between root and tip circle: the
    /// trochoidal fillet below the root form circle, the involute above it.
    pub fn half_angle_rad(&self, _r_m: f64) -> f64 {
        todo!()
    }

    /// Transverse arc thickness of the tooth at radius `r_m`.
    pub fn transverse_thickness_m(&self, r_m: f64) -> f64 {
        2.0 * r_m * self.half_angle_rad(r_m)
    }

    /// Half angle of the tooth at the root circle (end of the fillet).
    pub fn root_half_angle_rad(&self) -> f64 {
        todo!()
    }
}

/// A feasible pair: every length of the engagement is known and finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    pub pinion: Member,
    pub gear: Member,
    pub spec: PairSpec,
    pub transverse_pressure_angle_rad: f64,
    pub working_pressure_angle_rad: f64,
    pub base_helix_angle_rad: f64,
    pub center_distance_m: f64,
    pub transverse_module_m: f64,
    /// Transverse base pitch p_bt.
    pub base_pitch_m: f64,
    /// T1T2, length of the line of action between the base tangent points.
    pub line_of_action_m: f64,
    /// Roll coordinate x of the start of contact A (gear tip or pinion form circle).
    pub path_start_m: f64,
    /// Roll coordinate x of the end of contact E (pinion tip or gear form circle).
    pub path_end_m: f64,
    pub transverse_contact_ratio: f64,
    pub overlap_ratio: f64,
}

impl Pair {
    /// Derives the geometry, or says every reason why the design cannot run.
    pub fn new(_spec: &PairSpec) -> Result<(Pair, Vec<Warning>), Vec<Infeasibility>> {
        todo!()
    }

    pub fn material(&self) -> &Material {
        &self.spec.material
    }

    /// Axial distance from the mesh-out end of a station at `y_m` from the inner end.
    pub fn entry_m(&self, y_m: f64) -> f64 {
        match self.spec.rotation {
            Rotation::ApexLeading => self.spec.face_width_m - y_m,
            Rotation::ApexTrailing => y_m,
        }
    }

    /// Initial gap between the flanks at a point of the plane of action, in the transverse plane along the base
    /// tangent: flank modifications of both members and the assembly errors, before load and apart from corner gaps.
    pub fn initial_gap_m(&self, _half: Half, _x_m: f64, _y_m: f64) -> f64 {
        todo!()
    }

    /// Kinematic gap of a contact outside the path of contact, `overrun_m >= 0` before its start: the gear's tip corner
    /// against the pinion flank, measured along the transverse base tangent of the pinion (physics briefing, corner contact).
    /// `None` where the corner has no flank to meet.
    pub fn mesh_in_corner_gap_m(&self, _overrun_m: f64) -> Option<f64> {
        todo!()
    }

    /// The same after the end of the path: the pinion's tip corner against the gear flank.
    pub fn mesh_out_corner_gap_m(&self, _overrun_m: f64) -> Option<f64> {
        todo!()
    }
}
