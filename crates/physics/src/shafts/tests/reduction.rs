//! The reduced rotor against the full model.

use std::f64::consts::TAU;

use herringbone_oracle::{Tolerance, check, check_worst};
use nalgebra::{Complex, DMatrix, DVector};

use super::reference::{Case, case};
use crate::shafts::{FrequencyResponse, Harmonics, ReductionSettings, SectionLoad};
use crate::watch::Watch;

const TOPIC: &str = "Shafts: reduction to modal coordinates";

/// A reduction to a given number of coordinates, at 3000 r/min.
fn settings(case: &Case, up_to_hz: f64, most_coordinates: usize) -> ReductionSettings {
    let pinion_speed_rad_s = case.sense.sign() * 3000.0 * TAU / 60.0;
    ReductionSettings { up_to_hz, accuracy: 0.0, most_coordinates, pinion_speed_rad_s }
}

fn excitation(case: &Case, frequency_hz: f64) -> Harmonics {
    Harmonics {
        frequency_hz,
        excitation_m: [Complex::new(1e-6, 0.0), Complex::new(0.0, 0.7e-6)],
        pinion_speed_rad_s: case.sense.sign() * 3000.0 * TAU / 60.0,
    }
}

/// Largest difference of mesh forces and of bearing forces, each over the largest of its kind.
fn differences(got: &FrequencyResponse, exact: &FrequencyResponse) -> [f64; 2] {
    let forces = |response: &FrequencyResponse| -> Vec<Complex<f64>> {
        response.bearings.iter().flatten().flat_map(|force| force[..3].to_vec()).collect()
    };
    let worst = |got: &[Complex<f64>], exact: &[Complex<f64>]| {
        let largest = exact.iter().fold(0.0f64, |l, force| l.max(force.norm()));
        got.iter().zip(exact).fold(0.0f64, |w, (g, e)| w.max((g - e).norm())) / largest
    };
    [worst(&got.mesh_force_n, &exact.mesh_force_n), worst(&forces(got), &forces(exact))]
}

#[test]
fn accuracy_grows_with_the_number_of_coordinates() {
    for (name, up_to_hz) in [("geared_straddle", 4000.0), ("motor_and_load", 3000.0)] {
        let case = case(name);
        let rotor = case.rotor();
        let mut before = f64::INFINITY;
        for (coordinates, tolerance) in [(24, 0.03), (32, 0.01), (40, 5e-3), (48, 3e-4), (60, 2e-4)] {
            let reduced = rotor.reduce(&settings(&case, up_to_hz, coordinates), Watch::none()).unwrap();
            assert!(reduced.coordinates() <= coordinates);
            let mut errors = [0.0f64; 2];
            // Not the frequencies of the estimate, and away from resonances.
            for step in 0..29 {
                let excitation = excitation(&case, up_to_hz * (0.03 + 0.0345 * f64::from(step)));
                let exact = rotor.frequency_response(&excitation).unwrap();
                let got = reduced.frequency_response(&excitation).unwrap();
                let error = differences(&got, &exact);
                errors = [errors[0].max(error[0]), errors[1].max(error[1])];
            }
            let kind = format!("{name}, {coordinates} coordinates, up to {up_to_hz} Hz");
            check_worst(TOPIC, &format!("{kind}, mesh forces"), [errors[0]], tolerance);
            check_worst(TOPIC, &format!("{kind}, bearing forces"), [errors[1]], tolerance);
            let estimate = reduced.report.estimated_error;
            assert!(errors.iter().all(|error| *error <= estimate), "{kind}: {errors:?}, estimated {estimate}");
            assert!(estimate <= 1.001 * before, "{kind}: {estimate} after {before}");
            before = estimate;
        }
    }
}

/// The estimate leads to a basis that is as accurate as was asked for.
#[test]
fn requested_accuracy_is_reached() {
    let case = case("motor_and_load");
    let rotor = case.rotor();
    for accuracy in [1e-2, 1e-3] {
        let reduced =
            rotor.reduce(&ReductionSettings { accuracy, ..settings(&case, 3000.0, 98) }, Watch::none()).unwrap();
        assert!(reduced.report.estimated_error <= accuracy);
        let errors = (0..29).flat_map(|step| {
            let excitation = excitation(&case, 3000.0 * (0.03 + 0.0345 * f64::from(step)));
            let exact = rotor.frequency_response(&excitation).unwrap();
            differences(&reduced.frequency_response(&excitation).unwrap(), &exact)
        });
        check_worst(TOPIC, &format!("accuracy {accuracy} asked for, mesh and bearing forces"), errors, accuracy);
    }
}

