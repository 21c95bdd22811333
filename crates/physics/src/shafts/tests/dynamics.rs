//! Natural frequencies and forced vibration against closed forms.

use std::f64::consts::{PI, TAU};

use herringbone_oracle::{Tolerance, check, check_worst};
use nalgebra::Complex;
use rstest::rstest;
use serde_json::Value;

use super::fixtures::{RIGID, SHEAR_MODULUS_PA, clamp, second_moment_m4, shaft, shear_stiffness_n};
use super::reference::{Case, case};
use crate::gear::{Half, Pair, fixtures};
use crate::shafts::{
    Bearing, GearedRotor, Harmonics, MeshElement, ModeRange, RigidBody, RotationSense, RotorModes, Shaft, ShaftError,
    ShaftMaterial, ShaftTrain,
};

const TOPIC: &str = "Shafts: vibration closed forms";
const E_PA: f64 = 206e9;
const RHO: f64 = 7850.0;

fn pair() -> Pair {
    fixtures::pair(&fixtures::source_pair(1.0))
}

/// A material in which waves travel ten times as fast as in steel.
const LIGHT_AND_STIFF: ShaftMaterial =
    ShaftMaterial { youngs_modulus_pa: 206e10, poissons_ratio: 0.3, density_kg_m3: 785.0 };

/// The same material, stiffer.
const RIGID_MATERIAL: ShaftMaterial = ShaftMaterial { youngs_modulus_pa: 206e11, ..LIGHT_AND_STIFF };

/// A short shaft clamped in its middle, without natural frequencies of interest.
fn inert(diameter_m: f64) -> Shaft {
    let mut inert = shaft(&[[0.12, diameter_m, 0.0]], vec![clamp(0.06)]);
    inert.gear_position_m = 0.06;
    inert.material = LIGHT_AND_STIFF;
    inert
}

/// A shaft alone: no mesh, and an inert shaft beside it.
fn single(shaft: &Shaft, element_m: Option<f64>) -> (GearedRotor, RotorModes) {
    let pair = pair();
    let meshes = Half::BOTH.map(|half| MeshElement::at_mid_face(&pair, half, 0.0, 0.0));
    let train = ShaftTrain { pinion: shaft.clone(), gear: inert(0.1) };
    let rotor = GearedRotor::with_element_length(&train, &pair, RotationSense::Positive, &meshes, element_m).unwrap();
    let modes = rotor.modes(ModeRange { up_to_hz: 30000.0, most: 90 }).unwrap();
    (rotor, modes)
}

/// A uniform shaft with its gear halves around the middle.
fn uniform(length_m: f64, diameter_m: f64, bearings: Vec<Bearing>) -> Shaft {
    let mut shaft = shaft(&[[length_m, diameter_m, 0.0]], bearings);
    shaft.gear_position_m = 0.5 * length_m;
    shaft
}

/// Natural frequencies of one kind of motion of the pinion's shaft: 0 lateral, 1 axial, 2 torsion.
fn of_kind(modes: &RotorModes, kind: usize) -> Vec<f64> {
    let modes = modes.modes.iter().filter(|mode| {
        let shares = [mode.kinetic.lateral, mode.kinetic.axial, mode.kinetic.torsion];
        mode.frequency_hz > 0.0 && shares[kind] > 0.99 && mode.kinetic.pinion_shaft > 0.99
    });
    modes.map(|mode| mode.frequency_hz).collect()
}

