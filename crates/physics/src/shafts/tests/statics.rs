//! Static flexibility against closed forms and balances.

use herringbone_oracle::{Tolerance, check, check_worst};
use rstest::rstest;

use super::fixtures::{RIGID, SHEAR_MODULUS_PA, clamp, second_moment_m4, shaft, shear_stiffness_n};
use crate::shafts::{Bearing, SectionLoad, Shaft, ShaftError, ShaftItem, SupportDefect};

const TOPIC: &str = "Shafts: static closed forms";
const E_PA: f64 = 206e9;

#[test]
fn cantilever_and_bar() {
    let (length, diameter, bore) = (0.2, 0.06, 0.02);
    let beam = shaft(&[[length, diameter, bore]], vec![clamp(0.0)]);
    let flexibility = beam.flexibility(&[length], &[length]).unwrap();
    let (ei, shear) = (E_PA * second_moment_m4(diameter, bore), shear_stiffness_n(diameter, bore));
    let area = std::f64::consts::PI / 4.0 * (diameter * diameter - bore * bore);
    let exact = Tolerance::Relative(1e-7);
    let tip = length.powi(3) / (3.0 * ei) + length / shear;
    check(TOPIC, "cantilever, tip deflection per tip force, m/N", flexibility[(0, 0)], tip, exact);
    check(TOPIC, "cantilever, the same in the plane y–z, m/N", flexibility[(1, 1)], tip, exact);
    let slope = length * length / (2.0 * ei);
    check(TOPIC, "cantilever, tip slope φ_y per tip force F_x, rad/N", flexibility[(4, 0)], slope, exact);
    check(TOPIC, "cantilever, tip slope φ_x per tip force F_y, rad/N", flexibility[(3, 1)], -slope, exact);
    check(TOPIC, "cantilever, tip slope per tip moment, rad/(N m)", flexibility[(4, 4)], length / ei, exact);
    check(TOPIC, "bar in tension, m/N", flexibility[(2, 2)], length / (E_PA * area), exact);
    let torsion = length / (SHEAR_MODULUS_PA * 2.0 * second_moment_m4(diameter, bore));
    check(TOPIC, "bar in torsion, rad/(N m)", flexibility[(5, 5)], torsion, exact);
}

#[test]
fn stepped_cantilever() {
    let (inner, outer) = ([0.1, 0.06, 0.0], [0.15, 0.04, 0.0]);
    let beam = shaft(&[inner, outer], vec![clamp(0.0)]);
    let flexibility = beam.flexibility(&[0.25], &[0.25]).unwrap();
    let (ei, ei_outer) = (E_PA * second_moment_m4(0.06, 0.0), E_PA * second_moment_m4(0.04, 0.0));
    // ∫ (L − s)²/EI ds + ∫ ds/(κGA).
    let tip = (0.25f64.powi(3) - 0.15f64.powi(3)) / (3.0 * ei)
        + 0.15f64.powi(3) / (3.0 * ei_outer)
        + 0.1 / shear_stiffness_n(0.06, 0.0)
        + 0.15 / shear_stiffness_n(0.04, 0.0);
    check(TOPIC, "stepped cantilever, tip deflection, m/N", flexibility[(0, 0)], tip, Tolerance::Relative(1e-7));
}

#[test]
fn simple_beam_with_a_load_off_centre() {
    let (span, a, diameter) = (0.4, 0.15, 0.05);
    let b = span - a;
    let beam = shaft(&[[span, diameter, 0.0]], vec![Bearing::radial(0.0, RIGID), Bearing::radial(span, RIGID)]);
    let flexibility = beam.flexibility(&[a, 0.1, 0.3], &[a]).unwrap();
    let (ei, shear) = (E_PA * second_moment_m4(diameter, 0.0), shear_stiffness_n(diameter, 0.0));
    let tolerance = Tolerance::Relative(1e-9);
    let under = a * a * b * b / (3.0 * ei * span) + a * b / (span * shear);
    check(TOPIC, "simple beam, deflection under the load, m/N", flexibility[(0, 0)], under, tolerance);
    let left = |z: f64| b * z * (span * span - b * b - z * z) / (6.0 * ei * span) + b * z / (span * shear);
    check(TOPIC, "simple beam, deflection left of the load, m/N", flexibility[(6, 0)], left(0.1), tolerance);
    let right = |z: f64| {
        let z = span - z;
        a * z * (span * span - a * a - z * z) / (6.0 * ei * span) + a * z / (span * shear)
    };
    check(TOPIC, "simple beam, deflection right of the load, m/N", flexibility[(12, 0)], right(0.3), tolerance);
}

