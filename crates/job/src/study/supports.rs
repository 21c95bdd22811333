//! The springs outside the mesh: given by the document, derived from the gear bodies, or assumed by the size of the
//! pair.

use crate::document::{self as doc, JobDocument, JobKind};
use crate::result::{SpringOrigin, SpringValue, SupportsResult};
use crate::warning::Warning;
use herringbone_physics::gear::{BodyStiffness, Material, Pair};

/// Lateral support of a half over E a, E that of steel (bearings are steel whatever the gears are of) and a the centre
/// distance.
///
/// Reason for E a: bearings of similar shape, loaded in proportion to what similar gears carry, are as stiff as they
/// are large (a stiffness is a modulus times a length, and the only length that both shafts share, and that bounds the
/// bearings beside each other, is the centre distance). Rolling bearings with line contact do this by themselves: δ =
/// 7.68e-5 Q^0.9 / l^0.8 (mm, N; T. A. Harris, Rolling Bearing Analysis), so F/δ grows with F^0.1 l^0.8, that is with
/// the length at equal stress. Reason for the factor: a cylindrical roller bearing of 50 mm bore (16 rollers, 13 mm
/// long, Q = 4.08 F/16) has 850 N/µm under the force of the source's pair, shaft and housing behind it leave about
/// 600, the value of the dynamic reference cases; a = 201 mm there.
const LATERAL_PER_MODULUS_AND_DISTANCE: f64 = 0.0145;

/// Axial over lateral stiffness of a support: 200 to 600 N/µm in the dynamic reference cases.
const AXIAL_OVER_LATERAL: f64 = 1.0 / 3.0;

/// The springs in use.
pub(super) fn used(supports: &doc::SupportsInput, pair: &Pair) -> SupportsResult {
    let lateral = LATERAL_PER_MODULUS_AND_DISTANCE * Material::STEEL.youngs_modulus_pa * pair.center_distance_m * 1e-6;
    let assumed = |given: Option<f64>, n_per_um: f64| value(given, n_per_um, SpringOrigin::Assumed);
    let derived = |given: Option<f64>, derived: f64| value(given, derived, SpringOrigin::Derived);
    // Between the middles of the halves; the common face width lies in the middle of either gear's own.
    let length_m = middle_distance_m(pair);
    let [pinion, gear]: [BodyStiffness; 2] =
        [&pair.pinion, &pair.gear].map(|member| member.body_stiffness(&member.material, length_m));
    SupportsResult {
        pinion_lateral_n_per_um: assumed(supports.pinion_lateral_n_per_um, lateral),
        gear_lateral_n_per_um: assumed(supports.gear_lateral_n_per_um, lateral),
        gear_axial_n_per_um: assumed(supports.gear_axial_n_per_um, AXIAL_OVER_LATERAL * lateral),
        pinion_halves_axial_n_per_um: derived(supports.pinion_halves_axial_n_per_um, pinion.axial_n_per_m * 1e-6),
        gear_halves_axial_n_per_um: derived(supports.gear_halves_axial_n_per_um, gear.axial_n_per_m * 1e-6),
        pinion_halves_lateral_n_per_um: derived(supports.pinion_halves_lateral_n_per_um, pinion.lateral_n_per_m * 1e-6),
        gear_halves_lateral_n_per_um: derived(supports.gear_halves_lateral_n_per_um, gear.lateral_n_per_m * 1e-6),
        pinion_halves_torsional_nm_per_rad: derived(
            supports.pinion_halves_torsional_nm_per_rad,
            pinion.torsional_nm_per_rad,
        ),
        gear_halves_torsional_nm_per_rad: derived(supports.gear_halves_torsional_nm_per_rad, gear.torsional_nm_per_rad),
    }
}

fn middle_distance_m(pair: &Pair) -> f64 {
    pair.spec.face_width_m + pair.spec.gap_width_m
}

fn value(given: Option<f64>, otherwise: f64, origin: SpringOrigin) -> SpringValue {
    SpringValue {
        value: given.unwrap_or(otherwise),
        origin: if given.is_some() { SpringOrigin::Given } else { origin },
    }
}