#[test]
fn simply_supported_timoshenko_beam() {
    let (length, diameter) = (0.5, 0.05);
    let beam = uniform(length, diameter, vec![Bearing::radial(0.0, RIGID), Bearing::radial(length, RIGID)]);
    let frequencies = of_kind(&single(&beam, None).1, 0);
    let (second_moment, area) = (second_moment_m4(diameter, 0.0), PI / 4.0 * diameter * diameter);
    let (ei, shear) = (E_PA * second_moment, shear_stiffness_n(diameter, 0.0));
    for mode in 1..=3 {
        // sin(kz): (EI k² + κGA − ρI ω²)(κGA k² − ρA ω²) = (κGA k)².
        let k2 = (f64::from(mode) * PI / length).powi(2);
        let (a, b) =
            (RHO * second_moment * RHO * area, RHO * area * (ei * k2 + shear) + RHO * second_moment * shear * k2);
        let c = ei * k2 * shear * k2;
        // The smaller root without cancellation.
        let exact = (2.0 * c / (b + (b * b - 4.0 * a * c).sqrt())).sqrt() / TAU;
        let quantity = format!("simply supported Timoshenko beam, mode {mode}, Hz");
        let index = 2 * (mode as usize - 1);
        check(TOPIC, &quantity, frequencies[index], exact, Tolerance::Relative(1e-4));
        let twin = frequencies[index + 1] / frequencies[index] - 1.0;
        check_worst(TOPIC, &format!("{quantity}, equal in both planes, relative"), [twin], 1e-9);
    }
}

#[test]
fn slender_cantilever() {
    let (length, diameter) = (2.0, 0.016);
    let beam = uniform(length, diameter, vec![clamp(0.0)]);
    let frequencies = of_kind(&single(&beam, None).1, 0);
    let area = PI / 4.0 * diameter * diameter;
    let wave = (E_PA * second_moment_m4(diameter, 0.0) / (RHO * area)).sqrt();
    // cos x cosh x = −1. Shear and rotary inertia lower the third mode by 1e-3 at most.
    for (mode, x) in [1.875_104_068_711_961_f64, 4.694_091_132_974_175, 7.854_757_438_237_613].into_iter().enumerate() {
        let exact = x * x * wave / (length * length) / TAU;
        let quantity = format!("slender cantilever, mode {}, Euler–Bernoulli, Hz", mode + 1);
        check(TOPIC, &quantity, frequencies[2 * mode], exact, Tolerance::Relative(1e-3));
    }
}

#[test]
fn bars_in_torsion_and_tension() {
    let length = 0.5;
    let mut bar = uniform(length, 0.06, vec![Bearing::radial(0.0, 1e9), Bearing::radial(length, 1e9)]);
    let modes = single(&bar, None).1;
    let [sound, shear_wave] = [E_PA, SHEAR_MODULUS_PA].map(|modulus| (modulus / RHO).sqrt());
    let tolerance = Tolerance::Relative(1e-4);
    check(TOPIC, "free bar in torsion, Hz", of_kind(&modes, 2)[0], shear_wave / (2.0 * length), tolerance);
    check(TOPIC, "free bar in tension, Hz", of_kind(&modes, 1)[0], sound / (2.0 * length), tolerance);
    bar.coupling.axial_n_per_m = RIGID;
    let modes = single(&bar, None).1;
    check(TOPIC, "bar in tension held at one end, Hz", of_kind(&modes, 1)[0], sound / (4.0 * length), tolerance);
}

/// Halving the elements divides the error of the highest mode compared by four.
#[test]
fn frequencies_converge_with_the_square_of_the_elements() {
    let beam = uniform(0.5, 0.06, vec![Bearing::radial(0.1, 3e8), Bearing::radial(0.4, 5e8)]);
    let highest = |element_m: f64| {
        *single(&beam, Some(element_m)).1.natural_frequencies_hz().iter().rfind(|f| **f < 6000.0).unwrap()
    };
    let [coarse, middle, fine] = [10e-3, 5e-3, 2.5e-3].map(highest);
    let order = ((coarse - middle) / (middle - fine)).log2();
    check(TOPIC, "order of convergence over the element length", order, 2.0, Tolerance::Absolute(0.1));
}