/// The equations of motion that are handed over, solved here for a harmonic excitation, against the full model: signs
/// and order of the matrices, rows of the outputs.
#[test]
fn handed_over_equations_are_those_of_the_rotor() {
    let mut case = case("geared_straddle");
    for bearing in &mut case.train.gear.bearings {
        bearing.radial_n_per_m = [[1.2e9, 3e8], [-1e8, 1.2e9]];
        bearing.tilting_nm_per_rad = 1e5;
    }
    let rotor = case.rotor();
    let reduced = rotor.reduce(&settings(&case, 4000.0, 70), Watch::none()).unwrap();
    let excitation = excitation(&case, 900.0);
    let train = reduced.train(excitation.pinion_speed_rad_s, 800.0);
    train.validate().unwrap();
    let n = train.len();
    let omega = TAU * excitation.frequency_hz;
    let cross = train.cross_stiffness_per_s2.as_ref().unwrap();
    let mut dynamic = DMatrix::from_fn(n, n, |i, j| {
        let diagonal = if i == j { train.eigenvalues_rad2_s2[i] - omega * omega } else { 0.0 };
        Complex::new(diagonal + cross[i * n + j], omega * train.damping_per_s[i * n + j])
    });
    let mut force = DVector::from_element(n, Complex::new(0.0, 0.0));
    let impedance = Complex::new(0.0, omega * 4000.0);
    for half in 0..2 {
        // k_ref s − F with F = (k + iωc)(s − e), k = k_ref.
        let row = DVector::from_iterator(n, train.mesh[half].iter().map(|h| Complex::new(*h, 0.0)));
        dynamic += &row * row.transpose() * impedance;
        force += row * ((impedance + train.reference_stiffness_n_per_m[half]) * excitation.excitation_m[half]);
    }
    let q = dynamic.lu().solve(&force).unwrap();
    let exact = rotor.frequency_response(&excitation).unwrap();
    let mut errors = Vec::new();
    let largest = exact.bearings.iter().flatten().fold(0.0f64, |l, f| l.max(f[0].norm()).max(f[1].norm()));
    for (member, name) in ["pinion", "gear"].into_iter().enumerate() {
        for (number, exact) in exact.bearings[member].iter().enumerate() {
            for (i, quantity) in ["f_x", "f_y"].into_iter().enumerate() {
                let name = format!("{quantity}_{name}_bearing_{}", number + 1);
                let output = train.outputs.iter().find(|output| output.name == name).unwrap();
                let velocity = output.velocity.iter().chain(std::iter::repeat(&0.0));
                let rows = output.displacement.iter().zip(velocity).zip(&q);
                let got: Complex<f64> = rows.map(|((k, c), q)| Complex::new(*k, omega * c) * q).sum();
                errors.push((got - exact[i]).norm() / largest);
            }
        }
    }
    assert_eq!(errors.len(), 8);
    check_worst(TOPIC, "bearing forces by the equations handed over, over the largest", errors, 1e-4);
}

