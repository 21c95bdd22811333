//! Random trains: every calculation ends with finite numbers or a typed error, and what is exact stays exact.

use nalgebra::Complex;
use proptest::prelude::*;

use super::reference::case;
use crate::gear::{Half, Pair, Rotation, fixtures};
use crate::shafts::{
    Bearing, Coupling, GearedRotor, Harmonics, Machine, MeshElement, ModeRange, ReductionSettings, RigidBody,
    RotationSense, SectionLoad, Shaft, ShaftError, ShaftMaterial, ShaftSegment, ShaftTrain,
};
use crate::watch::Watch;

/// A positive number over many orders of magnitude, zero, or (seldom) something that is no use.
fn wild(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => (low.ln()..high.ln()).prop_map(f64::exp),
        3 => Just(0.0),
        1 => prop_oneof![Just(-low), Just(f64::NAN), Just(f64::INFINITY), Just(1e300), Just(1e-300)],
    ]
}

fn sane(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

fn bearing(wildness: bool) -> BoxedStrategy<Bearing> {
    let radial = if wildness { wild(1e3, 1e13).boxed() } else { sane(1e7, 1e10).boxed() };
    let other = if wildness { wild(1.0, 1e13).boxed() } else { prop_oneof![Just(0.0), sane(1e3, 1e9)].boxed() };
    let damping = if wildness { wild(1.0, 1e8).boxed() } else { prop_oneof![Just(0.0), sane(1.0, 1e5)].boxed() };
    let cross = if wildness { -1.5..1.5 } else { -0.4..0.4 };
    (
        0.0..1.0f64,
        [radial.clone(), radial],
        [cross.clone(), cross],
        [other.clone(), other],
        [damping.clone(), damping.clone(), damping],
    )
        .prop_map(|(place, [x, y], [xy, yx], [axial, tilting], [radial_damping, axial_damping, tilting_damping])| {
            let mean = 0.5 * (x + y).min(1e15);
            Bearing {
                position_m: place,
                radial_n_per_m: [[x, xy * mean.min(x.min(y))], [yx * mean.min(x.min(y)), y]],
                radial_damping_n_s_per_m: [[radial_damping, 0.0], [0.0, radial_damping]],
                axial_n_per_m: axial,
                axial_damping_n_s_per_m: axial_damping,
                tilting_nm_per_rad: tilting,
                tilting_damping_nm_s_per_rad: tilting_damping,
            }
        })
        .boxed()
}

fn body(wildness: bool) -> BoxedStrategy<RigidBody> {
    let mass = if wildness { wild(1e-6, 1e6).boxed() } else { sane(0.1, 100.0).boxed() };
    (mass, 1e-3..0.1f64, 0.4..1.0f64)
        .prop_map(|(mass_kg, radius2, ratio)| RigidBody {
            mass_kg,
            polar_inertia_kg_m2: mass_kg * radius2,
            diametral_inertia_kg_m2: mass_kg * radius2 * ratio,
        })
        .boxed()
}

fn shaft(wildness: bool) -> BoxedStrategy<Shaft> {
    let diameter = if wildness { wild(1e-3, 3.0).boxed() } else { sane(0.03, 0.3).boxed() };
    let length = if wildness { wild(1e-4, 10.0).boxed() } else { sane(0.02, 0.3).boxed() };
    let bore = if wildness { 0.0..1.1 } else { 0.0..0.9 };
    let segments = prop::collection::vec((length, diameter, bore), 1..6);
    let bearings = prop::collection::vec(bearing(wildness), if wildness { 0..4 } else { 2..4 });
    let machine = prop::option::of((sane(1e3, 1e8), sane(1e-3, 1e3), prop_oneof![Just(0.0), sane(1.0, 1e4)]));
    let axial = prop_oneof![Just(0.0), sane(1e4, 1e10)];
    let bodies = prop::collection::vec((0.0..1.0f64, body(wildness)), 0..3);
    (segments, bearings, (0.0..1.0f64, axial, machine), prop::option::of(body(wildness)), bodies, 0.3..0.7f64)
        .prop_map(|(segments, bearings, (place, axial_n_per_m, machine), half_body, bodies, gear)| {
            let segments: Vec<ShaftSegment> = segments
                .into_iter()
                .map(|(length_m, diameter_m, bore)| ShaftSegment { length_m, diameter_m, bore_m: bore * diameter_m })
                .collect();
            let length: f64 = segments.iter().map(|segment| segment.length_m).sum();
            Shaft {
                bearings: bearings.into_iter().map(|b| Bearing { position_m: b.position_m * length, ..b }).collect(),
                coupling: Coupling {
                    position_m: place * length,
                    axial_n_per_m,
                    torsional: machine.map(|(torsional_nm_per_rad, inertia_kg_m2, damping)| Machine {
                        torsional_nm_per_rad,
                        torsional_damping_nm_s_per_rad: damping,
                        inertia_kg_m2,
                    }),
                },
                gear_position_m: gear * length,
                half_body,
                bodies: bodies.into_iter().map(|(place, body)| (place * length, body)).collect(),
                segments,
                material: ShaftMaterial { youngs_modulus_pa: 206e9, poissons_ratio: 0.3, density_kg_m3: 7850.0 },
            }
        })
        .boxed()
}

/// A narrow pair, so that most shafts are long enough.
fn narrow_pair() -> Pair {
    let spec = fixtures::spec(2.0, 20.0, 24.43, 15.0, fixtures::gear(17, 0.3), fixtures::gear(44, 0.0));
    fixtures::pair(&spec)
}

fn train(wildness: bool) -> impl Strategy<Value = (ShaftTrain, [f64; 4], bool)> {
    let mesh = if wildness { wild(1e3, 1e13).boxed() } else { sane(1e7, 1e10).boxed() };
    let damping = prop_oneof![Just(0.0), sane(1.0, 1e5)];
    let tilting = prop_oneof![Just(0.0), sane(1e2, 1e7)];
    (shaft(wildness), shaft(wildness), (mesh.clone(), mesh, damping, tilting), any::<bool>()).prop_map(
        |(pinion, gear, (left, right, damping, tilting), leading)| {
            (ShaftTrain { pinion, gear }, [left, right, damping, tilting], leading)
        },
    )
}

/// Whether a train was solved; fails if anything is not finite.
fn solved(train: &ShaftTrain, [left, right, damping, tilting]: [f64; 4], leading: bool) -> Result<bool, TestCaseError> {
    let mut pair = narrow_pair();
    pair.spec.rotation = if leading { Rotation::ApexLeading } else { Rotation::ApexTrailing };
    for shaft in [&train.pinion, &train.gear] {
        let z = [-0.5 * shaft.gear_position_m, 0.0, 0.5 * (shaft.length_m() - shaft.gear_position_m)];
        if let Ok(flexibility) = shaft.flexibility(&z, &z) {
            prop_assert!(flexibility.iter().all(|value| value.is_finite()));
        }
    }
    let meshes = Half::BOTH.map(|half| MeshElement {
        tilting_nm_per_rad: tilting,
        ..MeshElement::at_mid_face(&pair, half, [left, right][half.index()], damping)
    });
    let result = || -> Result<_, ShaftError> {
        let rotor = GearedRotor::new(train, &pair, RotationSense::of(pair.spec.rotation, true), &meshes)?;
        let modes = rotor.modes(ModeRange { up_to_hz: 5000.0, most: 60 })?;
        let whirl = rotor.whirl_frequencies_hz(&modes, 300.0)?;
        let damped = rotor.damped_modes(&modes, 300.0)?;
        let reduced = rotor.reduce(
            &ReductionSettings { up_to_hz: 2500.0, accuracy: 1e-2, most_coordinates: 60, pinion_speed_rad_s: 300.0 },
            Watch::none(),
        )?;
        let response = rotor.frequency_response(&Harmonics {
            frequency_hz: 431.0,
            excitation_m: [Complex::new(1e-6, 0.0); 2],
            pinion_speed_rad_s: 300.0,
        })?;
        Ok((modes, whirl, damped, reduced, response))
    };
    let Ok((modes, whirl, damped, reduced, response)) = result() else {
        return Ok(false);
    };
    for mode in &modes.modes {
        let numbers = mode.mid_face.iter().flatten().chain(mode.shafts.iter().flatten().flatten());
        prop_assert!(mode.frequency_hz.is_finite() && numbers.into_iter().all(|value| value.is_finite()));
        let kinetic = mode.kinetic;
        prop_assert!((kinetic.lateral + kinetic.axial + kinetic.torsion - 1.0).abs() < 1e-6, "{:?}", kinetic);
        prop_assert!((kinetic.pinion_shaft + kinetic.gear_shaft + kinetic.machines - 1.0).abs() < 1e-6);
    }
    prop_assert_eq!(whirl.len(), modes.modes.len() - modes.rigid_body_modes());
    prop_assert!(whirl.iter().all(|frequency| frequency.is_finite()));
    prop_assert!(damped.iter().all(|mode| mode.frequency_hz.is_finite() && mode.damping_ratio.is_finite()));
    let forces = response.bearings.iter().flatten().flatten().chain(&response.mesh_force_n);
    prop_assert!(forces.into_iter().all(|force| force.re.is_finite() && force.im.is_finite()));
    let equations = reduced.train(300.0, 100.0);
    let numbers = equations.eigenvalues_rad2_s2.iter().chain(&equations.damping_per_s).chain(&equations.load_n);
    prop_assert!(numbers.chain(equations.mesh.iter().flatten()).all(|value| value.is_finite()));
    prop_assert!(reduced.report.estimated_error.is_finite());
    Ok(true)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn wild_trains_end((train, mesh, leading) in train(true)) {
        solved(&train, mesh, leading)?;
    }
}

proptest! {
    // Shafts too short for the gear do not count; that they do not prevail is asserted by the limit of their number.
    #![proptest_config(ProptestConfig { cases: 32, max_global_rejects: 200, ..ProptestConfig::default() })]

    #[test]
    fn plausible_trains_are_solved((train, mesh, leading) in train(false)) {
        let long = [&train.pinion, &train.gear].iter().all(|shaft| {
            let room = 0.5 * narrow_pair().spec.gap_width_m + narrow_pair().spec.face_width_m;
            shaft.gear_position_m > room && shaft.length_m() - shaft.gear_position_m > room
        });
        let apart = [&train.pinion, &train.gear].iter().all(|shaft| {
            let positions = shaft.bearings.iter().map(|bearing| bearing.position_m);
            let (low, high) = positions.fold((f64::INFINITY, 0.0f64), |(l, h), p| (l.min(p), h.max(p)));
            high - low > 0.1 * shaft.length_m()
        });
        let held = !(train.pinion.floats_axially() && train.gear.floats_axially());
        prop_assume!(long && apart && held);
        prop_assert!(solved(&train, mesh, leading)?);
    }

    /// Reactions balance any load.
    #[test]
    fn reactions_balance(shaft in shaft(false), load in [-1e4..1e4f64, -1e4..1e4, -1e4..1e4, -1e3..1e3, -1e3..1e3, -1e3..1e3],
                         place in 0.0..1.0f64) {
        let z_m = place * shaft.length_m() - shaft.gear_position_m;
        let Ok(state) = shaft.deflection(&[SectionLoad { z_m, load }], &shaft.bearing_sections_m()) else {
            return Err(TestCaseError::reject("bearings at one place"));
        };
        let reactions = shaft.bearing_reactions(&state.displacements);
        let coupling = [0.0, 0.0, state.coupling_axial_n, 0.0, 0.0, state.coupling_torque_nm];
        let mut all: Vec<(f64, [f64; 6])> = shaft.bearing_sections_m().into_iter().zip(reactions).collect();
        all.push((shaft.coupling_section_m(), coupling));
        all.push((z_m, load));
        let mut sums = [0.0; 6];
        let mut magnitude = 1.0f64;
        for (z, force) in all {
            let moved = [force[0], force[1], force[2], force[3] - z * force[1], force[4] + z * force[0], force[5]];
            sums.iter_mut().zip(moved).for_each(|(sum, value)| *sum += value);
            magnitude = force.iter().fold(magnitude, |m, value| m.max(value.abs()));
        }
        prop_assert!(sums.iter().all(|sum| sum.abs() <= 1e-9 * magnitude), "{sums:?} of {magnitude}");
    }
}

/// Equal input gives equal results to the last bit.
#[test]
fn results_repeat() {
    let case = case("motor_and_load");
    let settings =
        ReductionSettings { up_to_hz: 3000.0, accuracy: 1e-3, most_coordinates: 60, pinion_speed_rad_s: 200.0 };
    let solve = || case.rotor().reduce(&settings, Watch::none()).unwrap().train(200.0, 500.0);
    assert_eq!(solve(), solve());
}