/// Two inertias joined by both meshes; everything else is stiff and light.
#[test]
fn two_inertias_and_the_mesh() {
    let pair = pair();
    let body = |polar_inertia_kg_m2| RigidBody { mass_kg: 1e-4, polar_inertia_kg_m2, diametral_inertia_kg_m2: 1e-7 };
    let mut pinion = inert(0.4);
    pinion.material = RIGID_MATERIAL;
    pinion.half_body = Some(body(0.01));
    let mut gear = inert(0.4);
    gear.material = RIGID_MATERIAL;
    gear.half_body = Some(body(0.2));
    let (stiffness, beta) = (1e9, pair.base_helix_angle_rad);
    let meshes = Half::BOTH.map(|half| MeshElement::at_mid_face(&pair, half, stiffness, 0.0));
    let rotor = GearedRotor::new(&ShaftTrain { pinion, gear }, &pair, RotationSense::Negative, &meshes).unwrap();
    let modes = rotor.modes(ModeRange { up_to_hz: 5000.0, most: 10 }).unwrap();
    let radii = [pair.pinion.base_radius_m, pair.gear.base_radius_m];
    let shaft_inertia = LIGHT_AND_STIFF.density_kg_m3 * 2.0 * second_moment_m4(0.4, 0.0) * 0.12;
    let inverse: f64 = [0.02, 0.4].iter().zip(radii).map(|(j, r)| (r * beta.cos()).powi(2) / (j + shaft_inertia)).sum();
    let exact = (2.0 * stiffness * inverse).sqrt() / TAU;
    let frequencies = modes.natural_frequencies_hz();
    assert_eq!([modes.rigid_body_modes(), frequencies.len()], [1, 1]);
    check(TOPIC, "two inertias and the meshes, Hz", frequencies[0], exact, Tolerance::Relative(1e-4));
    let excitation =
        Harmonics { frequency_hz: 0.6 * exact, excitation_m: [Complex::new(1e-6, 0.0); 2], pinion_speed_rad_s: 0.0 };
    let response = rotor.frequency_response(&excitation).unwrap();
    // s = e/(1 − (ω/ω_0)²), F = k (s − e).
    let force = stiffness * 1e-6 * 0.36 / (1.0 - 0.36);
    let tolerance = Tolerance::Relative(2e-4);
    check(TOPIC, "forced, two inertias, mesh force, N", response.mesh_force_n[0].re, force, tolerance);
}

/// A disc at the end of a clamped light shaft: whirl frequencies at 6000 r/min from its flexibility.
#[test]
fn whirl_of_an_overhung_disc() {
    let (length, diameter) = (0.4, 0.03);
    let mut beam = uniform(length, diameter, vec![clamp(0.0)]);
    beam.material.density_kg_m3 = 1.0;
    let disc = RigidBody { mass_kg: 12.0, polar_inertia_kg_m2: 0.12, diametral_inertia_kg_m2: 0.065 };
    beam.bodies.push((length, disc));
    let speed = 6000.0 * TAU / 60.0;
    let (rotor, modes) = single(&beam, None);
    let whirl = rotor.whirl_frequencies_hz(&modes, speed).unwrap();

    let (ei, shear) = (E_PA * second_moment_m4(diameter, 0.0), shear_stiffness_n(diameter, 0.0));
    let flexibility = [
        [length.powi(3) / (3.0 * ei) + length / shear, length * length / (2.0 * ei)],
        [length * length / (2.0 * ei), length / ei],
    ];
    let determinant = flexibility[0][0] * flexibility[1][1] - flexibility[0][1].powi(2);
    let [k_uu, k_up, k_pp] =
        [flexibility[1][1], -flexibility[0][1], flexibility[0][0]].map(|value| value / determinant);
    // Forward whirl ω > 0, backward whirl ω < 0.
    let characteristic = |omega: f64| {
        let translation = k_uu - omega * omega * disc.mass_kg;
        let rotation = k_pp - omega * omega * disc.diametral_inertia_kg_m2 + omega * speed * disc.polar_inertia_kg_m2;
        translation * rotation - k_up * k_up
    };
    let mut exact = Vec::new();
    for step in -40000..40000 {
        let (mut low, mut high) = (0.1 * f64::from(step), 0.1 * f64::from(step + 1));
        if characteristic(low) * characteristic(high) < 0.0 {
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                let same = characteristic(low) * characteristic(middle) > 0.0;
                if same { low = middle } else { high = middle }
            }
            exact.push(low.abs() / TAU);
        }
    }
    exact.sort_by(f64::total_cmp);
    assert_eq!(exact.len(), 4, "{exact:?}");
    for (i, exact) in exact.into_iter().enumerate() {
        let quantity = format!("overhung disc at 6000 r/min, whirl {}, Hz", i + 1);
        check(TOPIC, &quantity, whirl[i], exact, Tolerance::Relative(1e-5));
    }
}

