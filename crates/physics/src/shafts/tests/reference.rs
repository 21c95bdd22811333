//! The geared rotors of `tests/data/shafts_dynamic.json`, calculated by another program.

use std::f64::consts::TAU;

use herringbone_oracle::{Tolerance, check, check_worst};
use nalgebra::Complex;
use serde_json::Value;

use crate::gear::{Half, Pair, fixtures};
use crate::shafts::{
    Bearing, Coupling, FrequencyResponse, GearedRotor, Harmonics, Machine, MeshElement, ModeRange, RigidBody,
    RotationSense, RotorMode, Shaft, ShaftSegment, ShaftTrain,
};

use super::fixtures::STEEL;

const TOPIC: &str = "Shafts: geared rotors";

/// A rotor of the reference with its result.
pub(super) struct Case {
    pub(super) train: ShaftTrain,
    pub(super) pair: Pair,
    pub(super) sense: RotationSense,
    pub(super) meshes: [MeshElement; 2],
    case: Value,
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(0.0)
}

fn shaft(value: &Value) -> Shaft {
    let mm = |value: &Value| number(value) * 1e-3;
    let n_per_um = |value: &Value| number(value) * 1e6;
    let list = |name: &str| value[name].as_array().unwrap().clone();
    let bearing = |b: &Value| {
        let along = |name: &str| if b[name].is_null() { n_per_um(&b["radial_n_per_um"]) } else { n_per_um(&b[name]) };
        let damping = number(&b["radial_damping_ns_per_m"]);
        Bearing {
            radial_n_per_m: [[along("radial_x_n_per_um"), 0.0], [0.0, along("radial_y_n_per_um")]],
            radial_damping_n_s_per_m: [[damping, 0.0], [0.0, damping]],
            axial_n_per_m: n_per_um(&b["axial_n_per_um"]),
            axial_damping_n_s_per_m: number(&b["axial_damping_ns_per_m"]),
            ..Bearing::radial(mm(&b["position_mm"]), 0.0)
        }
    };
    let coupling = &value["coupling"];
    let body = &value["half_body"];
    Shaft {
        segments: list("segments")
            .iter()
            .map(|s| ShaftSegment {
                length_m: mm(&s["length_mm"]),
                diameter_m: mm(&s["diameter_mm"]),
                bore_m: mm(&s["bore_mm"]),
            })
            .collect(),
        gear_position_m: mm(&value["gear_position_mm"]),
        bearings: list("bearings").iter().map(bearing).collect(),
        coupling: Coupling {
            position_m: mm(&coupling["position_mm"]),
            axial_n_per_m: n_per_um(&coupling["axial_n_per_um"]),
            torsional: coupling["inertia_kg_m2"].as_f64().map(|inertia_kg_m2| Machine {
                torsional_nm_per_rad: number(&coupling["torsional_nm_per_rad"]),
                torsional_damping_nm_s_per_rad: 0.0,
                inertia_kg_m2,
            }),
        },
        half_body: Some(RigidBody {
            mass_kg: number(&body["mass_kg"]),
            polar_inertia_kg_m2: number(&body["polar_inertia_kg_m2"]),
            diametral_inertia_kg_m2: number(&body["diametral_inertia_kg_m2"]),
        }),
        bodies: Vec::new(),
        material: STEEL,
    }
}

/// The case of a name.
pub(super) fn case(name: &str) -> Case {
    let cases: Value = serde_json::from_str(include_str!("../../../../../tests/data/shafts_dynamic.json")).unwrap();
    let case = cases.as_array().unwrap().iter().find(|case| case["name"] == name).unwrap().clone();
    let (design, model) = (&case["input"]["design"], &case["input"]["model"]);
    let pair = fixtures::pair(&fixtures::source_pair(1.0));
    assert_eq!(design["gap_width_mm"], 30.0);
    assert_eq!(case["input"]["operation"]["rotation"], "apex_leading");
    let stiffness = number(&model["mesh_stiffness"]["mean_n_per_um"]) * 1e6;
    let damping = number(&model["mesh_damping_ns_per_m"]);
    Case {
        train: ShaftTrain { pinion: shaft(&design["shafts"]["pinion"]), gear: shaft(&design["shafts"]["gear"]) },
        sense: RotationSense::of(pair.spec.rotation, design["pinion"]["left_half_hand"] == "left"),
        meshes: Half::BOTH.map(|half| MeshElement::at_mid_face(&pair, half, stiffness, damping)),
        pair,
        case,
    }
}

impl Case {
    pub(super) fn rotor(&self) -> GearedRotor {
        GearedRotor::new(&self.train, &self.pair, self.sense, &self.meshes).unwrap()
    }
}

fn list(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

fn relative<'a>(got: &'a [f64], expected: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    assert!(got.len() >= expected.len(), "{got:?} {expected:?}");
    got.iter().zip(expected).map(|(got, expected)| got / expected - 1.0)
}

