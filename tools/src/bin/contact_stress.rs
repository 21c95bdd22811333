//! Stress test of the loaded tooth contact: random feasible designs and loads far beyond the usual, every one of which
//! has to give finite, non-negative, balanced forces and a stiffness curve whose steps shrink with the distance of the
//! positions.
//!
//! `scripts/tool contact_stress [DESIGNS [fe|analytic [SEED]]]`

use std::time::Instant;

use herringbone_physics::compliance::{BodyHold, Compliance, Settings};
use herringbone_physics::contact::solve_pair_of_halves;
use herringbone_physics::fe::{FlankFlexibility, Resolution};
use herringbone_physics::gear::{
    Assembly, EndRelief, FlankModification, GearSpec, Material, Pair, PairSpec, ReliefShape, Rotation, TipRelief,
};
use herringbone_physics::watch::Watch;
use herringbone_tools::Failure;
use herringbone_tools::arguments::Arguments;
use herringbone_tools::random::Random;

fn design(r: &mut Random) -> (PairSpec, f64, f64, Settings) {
    let module = r.log(0.5e-3, 20e-3);
    let teeth = [r.log(8.0, 150.0) as u32, r.log(10.0, 300.0) as u32];
    let addendum = r.between(0.5, 1.5);
    let flank = |r: &mut Random| FlankModification {
        tip_relief: TipRelief {
            amount_m: if r.chance(0.5) { r.log(1e-6, 300e-6) } else { 0.0 },
            length_m: r.between(0.1, 2.0) * module,
            shape: if r.chance(0.5) { ReliefShape::Linear } else { ReliefShape::Parabolic },
        },
        lead_crowning_m: if r.chance(0.3) { r.log(1e-6, 300e-6) } else { 0.0 },
        helix_slope_m: if r.chance(0.3) { r.between(-300e-6, 300e-6) } else { 0.0 },
        end_relief: EndRelief { amount_m: if r.chance(0.2) { 50e-6 } else { 0.0 }, length_m: module },
    };
    let gear = |r: &mut Random, z: u32| GearSpec {
        profile_shift: if r.chance(0.5) { r.between(-0.3, 0.8) } else { 0.0 },
        addendum,
        dedendum: addendum + 0.25,
        fillet_radius: r.between(0.1, 0.38),
        tip_alteration: 0.0,
        // From a solid shaft to a rim of one and a half modules.
        bore_radius_m: (r.between(0.05, 0.95) * (0.5 * f64::from(z) - addendum - 1.5) * module).max(0.1 * module),
        flanks: if r.chance(0.6) { [FlankModification::NONE; 2] } else { [flank(r), flank(r)] },
        ..GearSpec::plain(z)
    };
    let spec = PairSpec {
        normal_module_m: module,
        normal_pressure_angle_rad: r.between(14.5, 25.0f64).to_radians(),
        helix_angle_rad: if r.chance(0.15) { 0.0 } else { r.between(0.5, 45.0f64).to_radians() },
        face_width_m: r.log(2.0, 30.0) * module,
        gap_width_m: 5.0 * module,
        center_distance_m: None,
        material: Material {
            youngs_modulus_pa: r.log(2e9, 210e9),
            poissons_ratio: r.between(0.2, 0.4),
            density_kg_m3: 7850.0,
        },
        rotation: if r.chance(0.5) { Rotation::ApexLeading } else { Rotation::ApexTrailing },
        pinion: gear(r, teeth[0]),
        gear: gear(r, teeth[1]),
        assembly: Assembly {
            center_distance_error_m: 0.0,
            in_plane_misalignment_m: if r.chance(0.4) { r.between(-1e-3, 1e-3) } else { 0.0 },
            out_of_plane_misalignment_m: if r.chance(0.2) { r.between(-1e-3, 1e-3) } else { 0.0 },
            apex_offset_m: if r.chance(0.2) { r.between(-1e-3, 1e-3) } else { 0.0 },
        },
    };
    let settings = Settings {
        positions: Some(64),
        body: if r.chance(0.5) { BodyHold::Rim } else { BodyHold::Bore },
        corner_contact: r.chance(0.8),
        ..Settings::default()
    };
    let stagger = if r.chance(0.3) { r.unit() } else { 0.0 };
    (spec, r.log(1e-3, 1e6), stagger, settings)
}