/// Damping ratio of a rigid rotor on bearings with dampers, and the limit of stability of cross-coupled bearings.
#[test]
fn damped_and_unstable_whirl() {
    let (stiffness, damping) = (4e7, 3000.0);
    let mut beam = uniform(0.4, 0.2, Vec::new());
    beam.material = RIGID_MATERIAL;
    let disc = RigidBody { mass_kg: 20.0, polar_inertia_kg_m2: 0.1, diametral_inertia_kg_m2: 0.1 };
    beam.bodies.push((0.2, disc));
    let mass = disc.mass_kg + LIGHT_AND_STIFF.density_kg_m3 * PI / 4.0 * 0.04 * 0.4;
    let bearing = |position_m: f64, cross: f64| Bearing {
        radial_n_per_m: [[stiffness, cross], [-cross, stiffness]],
        radial_damping_n_s_per_m: [[damping, 0.0], [0.0, damping]],
        ..Bearing::radial(position_m, 0.0)
    };
    let omega = (2.0 * stiffness / mass).sqrt();
    // The whirl that the cross stiffness drives: s² + (2c/m) s + ω² ∓ i 2k_x/m = 0.
    for (name, cross) in
        [("isotropic", 0.0), ("cross-coupled", 0.5 * damping * omega), ("unstable", 1.5 * damping * omega)]
    {
        beam.bearings = vec![bearing(0.0, cross), bearing(0.4, cross)];
        let (rotor, modes) = single(&beam, None);
        let found = rotor.damped_modes(&modes, 0.0).unwrap();
        let half = damping / mass;
        let root = Complex::new(half * half - omega * omega, 2.0 * cross / mass).sqrt();
        let exact = [root - half, -root - half]
            .map(|s: Complex<f64>| -s.re / s.norm())
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        let lateral = found.iter().filter(|mode| (mode.frequency_hz * TAU / omega - 1.0).abs() < 0.1);
        let least = lateral.map(|mode| mode.damping_ratio).fold(f64::INFINITY, f64::min);
        let quantity = format!("rigid rotor on {name} bearings, least damping ratio");
        check(TOPIC, &quantity, least, exact, Tolerance::Relative(1e-3));
    }
}

/// The other program's shafts alone were compared with ROSS 2.3.0, with elements of 10 mm.
#[rstest]
#[case("geared_straddle")]
#[case("motor_and_load")]
fn single_shafts_of_ross(#[case] name: &str) {
    let all: Value = serde_json::from_str(include_str!("../../../../../tests/data/shafts_ross.json")).unwrap();
    let Case { train, sense, .. } = case(name);
    for (member, shaft) in [("pinion", &train.pinion), ("gear", &train.gear)] {
        let mut alone = shaft.clone();
        alone.coupling.torsional = None;
        let (rotor, modes) = single(&alone, Some(10e-3));
        for rpm in [0.0, 6000.0] {
            let comparison = format!("{name}: single {member} shaft, {rpm} rpm");
            let entry = all.as_array().unwrap().iter().find(|entry| entry["comparison"] == *comparison).unwrap();
            let whirl = rotor.whirl_frequencies_hz(&modes, sense.sign() * rpm * TAU / 60.0).unwrap();
            let expected = entry["ross_hz"].as_array().unwrap();
            let errors = expected.iter().zip(&whirl).map(|(e, own)| own / e.as_f64().unwrap() - 1.0);
            check_worst("Shafts: ROSS", &format!("{comparison}, relative"), errors, 1e-4);
        }
    }
}

