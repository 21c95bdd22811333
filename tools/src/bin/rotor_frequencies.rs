//! Geared rotors with their division into elements and their natural frequencies, as JSON on standard output: our side
//! of the comparison with ROSS (`scripts/ross`).
//!
//! `scripts/tool rotor_frequencies`

use std::f64::consts::TAU;

use herringbone_physics::gear::{GearSpec, Half, MemberId, Pair, PairSpec};
use herringbone_physics::shafts::{
    Bearing, Coupling, GearedRotor, MeshElement, ModeRange, RigidBody, RotationSense, Shaft, ShaftMaterial,
    ShaftSegment, ShaftTrain,
};
use herringbone_tools::Failure;
use serde_json::{Value, json};

/// Length of the elements, m: what ROSS solves in seconds.
const ELEMENT_M: f64 = 10e-3;
/// Modes on which the turning rotor is projected reach far beyond the frequencies compared.
const MODES: ModeRange = ModeRange { up_to_hz: 60e3, most: 160 };
const COMPARED: usize = 24;
const SPEEDS_RPM: [f64; 2] = [0.0, 6000.0];

fn main() -> Result<(), Failure> {
    let double_helical = pair(24.43)?;
    let spur = pair(0.0)?;
    let (straddle, unequal) = (straddle(), unequal());
    let cases = [
        case("straddle, no mesh", &straddle, &double_helical, [0.0; 2])?,
        case("unequal bearings, no mesh", &unequal, &double_helical, [0.0; 2])?,
        case("straddle, both helical meshes", &straddle, &double_helical, [1.5e9, 1.2e9])?,
        case("unequal bearings, both helical meshes", &unequal, &double_helical, [1.5e9, 1.2e9])?,
        case("straddle, one spur mesh", &straddle, &spur, [0.0, 1e9])?,
    ];
    println!("{}", serde_json::to_string_pretty(&json!(cases))?);
    Ok(())
}

/// z 17/44, m_n 6 mm, two faces of 75 mm, gap 30 mm.
fn pair(helix_deg: f64) -> Result<Pair, Failure> {
    let angles = [20f64.to_radians(), helix_deg.to_radians()];
    let plain = PairSpec::plain(6e-3, angles, 75e-3, [17, 44].map(GearSpec::plain));
    let spec = PairSpec { gap_width_m: 0.03, ..plain };
    Ok(Pair::new(&spec).map_err(|reasons| format!("{reasons:?}"))?.0)
}

/// A shaft of segments (length, diameter, bore in mm).
fn shaft(segments_mm: &[[f64; 3]], gear_position_m: f64, bearings: Vec<Bearing>, body: RigidBody) -> Shaft {
    let segments = segments_mm.iter().map(|segment| {
        let [length_m, diameter_m, bore_m] = segment.map(|mm| mm * 1e-3);
        ShaftSegment { length_m, diameter_m, bore_m }
    });
    Shaft {
        segments: segments.collect(),
        gear_position_m,
        bearings,
        coupling: Coupling { position_m: 0.0, axial_n_per_m: 0.0, torsional: None },
        half_body: Some(body),
        bodies: Vec::new(),
        material: ShaftMaterial { youngs_modulus_pa: 206e9, poissons_ratio: 0.3, density_kg_m3: 7850.0 },
    }
}

/// Both shafts between isotropic bearings.
fn straddle() -> ShaftTrain {
    let body = |mass_kg, polar_inertia_kg_m2, diametral_inertia_kg_m2| RigidBody {
        mass_kg,
        polar_inertia_kg_m2,
        diametral_inertia_kg_m2,
    };
    let pinion = shaft(
        &[[110.0, 65.0, 0.0], [90.0, 78.0, 0.0], [180.0, 97.0, 0.0], [90.0, 78.0, 0.0]],
        0.29,
        vec![Bearing::radial(0.13, 9e8), Bearing::radial(0.45, 9e8)],
        body(1.5, 0.004, 0.0027),
    );
    let gear = shaft(
        &[[90.0, 110.0, 0.0], [180.0, 200.0, 0.0], [150.0, 105.0, 0.0]],
        0.18,
        vec![
            Bearing { axial_n_per_m: 4e8, ..Bearing::radial(0.025, 1.2e9) },
            Bearing { radial_n_per_m: [[1.2e9, 0.0], [0.0, 1.2e9]], ..Bearing::radial(0.335, 0.0) },
        ],
        body(20.0, 0.2, 0.11),
    );
    ShaftTrain { pinion, gear }
}