/// An analysis with analytic compliance that takes longer is printed.
const SLOW_MS: f64 = 500.0;

fn compliance(pair: &Pair, settings: &Settings, elements: bool) -> Result<Compliance, String> {
    if !elements {
        return Compliance::analytic(pair, settings, Watch::none()).map_err(|error| error.to_string());
    }
    let [pinion, gear] = Compliance::finite_element_inputs(pair, settings, Resolution::Coarse)
        .map(|input| FlankFlexibility::new(&input, Watch::none()).map_err(|e| e.to_string()));
    Compliance::finite_elements(pair, settings, [&pinion?, &gear?], Watch::none()).map_err(|error| error.to_string())
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of_process();
    let wanted: usize = arguments.number(0)?.unwrap_or(300);
    let elements = arguments.word(1) == Some("fe");
    let seed = arguments.number(2)?.unwrap_or(1);
    let mut random = Random::new(seed);
    let (mut tried, mut solved, mut failed, mut most_iterations, mut longest_ms) = (0, 0, 0, 0.0f64, 0.0f64);
    while solved + failed < wanted {
        tried += 1;
        let (spec, torque, stagger, settings) = design(&mut random);
        let Ok((pair, _)) = Pair::new(&spec) else { continue };
        let begin = Instant::now();
        let result = compliance(&pair, &settings, elements).and_then(|compliance| {
            solve_pair_of_halves(&pair, torque, stagger, &compliance, &settings, Watch::none())
                .map_err(|e| e.to_string())
        });
        let time_ms = begin.elapsed().as_secs_f64() * 1e3;
        longest_ms = longest_ms.max(time_ms);
        let wrong = match result {
            Err(error) => Some(error),
            Ok(both) => both.halves.iter().find_map(|half| {
                let iterations = half.iterations as f64 / half.positions as f64;
                most_iterations = most_iterations.max(iterations);
                let finite = half
                    .stiffness_n_per_m
                    .iter()
                    .chain(&half.transmission_error_m)
                    .chain(&half.load_share)
                    .all(|v| v.is_finite());
                let positive = half.stiffness_n_per_m.iter().all(|&k| k > 0.0);
                let shares = half.load_share.iter().all(|&s| (0.0..=1.0 + 1e-9).contains(&s));
                (!finite || !positive || !shares)
                    .then(|| format!("finite {finite}, positive {positive}, shares {shares}"))
            }),
        };
        let slow = !elements && time_ms > SLOW_MS;
        match wrong {
            None if !slow => solved += 1,
            other => {
                let error = other.unwrap_or_else(|| format!("slow: {time_ms:.0} ms"));
                failed += usize::from(!error.starts_with("slow"));
                solved += usize::from(error.starts_with("slow"));
                println!(
                    "{error}\n  z {}/{}, m_n {:.2} mm, helix {:.1} deg, b/m_n {:.1}, T {torque:.3e} N m, eps {:.2} + {:.2}, {:?}, corner {}",
                    spec.pinion.teeth,
                    spec.gear.teeth,
                    spec.normal_module_m * 1e3,
                    spec.helix_angle_rad.to_degrees(),
                    spec.face_width_m / spec.normal_module_m,
                    pair.transverse_contact_ratio,
                    pair.overlap_ratio,
                    settings.body,
                    settings.corner_contact
                );
            }
        }
    }
    println!(
        "{} designs tried, {solved} solved, {failed} failed; at most {most_iterations:.1} iterations per position; longest {longest_ms:.0} ms",
        tried
    );
    Ok(())
}