fn compare_modes(name: &str, speed_rpm: f64) {
    let case = case(name);
    let rotor = case.rotor();
    let modes = rotor.modes(ModeRange { up_to_hz: 12000.0, most: 80 }).unwrap();
    let result = &case.case["result"];
    check(TOPIC, &format!("{name}, rigid-body modes"), modes.rigid_body_modes() as f64, 1.0, Tolerance::Absolute(0.0));
    let frequencies = modes.natural_frequencies_hz();
    let expected = list(&result["natural_frequencies_hz"]);
    check_worst(TOPIC, &format!("{name}, natural frequencies, relative"), relative(&frequencies, &expected), 1e-4);

    let whirl = rotor.whirl_frequencies_hz(&modes, case.sense.sign() * speed_rpm * TAU / 60.0).unwrap();
    let expected = list(&result[format!("with_gyroscopic_hz_at_{speed_rpm}_rpm")]);
    let quantity = format!("{name}, natural frequencies at {speed_rpm} rpm, relative");
    check_worst(TOPIC, &quantity, relative(&whirl, &expected), 1e-4);

    let elastic: Vec<&RotorMode> = modes.modes.iter().filter(|mode| mode.frequency_hz > 0.0).collect();
    let (mut strain, mut kinetic, mut shapes) = (Vec::new(), Vec::new(), Vec::new());
    for (mode, expected) in elastic.iter().zip(result["modes"].as_array().unwrap()) {
        let (mesh, energy) = (&expected["strain_energy_mesh"], &expected["kinetic_energy"]);
        strain.push(mode.strain.meshes[0] - number(&mesh["left"]));
        strain.push(mode.strain.meshes[1] - number(&mesh["right"]));
        strain.push(mode.strain.all_bearings() - number(&expected["strain_energy_bearings"]));
        let own = &mode.kinetic;
        let values = [own.lateral, own.axial, own.torsion, own.pinion_shaft, own.gear_shaft];
        let names = ["lateral", "axial", "torsion", "pinion_shaft", "gear_shaft"];
        kinetic.extend(values.iter().zip(names).map(|(value, name)| value - number(&energy[name])));
        let sections = ["pinion_left", "pinion_right", "gear_left", "gear_right"];
        for (section, name) in mode.mid_face.iter().zip(sections) {
            shapes.extend(section.iter().zip(list(&expected["shape"][name])).map(|(u, expected)| u - expected));
        }
    }
    check_worst(TOPIC, &format!("{name}, shares of strain energy in meshes and bearings"), strain, 1e-3);
    check_worst(TOPIC, &format!("{name}, shares of kinetic energy"), kinetic, 1e-3);
    check_worst(TOPIC, &format!("{name}, mode shapes at mid-face"), shapes, 3e-3);
}

#[test]
fn modes_of_geared_straddle() {
    compare_modes("geared_straddle", 3000.0);
}

#[test]
fn modes_of_motor_and_load() {
    compare_modes("motor_and_load", 6000.0);
}

#[test]
fn forced_response_of_geared_straddle() {
    let case = case("geared_straddle");
    let rotor = case.rotor();
    for forced in case.case["forced"].as_array().unwrap() {
        let rpm = number(&forced["pinion_speed_rpm"]);
        for (terms, gyroscopic) in [("without_gyroscopic", 0.0), ("with_gyroscopic", 1.0)] {
            let response = rotor
                .frequency_response(&Harmonics {
                    frequency_hz: number(&forced["mesh_frequency_hz"]),
                    excitation_m: [Complex::new(1e-6, 0.0); 2],
                    pinion_speed_rad_s: gyroscopic * case.sense.sign() * rpm * TAU / 60.0,
                })
                .unwrap();
            compare_response(&format!("{rpm} rpm {}", terms.replace('_', " ")), &response, &forced[terms]);
        }
    }
}

fn compare_response(name: &str, response: &FrequencyResponse, expected: &Value) {
    let sides = ["left", "right"];
    let amplitudes =
        (0..2).map(|i| response.mesh_force_n[i].norm() / number(&expected["mesh_force_amplitude_n"][sides[i]]) - 1.0);
    check_worst(TOPIC, &format!("forced, {name}, mesh forces, relative"), amplitudes, 2e-4);
    let phases = (0..2).map(|i| response.mesh_force_n[i].arg() - number(&expected["mesh_force_phase_rad"][sides[i]]));
    check_worst(TOPIC, &format!("forced, {name}, mesh force phases, rad"), phases, 2e-4);
    let forces: Vec<_> = response.bearings.iter().flatten().collect();
    let stated = expected["bearing_force_amplitude_n"].as_array().unwrap();
    assert_eq!(forces.len(), stated.len());
    let largest = stated.iter().flat_map(|b| ["x", "y", "z"].map(|axis| number(&b[axis]))).fold(0.0, f64::max);
    let errors = forces.iter().zip(stated).flat_map(|(force, stated)| {
        ["x", "y", "z"]
            .into_iter()
            .enumerate()
            .map(move |(i, axis)| (force[i].norm() - number(&stated[axis])) / largest)
    });
    check_worst(TOPIC, &format!("forced, {name}, bearing forces over the largest"), errors, 2e-4);
}