#[test]
fn unusable_rotors_are_refused() {
    let Case { train, pair, sense, meshes, .. } = case("geared_straddle");
    let refused =
        |train: &ShaftTrain, meshes: &[MeshElement; 2]| GearedRotor::new(train, &pair, sense, meshes).unwrap_err();
    let mut floating = train.clone();
    floating.gear.bearings.iter_mut().for_each(|bearing| bearing.axial_n_per_m = 0.0);
    assert_eq!(refused(&floating, &meshes), ShaftError::BothFloatAxially);
    let mut outside = train.clone();
    outside.pinion.gear_position_m = 0.02;
    assert!(matches!(refused(&outside, &meshes), ShaftError::OutsideShaft { .. }));
    let mut negative = meshes;
    negative[1].stiffness_n_per_m = f64::NAN;
    assert!(matches!(refused(&train, &negative), ShaftError::InvalidValue { .. }));
    // Cross terms whose symmetric part is stronger than the direct stiffness.
    let mut unstable = train.clone();
    unstable.pinion.bearings.iter_mut().for_each(|bearing| bearing.radial_n_per_m = [[1e9, 3e9], [3e9, 1e9]]);
    let rotor = GearedRotor::new(&unstable, &pair, sense, &meshes).unwrap();
    let range = ModeRange { up_to_hz: 3000.0, most: 40 };
    assert!(matches!(rotor.modes(range), Err(ShaftError::NegativeStiffness { .. })));
    assert!(matches!(rotor.modes(ModeRange { up_to_hz: 0.0, ..range }), Err(ShaftError::InvalidRange { .. })));
}

/// A rigid body that tilts on its bearing against the tilting stiffness of one mesh.
#[test]
fn tilting_stiffness_of_a_mesh() {
    let pair = pair();
    let (bearing_nm, mesh_nm, inertia) = (2e5, 5e5, 0.5);
    let left_m = -0.5 * (pair.spec.gap_width_m + pair.spec.face_width_m);
    let mut gear = inert(0.2);
    let middle_m = gear.gear_position_m + left_m;
    gear.bearings = vec![Bearing { tilting_nm_per_rad: bearing_nm, ..clamp(middle_m) }];
    gear.bodies
        .push((middle_m, RigidBody { mass_kg: 1.0, polar_inertia_kg_m2: 1.0, diametral_inertia_kg_m2: inertia }));
    let mesh = MeshElement { tilting_nm_per_rad: mesh_nm, ..MeshElement::at_mid_face(&pair, Half::Left, 0.0, 0.0) };
    let meshes = [mesh, MeshElement::at_mid_face(&pair, Half::Right, 0.0, 0.0)];
    let train = ShaftTrain { pinion: inert(0.4), gear: gear.clone() };
    let rotor = GearedRotor::new(&train, &pair, RotationSense::Positive, &meshes).unwrap();
    let modes = rotor.modes(ModeRange { up_to_hz: 2000.0, most: 10 }).unwrap();
    // The gear's beam around the bearing's section, as a rigid cylinder.
    let (length, diameter) = (0.12, 0.2);
    let mass = LIGHT_AND_STIFF.density_kg_m3 * PI / 4.0 * diameter * diameter * length;
    let beam = mass * (3.0 * 0.25 * diameter * diameter + length * length) / 12.0 + mass * left_m * left_m;
    let frequency = |stiffness: f64| (stiffness / (inertia + beam)).sqrt() / TAU;
    let found = modes.natural_frequencies_hz();
    assert_eq!(found.len(), 2, "{found:?}");
    let tolerance = Tolerance::Relative(2e-4);
    check(TOPIC, "rigid gear tilting across the plane of action, Hz", found[0], frequency(bearing_nm), tolerance);
    let cos2 = pair.base_helix_angle_rad.cos().powi(2);
    let exact = frequency(bearing_nm + mesh_nm * cos2);
    check(TOPIC, "rigid gear tilting in the plane of action, Hz", found[1], exact, tolerance);
}