/// Every spring with the name of its field.
pub(super) fn named(supports: &SupportsResult) -> [(&'static str, &SpringValue); 9] {
    [
        ("pinion_lateral_n_per_um", &supports.pinion_lateral_n_per_um),
        ("gear_lateral_n_per_um", &supports.gear_lateral_n_per_um),
        ("gear_axial_n_per_um", &supports.gear_axial_n_per_um),
        ("pinion_halves_axial_n_per_um", &supports.pinion_halves_axial_n_per_um),
        ("gear_halves_axial_n_per_um", &supports.gear_halves_axial_n_per_um),
        ("pinion_halves_lateral_n_per_um", &supports.pinion_halves_lateral_n_per_um),
        ("gear_halves_lateral_n_per_um", &supports.gear_halves_lateral_n_per_um),
        ("pinion_halves_torsional_nm_per_rad", &supports.pinion_halves_torsional_nm_per_rad),
        ("gear_halves_torsional_nm_per_rad", &supports.gear_halves_torsional_nm_per_rad),
    ]
}

/// Names of the springs that a document gives.
pub(super) fn given(supports: &doc::SupportsInput) -> impl Iterator<Item = &'static str> {
    let springs = [
        ("pinion_lateral_n_per_um", supports.pinion_lateral_n_per_um),
        ("gear_lateral_n_per_um", supports.gear_lateral_n_per_um),
        ("gear_axial_n_per_um", supports.gear_axial_n_per_um),
        ("pinion_halves_axial_n_per_um", supports.pinion_halves_axial_n_per_um),
        ("gear_halves_axial_n_per_um", supports.gear_halves_axial_n_per_um),
        ("pinion_halves_lateral_n_per_um", supports.pinion_halves_lateral_n_per_um),
        ("gear_halves_lateral_n_per_um", supports.gear_halves_lateral_n_per_um),
        ("pinion_halves_torsional_nm_per_rad", supports.pinion_halves_torsional_nm_per_rad),
        ("gear_halves_torsional_nm_per_rad", supports.gear_halves_torsional_nm_per_rad),
    ];
    springs.into_iter().filter_map(|(name, spring)| spring.map(|_| name))
}

/// Warning of the springs that were not given, with the values used; none without equations of motion, and none where
/// shafts replace them. Springs that a sweep varies are given.
pub(super) fn assumed(document: &JobDocument, used: &SupportsResult) -> Option<Warning> {
    if document.kind == JobKind::Mesh || document.design.shafts.is_some() {
        return None;
    }
    let swept =
        |name: &str| document.axes.iter().any(|axis| axis.pointer.strip_prefix("/design/supports/") == Some(name));
    let list = |origin: SpringOrigin| {
        let springs = named(used).into_iter().filter(|(name, spring)| spring.origin == origin && !swept(name));
        springs.map(|(name, spring)| format!("{name} {}", shown(spring.value))).collect::<Vec<_>>().join(", ")
    };
    let (assumed, derived) = (list(SpringOrigin::Assumed), list(SpringOrigin::Derived));
    let mut parts = Vec::new();
    if !assumed.is_empty() {
        parts.push(format!(
            "assumed after the size of the pair, {LATERAL_PER_MODULUS_AND_DISTANCE} E a laterally and a third of it axially (E of steel, a the \
             centre distance): {assumed}"
        ));
    }
    if !derived.is_empty() {
        parts.push(format!(
            "derived from each gear's body between the middles of its halves (root circle to bore; E A/L, G J/L, Timoshenko beam with \
             parallel ends): {derived}"
        ));
    }
    if parts.is_empty() {
        return None;
    }
    let varies = document.axes.iter().any(|axis| axis.pointer.starts_with("/design/"));
    let note = if varies { "; where the sweep varies the gear, each point has its own" } else { "" };
    Some(Warning {
        code: "assumed-supports".to_owned(),
        pointer: "/design/supports".to_owned(),
        detail: format!("not given, {}{note}", parts.join("; ")),
    })
}

