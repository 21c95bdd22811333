//! The pair: derived geometry of both members and of their engagement.

use super::feasibility::Findings;
use super::findings::{Infeasibility, MemberId, Warning};
use super::involute::{inv, inverse_inv};
use super::member::Member;
use super::spec::{GearSpec, PairSpec, Rotation};
use super::tooth::Cutter;

/// A feasible pair: every length of the engagement is known and finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The pinion.
    pub pinion: Member,
    /// The gear.
    pub gear: Member,
    /// The design.
    pub spec: PairSpec,
    /// Transverse pressure angle α_t.
    pub transverse_pressure_angle_rad: f64,
    /// Working transverse pressure angle α_wt.
    pub working_pressure_angle_rad: f64,
    /// Base helix angle β_b.
    pub base_helix_angle_rad: f64,
    /// Working centre distance, its error included.
    pub center_distance_m: f64,
    /// Transverse module m_t.
    pub transverse_module_m: f64,
    /// Transverse base pitch p_bt.
    pub base_pitch_m: f64,
    /// T1T2, length of the line of action between the base tangent points.
    pub line_of_action_m: f64,
    /// Roll coordinate x of the start of contact A (gear tip or pinion form circle).
    pub path_start_m: f64,
    /// Roll coordinate x of the end of contact E (pinion tip or gear form circle).
    pub path_end_m: f64,
    /// Transverse contact ratio ε_α.
    pub transverse_contact_ratio: f64,
    /// Overlap ratio ε_β of one half.
    pub overlap_ratio: f64,
    /// Backlash j_bt along the transverse base tangent that the nominal tooth thicknesses leave at the working centre
    /// distance; zero where the centre distance follows from the profile shifts. The backlash of the dynamics is an
    /// input of its own.
    pub geometric_backlash_m: f64,
}

impl Pair {
    /// Derives the geometry (ISO 21771), or every reason why the design is infeasible.
    ///
    /// # Errors
    /// All reasons at once, with the field each is about.
    ///
    /// A given centre distance that does not follow from the profile shifts changes the working pressure angle, the
    /// path of contact and the backlash, not the teeth: those are the rack's at the given profile shifts.
    pub fn new(spec: &PairSpec) -> Result<(Pair, Vec<Warning>), Vec<Infeasibility>> {
        let mut findings = Findings::default();
        findings.check_values(spec);
        if !findings.reasons.is_empty() {
            return Err(findings.reasons);
        }
        let alpha_n = spec.normal_pressure_angle_rad;
        let beta = spec.helix_angle_rad;
        let alpha_t = (alpha_n.tan() / beta.cos()).atan();
        let m_t = spec.normal_module_m / beta.cos();
        let mut cutters = [&spec.pinion, &spec.gear].map(|gear| cutter(spec, gear, alpha_t));
        for (member, cutter) in MemberId::BOTH.into_iter().zip(&mut cutters) {
            findings.check_cutter(member, cutter);
        }
        if cutters.iter().any(|cutter| cutter.root_radius_m() <= 0.0) {
            return Err(findings.reasons);
        }
        let pinion = Member::new(&cutters[0], &spec.pinion, spec);
        let gear = Member::new(&cutters[1], &spec.gear, spec);
        for (id, member) in MemberId::BOTH.into_iter().zip([&pinion, &gear]) {
            findings.check_member(id, member, spec);
        }

        let unmeshed = UnmeshedPair { spec, pinion, gear, alpha_t, m_t };
        let fit = unmeshed.fit();
        let base_sum = unmeshed.base_sum_m();
        let Some(center_distance_m) = findings.center_distance_m(spec, base_sum, &fit) else {
            return Err(findings.reasons);
        };
        let pair = unmeshed.at(center_distance_m, &fit);
        let mut engagement = Findings::default();
        engagement.check_pair(&pair, &fit);
        if let Some(fitting_m) = fit.center_distance_m.filter(|a| *a != center_distance_m && *a > base_sum) {
            let fitting = unmeshed.at(fitting_m, &fit);
            let mut without_backlash = Findings::default();
            without_backlash.check_pair(&fitting, &fit);
            engagement.blame_center_distance(without_backlash, &pair, &fitting, &fit);
        }
        findings.add(engagement);
        if findings.reasons.is_empty() { Ok((pair, findings.warnings)) } else { Err(findings.reasons) }
    }

    /// Young's modulus equivalent to those of both members: E_red = 2 E1 E2 / (E1 + E2), ISO 6336-1:2019.
    pub fn reduced_youngs_modulus_pa(&self) -> f64 {
        let [one, other] = [&self.pinion, &self.gear].map(|member| member.material.youngs_modulus_pa);
        if one == other { one } else { 2.0 * one * other / (one + other) }
    }

    /// Transverse plus overlap ratio of the unloaded pair.
    pub fn total_contact_ratio(&self) -> f64 {
        self.transverse_contact_ratio + self.overlap_ratio
    }

    /// Number of virtual spur teeth `z / (cos²(beta_b) cos(beta))` of the pinion and of the gear.
    pub fn virtual_teeth(&self) -> [f64; 2] {
        let per_tooth = 1.0 / (self.base_helix_angle_rad.cos().powi(2) * self.spec.helix_angle_rad.cos());
        [&self.pinion, &self.gear].map(|member| f64::from(member.teeth) * per_tooth)
    }