/// Static mesh forces give the bearing forces of the static flexibility: two independent formulations.
#[test]
fn static_bearing_forces() {
    let case = case("geared_straddle");
    let (rotor, torque_nm) = (case.rotor(), 800.0);
    let train = rotor.reduce(&settings(&case, 4000.0, 70), Watch::none()).unwrap().train(0.0, torque_nm);
    let q: Vec<f64> = (train.load_n.iter().zip(&train.eigenvalues_rad2_s2))
        .map(|(load, eigenvalue)| if *eigenvalue > 0.0 { load / eigenvalue } else { 0.0 })
        .collect();
    let product = |row: &[f64]| row.iter().zip(&q).map(|(a, b)| a * b).sum::<f64>();
    let forces = [0, 1].map(|half| train.reference_stiffness_n_per_m[half] * product(&train.mesh[half]));
    let (pair, beta) = (&case.pair, case.pair.base_helix_angle_rad);
    let total = torque_nm / (pair.pinion.base_radius_m * beta.cos());
    check(TOPIC, "static mesh forces of both halves, N", forces[0] + forces[1], total, Tolerance::Relative(1e-9));

    let (alpha, sense) = (pair.working_pressure_angle_rad, case.sense.sign());
    let pitch_m = pair.pinion.base_radius_m / alpha.cos();
    let loads: Vec<SectionLoad> = (0..2)
        .map(|half| {
            // Apex leading: σ H of the right half is −1. On the pinion acts −n f at (r_1, 0, 0).
            let hand = [1.0, -1.0][half];
            let n = [alpha.sin() * beta.cos(), sense * alpha.cos() * beta.cos(), -hand * beta.sin()];
            let force = n.map(|n| -n * forces[half]);
            let moment = [0.0, -pitch_m * force[2], pitch_m * force[1]];
            let load = [force[0], force[1], force[2], moment[0], moment[1], moment[2]];
            SectionLoad { z_m: case.meshes[half].position_m, load }
        })
        .collect();
    let state = case.train.pinion.deflection(&loads, &[]).unwrap();
    let errors = state.bearings.iter().enumerate().flat_map(|(number, exact)| {
        ["f_x", "f_y"].into_iter().enumerate().map({
            let (train, product) = (&train, &product);
            move |(i, quantity)| {
                let name = format!("{quantity}_pinion_bearing_{}", number + 1);
                let output = train.outputs.iter().find(|output| output.name == name).unwrap();
                (product(&output.displacement) - exact[i]) / total
            }
        })
    });
    check_worst(TOPIC, "static bearing forces against the static flexibility, over the mesh force", errors, 1e-6);
}

/// The rows of the twelve displacements against the mode shapes, and the meshes' displacement of them and of the tilt.
#[test]
fn twelve_displacements() {
    let case = case("geared_straddle");
    let reduced = case.rotor().reduce(&settings(&case, 4000.0, 60), Watch::none()).unwrap();
    let train = reduced.train(0.0, 0.0);
    let pair = &case.pair;
    let (alpha, beta) = (pair.working_pressure_angle_rad, pair.base_helix_angle_rad);
    let radii = [pair.pinion.base_radius_m, pair.gear.base_radius_m];
    let (mut rows, mut meshes) = (Vec::new(), Vec::new());
    for (i, mode) in reduced.modes.modes.iter().enumerate() {
        // σ = −1, left half left-handed: y along (sin α, −cos α), z against z, θ in the sense of each member.
        let shape: [f64; 12] = std::array::from_fn(|c| {
            let (half, member) = (c / 6, c / 3 % 2);
            let section = mode.mid_face[2 * member + half];
            match c % 3 {
                0 => alpha.sin() * section[0] - alpha.cos() * section[1],
                1 => -section[2],
                _ => [-1.0, 1.0][member] * section[5] / radii[member],
            }
        });
        let got: [f64; 12] = std::array::from_fn(|c| train.displacements[c][i]);
        let square = shape.iter().map(|u| u * u).sum::<f64>();
        let scale = shape.iter().zip(&got).map(|(a, b)| a * b).sum::<f64>() / square;
        rows.extend(shape.iter().zip(&got).map(|(a, b)| (b / scale - a) / square.sqrt()));
        for half in 0..2 {
            let beta = [beta, -beta][half];
            let [y_p, z_p, theta_p, y_g, z_g, theta_g]: [f64; 6] = std::array::from_fn(|c| shape[6 * half + c]);
            let along = beta.cos() * (y_p - y_g + radii[0] * theta_p - radii[1] * theta_g) + beta.sin() * (z_p - z_g);
            // The lever to the pitch point: tilting about y moves it axially.
            let tilt: f64 = (0..2).map(|member| mode.mid_face[2 * member + half][4] / alpha.cos()).sum();
            let s = along + beta.sin() * tilt;
            meshes.push(train.mesh[half][i] / scale - s);
        }
    }
    check_worst(TOPIC, "twelve displacements against the mode shapes", rows, 1e-9);
    check_worst(TOPIC, "displacements of the meshes against the mode shapes", meshes, 1e-9);
}