/// Two elastic bearings under a rigid beam, and one with all cross terms.
#[test]
fn rigid_beam_on_elastic_bearings() {
    let mut beam = shaft(&[[0.4, 0.05, 0.0]], vec![Bearing::radial(0.1, 2e8), Bearing::radial(0.3, 5e8)]);
    beam.material.youngs_modulus_pa = 1e22;
    let flexibility = beam.flexibility(&[0.4], &[0.0]).unwrap();
    // Reactions per unit force at the left end: 1.5 and −0.5; deflections at the bearings, then the line through them.
    let (left, right) = (1.5 / 2e8, -0.5 / 5e8);
    let end = left + (right - left) * 1.5;
    check(TOPIC, "rigid beam on two springs, m/N", flexibility[(0, 0)], end, Tolerance::Relative(1e-9));
    let slope = (right - left) / 0.2;
    check(TOPIC, "rigid beam on two springs, slope, rad/N", flexibility[(4, 0)], slope, Tolerance::Relative(1e-9));

    let radial = [[3e8, 1e8], [-2e8, 4e8]];
    let bearing = |position_m| Bearing { radial_n_per_m: radial, ..Bearing::radial(position_m, 0.0) };
    beam.bearings = vec![bearing(0.1), bearing(0.3)];
    let flexibility = beam.flexibility(&[0.2], &[0.2]).unwrap();
    let determinant = 2.0 * (3e8 * 4e8 + 1e8 * 2e8);
    let inverse = [[4e8, -1e8], [2e8, 3e8]].map(|row: [f64; 2]| row.map(|k| k / determinant));
    let errors = (0..2).flat_map(|i| (0..2).map(move |j| (i, j)));
    let errors = errors.map(|(i, j)| flexibility[(i, j)] / inverse[i][j] - 1.0);
    check_worst(TOPIC, "rigid beam on bearings with unsymmetric cross terms, relative", errors, 1e-9);
}

/// A hollow stepped shaft on three unequal bearings, one of them with tilting stiffness.
fn indeterminate() -> Shaft {
    let mut beam = shaft(
        &[[0.1, 0.065, 0.02], [0.2, 0.08, 0.0], [0.2, 0.09, 0.03]],
        vec![
            Bearing::radial(0.03, 3e8),
            Bearing { tilting_nm_per_rad: 2e5, axial_n_per_m: 1e8, ..Bearing::radial(0.2, 5e8) },
            Bearing { radial_n_per_m: [[2e8, 0.0], [0.0, 7e8]], ..Bearing::radial(0.49, 0.0) },
        ],
    );
    beam.gear_position_m = 0.25;
    beam.coupling.position_m = 0.5;
    beam
}

#[test]
fn reciprocity_and_balance() {
    let beam = indeterminate();
    let z: Vec<f64> = (0..11).map(|i| -0.25 + 0.05 * f64::from(i)).collect();
    let flexibility = beam.flexibility(&z, &z).unwrap();
    let largest = flexibility.amax();
    let asymmetry = (&flexibility - flexibility.transpose()).amax() / largest;
    check_worst(TOPIC, "Maxwell's reciprocity, relative", [asymmetry], 1e-12);

    let loads = [
        SectionLoad { z_m: -0.2, load: [1000.0, -300.0, 500.0, 20.0, 5.0, 100.0] },
        SectionLoad { z_m: 0.11, load: [-400.0, 800.0, -100.0, -7.0, 60.0, -30.0] },
    ];
    let state = beam.deflection(&loads, &beam.bearing_sections_m()).unwrap();
    let reactions = beam.bearing_reactions(&state.displacements);
    let of_displacements =
        reactions.iter().flatten().zip(state.bearings.iter().flatten()).map(|(a, b)| (a - b) / 1000.0);
    check_worst(TOPIC, "reactions by displacement and by balance, relative", of_displacements, 1e-9);
    let mut balance = [0.0; 6];
    let reactions = beam.bearing_sections_m().into_iter().zip(reactions);
    let coupling = [0.0, 0.0, state.coupling_axial_n, 0.0, 0.0, state.coupling_torque_nm];
    let all = loads.iter().map(|load| (load.z_m, load.load)).chain(reactions).chain([(0.25, coupling)]);
    for (z, force) in all {
        let moment = [-z * force[1], z * force[0]];
        (0..6).for_each(|i| balance[i] += force[i] + if i == 3 || i == 4 { moment[i - 3] } else { 0.0 });
    }
    check_worst(TOPIC, "balance of loads and reactions, relative", balance.map(|sum| sum / 1000.0), 1e-9);
}