    /// Roll coordinate of the pitch point C.
    pub fn pitch_point_m(&self) -> f64 {
        self.pinion.base_radius_m * self.working_pressure_angle_rad.tan()
    }

    /// Axial distance from the mesh-out end of a station at `y_m` from the inner end.
    pub fn entry_m(&self, y_m: f64) -> f64 {
        match self.spec.rotation {
            Rotation::ApexLeading => self.spec.face_width_m - y_m,
            Rotation::ApexTrailing => y_m,
        }
    }
}

/// Engagement without backlash: the centre distance of the profile shifts, and the profile shifts of a centre distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct ZeroBacklashFit {
    /// Involute function of the working pressure angle without backlash between teeth of nominal thickness (ISO 21771).
    zero_backlash_inv: f64,
    /// Centre distance without backlash; none where no centre distance brings both flanks into contact.
    pub center_distance_m: Option<f64>,
    /// Sum of the profile shift coefficients.
    pub shift_sum: f64,
    base_sum_m: f64,
    transverse_inv: f64,
    /// Change of the involute function per profile shift coefficient, `2 tan(alpha_n) / (z1 + z2)`.
    inv_per_shift: f64,
}

impl ZeroBacklashFit {
    /// Sum of the profile shift coefficients with which the teeth run without backlash at `center_distance_m`; none up
    /// to the sum of the base radii.
    pub(super) fn shift_sum_at(&self, center_distance_m: f64) -> Option<f64> {
        let cos = self.base_sum_m / center_distance_m;
        (cos < 1.0).then(|| (inv(cos.acos()) - self.transverse_inv) / self.inv_per_shift)
    }
}

/// Teeth of both members, before they are brought together.
struct UnmeshedPair<'a> {
    spec: &'a PairSpec,
    pinion: Member,
    gear: Member,
    alpha_t: f64,
    m_t: f64,
}

impl UnmeshedPair<'_> {
    fn base_sum_m(&self) -> f64 {
        self.pinion.base_radius_m + self.gear.base_radius_m
    }

    fn fit(&self) -> ZeroBacklashFit {
        let (pinion, gear, alpha_t) = (&self.pinion, &self.gear, self.alpha_t);
        let alpha_n = self.spec.normal_pressure_angle_rad;
        let teeth = f64::from(pinion.teeth + gear.teeth);
        let shift_sum = pinion.profile_shift + gear.profile_shift;
        let zero_backlash_inv = inv(alpha_t) + 2.0 * alpha_n.tan() * shift_sum / teeth;
        let base_sum_m = self.base_sum_m();
        ZeroBacklashFit {
            zero_backlash_inv,
            center_distance_m: inverse_inv(zero_backlash_inv).map(|alpha| base_sum_m / alpha.cos()),
            shift_sum,
            base_sum_m,
            transverse_inv: inv(alpha_t),
            inv_per_shift: 2.0 * alpha_n.tan() / teeth,
        }
    }

    /// The pair at a working centre distance above the sum of the base radii.
    fn at(&self, center_distance_m: f64, fit: &ZeroBacklashFit) -> Pair {
        let UnmeshedPair { spec, pinion, gear, alpha_t, m_t } = self;
        let base_sum = self.base_sum_m();
        let alpha_wt = (base_sum / center_distance_m).acos();
        let base_helix = (spec.helix_angle_rad.tan() * alpha_t.cos()).atan();
        let base_pitch_m = std::f64::consts::PI * m_t * alpha_t.cos();
        let line_of_action_m = base_sum * alpha_wt.tan();
        let path_start_m = (line_of_action_m - gear.tip_roll_m()).max(pinion.root_form_roll_m());
        let path_end_m = pinion.tip_roll_m().min(line_of_action_m - gear.root_form_roll_m());
        Pair {
            spec: **spec,
            transverse_pressure_angle_rad: *alpha_t,
            working_pressure_angle_rad: alpha_wt,
            base_helix_angle_rad: base_helix,
            center_distance_m,
            transverse_module_m: *m_t,
            base_pitch_m,
            line_of_action_m,
            path_start_m,
            path_end_m,
            transverse_contact_ratio: (path_end_m - path_start_m) / base_pitch_m,
            overlap_ratio: spec.face_width_m * base_helix.tan() / base_pitch_m,
            // The backlash on the working pitch circles, unrolled on the base circles.
            geometric_backlash_m: 2.0 * base_sum * (inv(alpha_wt) - fit.zero_backlash_inv),
            pinion: pinion.clone(),
            gear: gear.clone(),
        }
    }
}

fn cutter(spec: &PairSpec, gear: &GearSpec, transverse_pressure_angle_rad: f64) -> Cutter {
    Cutter {
        teeth: gear.teeth,
        normal_module_m: spec.normal_module_m,
        normal_pressure_angle_rad: spec.normal_pressure_angle_rad,
        transverse_pressure_angle_rad,
        helix_angle_rad: spec.helix_angle_rad,
        profile_shift: gear.profile_shift,
        dedendum: gear.dedendum,
        fillet_radius: gear.fillet_radius,
    }
}