/// Four significant digits.
pub(super) fn shown(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let digits_before = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    format!("{value:.*}", (3.0 - digits_before).clamp(0.0, 6.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Input;
    use herringbone_physics::gear::{GearSpec, PairSpec};

    fn pair(spec: &PairSpec) -> Pair {
        Pair::new(spec).unwrap_or_else(|reasons| panic!("{reasons:#?}")).0
    }

    /// Table 1 of the source paper: z 17/44, m_n 6 mm, transverse pressure angle 20 deg, helix 24.43 deg, b 75 mm per
    /// half.
    fn source_pair(addendum: f64) -> PairSpec {
        let beta: f64 = 24.43_f64.to_radians();
        let alpha_n = (20.0_f64.to_radians().tan() * beta.cos()).atan();
        let teeth = [17, 44].map(|teeth| GearSpec {
            addendum,
            dedendum: addendum + 0.25,
            fillet_radius: 0.2,
            ..GearSpec::plain(teeth)
        });
        PairSpec { gap_width_m: 0.03, ..PairSpec::plain(6e-3, [alpha_n, beta], 75e-3, teeth) }
    }

    /// Supports without given springs.
    fn nothing() -> doc::SupportsInput {
        doc::SupportsInput::defaults()
    }

    fn scaled(factor: f64) -> Pair {
        let spec = source_pair(1.0);
        let gear = |gear: GearSpec| GearSpec { bore_radius_m: 0.03 * factor, ..gear };
        pair(&PairSpec {
            normal_module_m: spec.normal_module_m * factor,
            face_width_m: spec.face_width_m * factor,
            gap_width_m: spec.gap_width_m * factor,
            pinion: gear(spec.pinion),
            gear: gear(spec.gear),
            ..spec
        })
    }

    #[test]
    fn the_sources_pair_has_about_the_values_of_the_reference_cases() {
        let used = used(&nothing(), &scaled(1.0));
        for (name, expected) in
            [("pinion_lateral_n_per_um", 600.0), ("gear_lateral_n_per_um", 600.0), ("gear_axial_n_per_um", 200.0)]
        {
            let (_, spring) = named(&used).into_iter().find(|(known, _)| *known == name).expect("a spring");
            assert!(
                (spring.value / expected - 1.0).abs() < 0.01 && spring.origin == SpringOrigin::Assumed,
                "{name} {spring:?}"
            );
        }
        // By hand: root diameter 97.03 mm, bore 60 mm, 105 mm between the middles of the halves.
        let d = 2.0 * scaled(1.0).pinion.root_radius_m;
        let area = std::f64::consts::FRAC_PI_4 * (d * d - 0.06 * 0.06);
        let axial = 206e9 * area / 0.105 * 1e-6;
        assert!((used.pinion_halves_axial_n_per_um.value / axial - 1.0).abs() < 1e-12 && axial > 8000.0, "{axial}");
        let polar = std::f64::consts::PI / 32.0 * (d.powi(4) - 0.06_f64.powi(4));
        let torsional = 206e9 / 2.6 * polar / 0.105;
        assert!((used.pinion_halves_torsional_nm_per_rad.value / torsional - 1.0).abs() < 1e-12);
    }

    /// Similar pairs: stiffness along a length grows with the length, against rotation with its cube.
    #[test]
    fn everything_scales_with_the_size() {
        let (base, large) = (used(&nothing(), &scaled(1.0)), used(&nothing(), &scaled(2.5)));
        for ((name, small), (_, large)) in named(&base).into_iter().zip(named(&large)) {
            let power = if name.ends_with("per_rad") { 3 } else { 1 };
            let ratio = large.value / small.value / 2.5_f64.powi(power);
            assert!((ratio - 1.0).abs() < 1e-9, "{name}: {ratio}");
        }
    }

    #[test]
    fn what_is_given_is_used_as_it_is_zero_too() {
        let given = doc::SupportsInput {
            pinion_lateral_n_per_um: Some(123.0),
            gear_halves_torsional_nm_per_rad: Some(0.0),
            ..nothing()
        };
        let used = used(&given, &scaled(1.0));
        assert_eq!(used.pinion_lateral_n_per_um, value(Some(123.0), 1.0, SpringOrigin::Assumed));
        let torsional = &used.gear_halves_torsional_nm_per_rad;
        assert_eq!((torsional.value, torsional.origin), (0.0, SpringOrigin::Given));
        assert_eq!(used.gear_halves_axial_n_per_um.origin, SpringOrigin::Derived);
    }

    #[test]
    fn numbers_have_four_digits() {
        assert_eq!([600.37, 20.0, 1.5, 12_345.6, 4.083e8].map(shown), ["600.4", "20.00", "1.500", "12346", "4.083e8"]);
    }
}