#[test]
fn floating_shaft_is_held_at_the_coupling() {
    let mut beam = indeterminate();
    beam.bearings[1].axial_n_per_m = 0.0;
    assert!(beam.floats_axially());
    let flexibility = beam.flexibility(&[0.25, 0.05], &[0.05]).unwrap();
    let held = [flexibility[(2, 2)], flexibility[(5, 5)]].map(|u| u / flexibility.amax());
    check_worst(TOPIC, "floating shaft, motions held at the coupling, relative", held, 1e-12);
    let area = std::f64::consts::PI / 4.0 * (0.09f64.powi(2) - 0.03f64.powi(2));
    check(TOPIC, "floating shaft, axial, m/N", flexibility[(8, 2)], 0.2 / (E_PA * area), Tolerance::Relative(1e-9));
    beam.coupling.axial_n_per_m = 1e7;
    assert!(!beam.floats_axially());
    let flexibility = beam.flexibility(&[0.25], &[0.05]).unwrap();
    check(TOPIC, "axial spring of the coupling, m/N", flexibility[(2, 2)], 1e-7, Tolerance::Relative(1e-9));
}

#[rstest]
#[case::no_segments(|s: &mut Shaft| s.segments.clear(), ShaftError::NoSegments)]
#[case::no_bearing(|s: &mut Shaft| s.bearings.clear(), ShaftError::NoBearing)]
#[case::one_bearing(|s: &mut Shaft| { s.bearings.truncate(1); s.bearings[0].radial_n_per_m[1][1] = 2e8 },
    ShaftError::SingularSupport { defect: SupportDefect::TiltingAboutX })]
#[case::same_place(|s: &mut Shaft| { s.bearings = vec![Bearing::radial(0.2, 1e9), Bearing::radial(0.2, 1e9)] },
    ShaftError::SingularSupport { defect: SupportDefect::TiltingAboutY })]
#[case::free_along_y(|s: &mut Shaft| s.bearings.iter_mut().for_each(|b| {
    b.radial_n_per_m[1][1] = 0.0;
    b.tilting_nm_per_rad = 1e5;
}), ShaftError::SingularSupport { defect: SupportDefect::TranslationY })]
#[case::bearing_outside(|s: &mut Shaft| s.bearings[2].position_m = 0.6,
    ShaftError::OutsideShaft { item: ShaftItem::Bearing(2), position_m: 0.6, length_m: 0.5 })]
#[case::bore(|s: &mut Shaft| s.segments[0].bore_m = 0.065, ShaftError::InvalidValue {
    item: ShaftItem::Segment(0), quantity: "bore_m", value: 0.065, reason: "it must be smaller than the diameter" })]
#[case::negative(|s: &mut Shaft| s.bearings[0].axial_n_per_m = -1.0, ShaftError::InvalidValue {
    item: ShaftItem::Bearing(0), quantity: "axial_n_per_m", value: -1.0,
    reason: "it must be zero or a positive finite number" })]
fn refused(#[case] change: fn(&mut Shaft), #[case] expected: ShaftError) {
    let mut beam = indeterminate();
    change(&mut beam);
    let error = beam.flexibility(&[0.0], &[0.0]).unwrap_err();
    match (&error, &expected) {
        // Which of two equally free tiltings is named is a matter of rounding.
        (ShaftError::SingularSupport { .. }, ShaftError::SingularSupport { defect }) if is_tilting(*defect) => {
            assert!(error.to_string().contains("tilt"), "{error}");
        }
        _ => assert_eq!(error, expected),
    }
}

fn is_tilting(defect: SupportDefect) -> bool {
    matches!(defect, SupportDefect::TiltingAboutX | SupportDefect::TiltingAboutY)
}

#[test]
fn section_outside_the_shaft_is_refused() {
    let error = indeterminate().flexibility(&[0.0, 0.26], &[0.0]).unwrap_err();
    assert!(matches!(error, ShaftError::OutsideShaft { item: ShaftItem::Section(1), .. }), "{error}");
}