/// Hollow pinion, bearings of unequal stiffness with cross terms, a disc beside the gear.
fn unequal() -> ShaftTrain {
    let mut train = straddle();
    train.pinion.segments.iter_mut().for_each(|segment| segment.bore_m = 0.04);
    train.pinion.bearings[0].radial_n_per_m = [[5e8, 1e8], [1e8, 8e8]];
    train.pinion.bearings[1].radial_n_per_m = [[4e8, -0.5e8], [-0.5e8, 7e8]];
    train.gear.bearings[1].radial_n_per_m = [[6e8, 0.0], [0.0, 1e9]];
    let disc = RigidBody { mass_kg: 15.0, polar_inertia_kg_m2: 0.15, diametral_inertia_kg_m2: 0.08 };
    train.gear.bodies.push((0.42, disc));
    train
}

fn case(name: &str, train: &ShaftTrain, pair: &Pair, stiffness_n_per_m: [f64; 2]) -> Result<Value, Failure> {
    let sense = RotationSense::Positive;
    let meshes = Half::BOTH.map(|half| MeshElement::at_mid_face(pair, half, stiffness_n_per_m[half.index()], 0.0));
    let rotor = GearedRotor::with_element_length(train, pair, sense, &meshes, Some(ELEMENT_M))?;
    let modes = rotor.modes(MODES)?;
    let frequencies: Vec<Value> = SPEEDS_RPM
        .iter()
        .map(|rpm| {
            let mut frequencies_hz = rotor.whirl_frequencies_hz(&modes, sense.sign() * rpm * TAU / 60.0)?;
            frequencies_hz.truncate(COMPARED);
            Ok(json!({"pinion_speed_rpm": rpm, "frequencies_hz": frequencies_hz}))
        })
        .collect::<Result<_, Failure>>()?;
    let mid_face_m = meshes.map(|mesh| mesh.position_m);
    let shafts = [
        shaft_json(&train.pinion, rotor.stations_m(MemberId::Pinion), mid_face_m),
        shaft_json(&train.gear, rotor.stations_m(MemberId::Gear), mid_face_m),
    ];
    Ok(json!({
        "name": name,
        "shafts": shafts,
        "mesh": {
            "z_m": mid_face_m,
            "stiffness_n_per_m": stiffness_n_per_m,
            "working_pressure_angle_rad": pair.working_pressure_angle_rad,
            "base_helix_angle_rad": pair.base_helix_angle_rad,
            "base_radii_m": [pair.pinion.base_radius_m, pair.gear.base_radius_m],
            "teeth": [pair.pinion.teeth, pair.gear.teeth],
            "rotation_sense": sense.sign(),
            "apex_leading": true,
        },
        "rigid_body_modes": modes.rigid_body_modes(),
        "results": frequencies,
    }))
}

fn shaft_json(shaft: &Shaft, nodes_z_m: &[f64], mid_face_m: [f64; 2]) -> Value {
    let z = |position_m: f64| position_m - shaft.gear_position_m;
    let segments: Vec<Value> = shaft.segments.iter().map(|s| json!([s.length_m, s.diameter_m, s.bore_m])).collect();
    let bearings: Vec<Value> = shaft
        .bearings
        .iter()
        .map(|b| json!({"z_m": z(b.position_m), "radial_n_per_m": b.radial_n_per_m, "axial_n_per_m": b.axial_n_per_m}))
        .collect();
    let halves = shaft.half_body.iter().flat_map(|body| mid_face_m.map(|z_m| (z_m, *body)));
    let bodies: Vec<Value> = halves
        .chain(shaft.bodies.iter().map(|(position_m, body)| (z(*position_m), *body)))
        .map(|(z_m, body)| {
            json!({"z_m": z_m, "mass_kg": body.mass_kg, "polar_inertia_kg_m2": body.polar_inertia_kg_m2,
                   "diametral_inertia_kg_m2": body.diametral_inertia_kg_m2})
        })
        .collect();
    json!({
        "nodes_z_m": nodes_z_m,
        "segments_m": segments,
        "bearings": bearings,
        "bodies": bodies,
        "youngs_modulus_pa": shaft.material.youngs_modulus_pa,
        "poissons_ratio": shaft.material.poissons_ratio,
        "density_kg_m3": shaft.material.density_kg_m3,
    })
}
