//! One member of the pair with its derived geometry.

use super::involute::roll_length_m;
use super::spec::{GearSpec, Material, PairSpec};
use super::tooth::{Cutter, ToothForm};

/// One member with its derived geometry (ISO 21771). Lengths in m, angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Number of teeth z.
    pub teeth: u32,
    /// Profile shift coefficient x.
    pub profile_shift: f64,
    /// Radius of the reference circle.
    pub reference_radius_m: f64,
    /// Radius of the base circle.
    pub base_radius_m: f64,
    /// Radius of the tip circle.
    pub tip_radius_m: f64,
    /// Radius of the root circle as generated.
    pub root_radius_m: f64,
    /// Root form radius, at which fillet and involute join.
    pub root_form_radius_m: f64,
    /// Radius of the bore.
    pub bore_radius_m: f64,
    /// Material.
    pub material: Material,
    /// Face width of one half of this member: the common one of the pair, or more.
    pub face_width_m: f64,
    /// Half tooth angle at the base circle, psi_b.
    pub base_half_angle_rad: f64,
    /// Least profile shift coefficient that the rack cuts without undercut.
    pub undercut_profile_shift: f64,
    form: ToothForm,
    helix_angle_rad: f64,
}

impl Member {
    pub(super) fn new(cutter: &Cutter, spec: &GearSpec, pair: &PairSpec) -> Member {
        let form = ToothForm::new(cutter);
        let r = cutter.reference_radius_m();
        Member {
            teeth: cutter.teeth,
            profile_shift: cutter.profile_shift,
            reference_radius_m: r,
            base_radius_m: form.base_radius_m(),
            tip_radius_m: r + cutter.normal_module_m * (spec.addendum + spec.profile_shift + spec.tip_alteration),
            root_radius_m: form.root_radius_m(),
            root_form_radius_m: form.join_radius_m(),
            bore_radius_m: spec.bore_radius_m,
            material: spec.material.unwrap_or(pair.material),
            face_width_m: spec.face_width_m.unwrap_or(pair.face_width_m),
            base_half_angle_rad: form.base_half_angle_rad(),
            undercut_profile_shift: cutter.undercut_limit(),
            helix_angle_rad: cutter.helix_angle_rad,
            form,
        }
    }

    /// Half angle of the tooth (from its centreline to the flank) at radius `r_m`, between root and tip circle: the
    /// trochoidal fillet below the root form circle, the involute above it. Below the root circle the value there;
    /// above the tip the involute goes on.
    pub fn half_angle_rad(&self, r_m: f64) -> f64 {
        self.form.half_angle_rad(r_m)
    }

    /// Transverse arc thickness of the tooth at radius `r_m`.
    pub fn transverse_thickness_m(&self, r_m: f64) -> f64 {
        2.0 * r_m * self.half_angle_rad(r_m)
    }

    /// Arc thickness of the tooth at radius `r_m` in the normal section: `s_n = s_t cos(beta(r))`.
    pub fn normal_thickness_m(&self, r_m: f64) -> f64 {
        let tan_beta = r_m / self.reference_radius_m * self.helix_angle_rad.tan();
        self.transverse_thickness_m(r_m) / tan_beta.hypot(1.0)
    }

    /// Half angle of the tooth at the root circle (end of the fillet).
    pub fn root_half_angle_rad(&self) -> f64 {
        self.form.root_half_angle_rad()
    }

    /// Least half angle of the tooth between root circle and root form circle, where undercut makes it thinnest.
    pub(super) fn waist_half_angle_rad(&self) -> f64 {
        const STEPS: u32 = 32;
        let span_m = self.root_form_radius_m - self.root_radius_m;
        (1..=STEPS)
            .map(|i| self.half_angle_rad(self.root_radius_m + span_m * f64::from(i) / f64::from(STEPS)))
            .fold(f64::INFINITY, f64::min)
    }

    /// Roll length from the base tangent point to the circle of radius `r_m`; zero below the base circle.
    pub fn roll_length_m(&self, r_m: f64) -> f64 {
        roll_length_m(r_m, self.base_radius_m)
    }

    /// Roll length at the tip circle.
    pub fn tip_roll_m(&self) -> f64 {
        self.roll_length_m(self.tip_radius_m)
    }

    /// Roll length at the root form circle: where the usable involute starts.
    pub fn root_form_roll_m(&self) -> f64 {
        self.form.join_roll_m()
    }

    /// True where the cutter has undercut the tooth.
    pub fn is_undercut(&self) -> bool {
        self.profile_shift < self.undercut_profile_shift
    }

    /// Mass of the whole member, both halves: two discs of the face width from the bore to the reference circle. The
    /// hub in the gap between the halves is not counted.
    pub fn mass_kg(&self) -> f64 {
        let (r, bore) = (self.reference_radius_m, self.bore_radius_m);
        self.material.density_kg_m3 * 2.0 * self.face_width_m * std::f64::consts::PI * (r - bore) * (r + bore)
    }

    /// Polar moment of inertia about the axis of the same two discs.
    pub fn inertia_kg_m2(&self) -> f64 {
        let (r, bore) = (self.reference_radius_m, self.bore_radius_m);
        0.5 * self.mass_kg() * (r * r + bore * bore)
    }
}
