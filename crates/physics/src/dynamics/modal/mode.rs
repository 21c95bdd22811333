//! Energy shares, damping and names of the natural modes.

use super::springs::{SpringGroup, spring_elements};
use super::{DisplacementVector, NaturalModes, arcs, masses, mirrored};
use crate::dynamics::parameters::Parameters;

/// A natural mode with its energy shares and name.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Hz; 0 for a rigid-body mode.
    pub frequency_hz: f64,
    /// Name by the rule of [`NaturalModes::describe`].
    pub name: String,
    /// Displacements in the order of [the module](crate::dynamics), rotations as arcs at the radii of the reference
    /// plane; the largest is 1.
    pub shape: [f64; 12],
    /// φᵀ M φ of that shape, kg.
    pub modal_mass_kg: f64,
    /// Damping ratio φᵀ C φ/(2 ω φᵀ M φ), without the coupling of modes by damping, which is valid for light damping.
    /// None for a rigid-body mode.
    pub damping_ratio: Option<f64>,
    /// Share of each group of springs in the strain energy; empty for a rigid-body mode.
    pub strain_energy: Vec<(SpringGroup, f64)>,
    /// Share of each kind of displacement in the kinetic energy, both halves together.
    pub kinetic_energy: [(&'static str, f64); 6],
}

const DISPLACEMENT_KINDS: [&str; 6] =
    ["pinion_lateral", "pinion_axial", "pinion_rotation", "gear_lateral", "gear_axial", "gear_rotation"];

/// Groups of springs by the name they give to a mode.
const SPRING_KINDS: [(&str, &[SpringGroup]); 7] = [
    ("mesh", &[SpringGroup::MeshLeft, SpringGroup::MeshRight]),
    ("pinion lateral", &[SpringGroup::PinionLateral, SpringGroup::PinionHalvesLateral]),
    ("gear lateral", &[SpringGroup::GearLateral, SpringGroup::GearHalvesLateral]),
    ("pinion axial", &[SpringGroup::PinionAxial, SpringGroup::PinionHalvesAxial]),
    ("gear axial", &[SpringGroup::GearAxial, SpringGroup::GearHalvesAxial]),
    ("pinion torsional", &[SpringGroup::PinionHalvesTorsional]),
    ("gear torsional", &[SpringGroup::GearHalvesTorsional]),
];

/// Share of the strain energy from which one kind of springs alone names a mode.
const DOMINANT_SHARE: f64 = 0.5;
/// Share of the kinetic energy below which a direction is not part of the name of a rigid-body mode.
const NEGLIGIBLE_SHARE: f64 = 1e-6;
/// φᵀ M φ' (φ' the mirror image) from which a mode counts as symmetric, and below whose negative as antisymmetric.
const MIRROR_CORRELATION: f64 = 0.99;

impl Mode {
    /// Share of both meshes in the strain energy.
    pub fn mesh_strain_energy(&self) -> f64 {
        self.strain_energy_of(SPRING_KINDS[0].1)
    }

    fn strain_energy_of(&self, groups: &[SpringGroup]) -> f64 {
        // The sum of an empty iterator would be −0.
        self.strain_energy.iter().filter(|(group, _)| groups.contains(group)).fold(0.0, |sum, (_, share)| sum + share)
    }
}

impl NaturalModes {
    /// The modes with their energy shares, damping and names. The name is that of the kind of springs with the largest
    /// share of the strain energy (meshes; lateral, axial or torsional springs of pinion or gear, supports and
    /// couplings together) if that is at least half, otherwise those of the two largest; "meshes in phase" if the mode
    /// is its own mirror image, "meshes opposed" if it is the opposite of it. Rigid-body modes are named by their
    /// kinetic energy: rotation, axial screw (rotation and axial), axial, lateral. Empty for a train, whose energies
    /// are not those of the twelve displacements.
    pub fn describe(&self, p: &Parameters) -> Vec<Mode> {
        if p.train.is_some() {
            return Vec::new();
        }
        self.frequencies_hz.iter().zip(&self.shapes).map(|(f, shape)| describe(p, *f, shape)).collect()
    }
}

fn describe(p: &Parameters, frequency_hz: f64, shape: &DisplacementVector) -> Mode {
    let masses = masses(p);
    let mut kinetic_energy = DISPLACEMENT_KINDS.map(|kind| (kind, 0.0));
    for c in 0..12 {
        // φᵀ M φ = 1.
        kinetic_energy[c % 6].1 += masses[c] * shape[c] * shape[c];
    }
    let mut strain: Vec<(SpringGroup, f64)> = Vec::new();
    let mut damping = 0.0;
    for element in spring_elements(p) {
        let deflection: f64 = (0..12).map(|c| element.row[c] * shape[c]).sum();
        damping += element.spring.damping * deflection * deflection;
        let energy = element.spring.stiffness * deflection * deflection;
        match strain.iter_mut().find(|(group, _)| *group == element.group) {
            Some((_, sum)) => *sum += energy,
            None => strain.push((element.group, energy)),
        }
    }
    let elastic = frequency_hz > 0.0;
    let all: f64 = strain.iter().map(|(_, energy)| energy).sum();
    let strain_energy =
        if elastic { strain.into_iter().map(|(group, energy)| (group, energy / all)).collect() } else { Vec::new() };
    let arcs = arcs(p, shape);
    let largest = arcs.iter().fold(0.0f64, |m, a| m.max(a.abs()));
    let mut mode = Mode {
        frequency_hz,
        name: String::new(),
        shape: arcs.map(|a| a / largest),
        modal_mass_kg: 1.0 / (largest * largest),
        damping_ratio: elastic.then(|| damping / (2.0 * std::f64::consts::TAU * frequency_hz)),
        strain_energy,
        kinetic_energy,
    };
    mode.name = if elastic { elastic_mode_name(&mode) } else { rigid_body_mode_name(&mode) };
    let image: f64 = (0..12).map(|c| masses[c] * shape[c] * mirrored(c) * shape[(c + 6) % 12]).sum();
    if image >= MIRROR_CORRELATION {
        mode.name.push_str(if elastic { ", meshes in phase" } else { ", halves alike" });
    } else if image <= -MIRROR_CORRELATION {
        mode.name.push_str(if elastic { ", meshes opposed" } else { ", halves opposed" });
    }
    mode
}

fn elastic_mode_name(mode: &Mode) -> String {
    let mut shares = SPRING_KINDS.map(|(name, groups)| (name, mode.strain_energy_of(groups)));
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let [(first, share), (second, _), ..] = shares;
    if share >= DOMINANT_SHARE { format!("{first} mode") } else { format!("{first} and {second} mode") }
}

fn rigid_body_mode_name(mode: &Mode) -> String {
    let share = |part: &str| -> f64 {
        mode.kinetic_energy.iter().filter(|(kind, _)| kind.ends_with(part)).map(|(_, share)| share).sum()
    };
    let moves = |part: &str| share(part) > NEGLIGIBLE_SHARE;
    let name = match (moves("rotation"), moves("axial"), moves("lateral")) {
        (true, false, false) => "rotation",
        (true, true, false) => "axial screw",
        (false, true, false) => "axial",
        (false, false, _) => "lateral",
        _ => "mixed motion",
    };
    format!("{name} (free)")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::reference::parameters;
    use crate::dynamics::{DynamicModel, HalfParameters, IntegrationLimits, Shooting, Stiffness};
    use crate::watch::Watch;
    use herringbone_oracle::Tolerance::Relative;
    use herringbone_oracle::{check, check_worst};

    const TOPIC: &str = "Dynamics: natural modes";

    fn modes(p: &Parameters) -> Vec<Mode> {
        NaturalModes::new(p).unwrap().describe(p)
    }

    #[test]
    fn shares_add_up_and_names_follow() {
        let p = parameters("A");
        let modes = modes(&p);
        for mode in &modes {
            let strain: f64 = mode.strain_energy.iter().map(|(_, share)| share).sum();
            let kinetic: f64 = mode.kinetic_energy.iter().map(|(_, share)| share).sum();
            println!(
                "{:8.2} Hz {:32} ζ {:?} mesh {:.3}",
                mode.frequency_hz,
                mode.name,
                mode.damping_ratio,
                mode.mesh_strain_energy()
            );
            assert!((kinetic - 1.0).abs() < 1e-12 && (mode.frequency_hz == 0.0 || (strain - 1.0).abs() < 1e-12));
            assert!(mode.shape.iter().any(|c| (c - 1.0).abs() < 1e-6) && mode.shape.iter().all(|c| c.abs() <= 1.0));
            // The mesh shares of mirrored halves are equal.
            let share = |g| mode.strain_energy.iter().find(|(group, _)| *group == g).map_or(0.0, |(_, share)| *share);
            assert!((share(SpringGroup::MeshLeft) - share(SpringGroup::MeshRight)).abs() < 1e-6, "{mode:?}");
        }
        let names: Vec<&str> = modes.iter().map(|mode| mode.name.as_str()).collect();
        assert_eq!(
            names[..3],
            ["rotation (free), halves alike", "rotation (free), halves opposed", "axial screw (free), halves opposed"]
        );
        assert_eq!(names[11], "mesh mode, meshes in phase");
    }

    /// The Rayleigh quotient of every shape is its squared frequency, and the shapes are orthogonal over the masses.
    #[test]
    fn modes_of_equal_frequency_are_still_modes() {
        let p = parameters("A");
        let natural = NaturalModes::new(&p).unwrap();
        let masses = masses(&p);
        let mut errors = Vec::new();
        for (a, first) in natural.shapes.iter().enumerate() {
            for (b, second) in natural.shapes.iter().enumerate() {
                let product: f64 = (0..12).map(|c| masses[c] * first[c] * second[c]).sum();
                errors.push(product - f64::from(u8::from(a == b)));
                let strain: f64 = spring_elements(&p)
                    .iter()
                    .map(|m| {
                        let deflection = |shape: &DisplacementVector| (0..12).map(|c| m.row[c] * shape[c]).sum::<f64>();
                        m.spring.stiffness * deflection(first) * deflection(second)
                    })
                    .sum();
                let square = |f: f64| (std::f64::consts::TAU * f).powi(2);
                let expected = if a == b { square(natural.frequencies_hz[a]) } else { 0.0 };
                errors.push((strain - expected) / square(natural.frequencies_hz[11]));
            }
        }
        check_worst(TOPIC, "orthogonality over masses and springs, case A", errors, 1e-10);
    }

    /// The basis of a space does not depend on the mixture that the eigenvalue solver returns.
    #[test]
    fn a_space_has_one_basis() {
        let p = parameters("A");
        let natural = NaturalModes::new(&p).unwrap();
        let turned = |q: &Parameters| NaturalModes::new(q).unwrap().shapes;
        // Halves exchanged: another matrix for the solver, the same modes with their halves exchanged or mirrored.
        let mut q = p.clone();
        q.halves.swap(0, 1);
        for (shape, other) in natural.shapes.iter().zip(turned(&q)) {
            let scale = shape.iter().fold(0.0f64, |m, c| m.max(c.abs()));
            let errors = (0..12).map(|c| (shape[c] - other[c]) / scale);
            assert!(errors.into_iter().all(|e| e.abs() < 1e-9));
        }
    }

    /// One mesh between two rotations: the damping ratio of the mode is that of the mesh damper.
    #[test]
    fn the_damping_ratio_of_one_mesh_is_its_own() {
        let mut p = parameters("A");
        p.helix_angle_rad = 0.0;
        for h in &mut p.halves {
            (h.pinion_lateral.stiffness, h.gear_lateral.stiffness) = (1e17, 1e17);
        }
        let me = p.equivalent_mass_kg(0);
        let HalfParameters { mesh_stiffness, mesh_damping_n_s_per_m: c, .. } = &p.halves[0];
        let expected = c / (2.0 * (mesh_stiffness.mean_n_per_m() * me).sqrt());
        let mode = modes(&p).into_iter().find(|mode| mode.mesh_strain_energy() > 0.99).unwrap();
        check(
            TOPIC,
            "damping ratio of the mesh mode of a spur pair held fast",
            mode.damping_ratio.unwrap(),
            expected,
            Relative(1e-6),
        );
    }

    /// Lightly damped with constant stiffness: the Floquet multipliers of the linear motion are exp(−ζ ω T) of the
    /// modes.
    #[test]
    fn damping_ratios_are_those_of_the_motion() {
        let mut p = parameters("A");
        let scale = 0.01;
        for h in &mut p.halves {
            h.impact = None;
            h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
            h.mesh_damping_n_s_per_m *= scale;
            for s in [&mut h.pinion_lateral, &mut h.gear_lateral, &mut h.gear_axial] {
                s.damping *= scale;
            }
        }
        p.couplings.pinion_axial.damping *= scale;
        p.couplings.gear_axial.damping *= scale;
        let model = DynamicModel::<12>::new(&p).unwrap();
        let watch = Watch::none();
        let limits = IntegrationLimits { tolerance: 1e-13, max_steps: u64::MAX, watch: &watch };
        let shooting = Shooting::new(&model, [9e8; 2], limits).unwrap();
        let mut start = model.state_from(&[0.0; 24]);
        start.contact = [1; 2];
        let round = shooting.period_map(&model.with_fixed_contact(), start, 1).unwrap();
        let mut rates: Vec<f64> = shooting.multipliers(&round.monodromy).iter().map(|m| -m.norm().ln()).collect();
        let mut expected: Vec<f64> = modes(&p)
            .iter()
            .filter_map(|m| m.damping_ratio.map(|z| z * std::f64::consts::TAU * m.frequency_hz * p.mesh_period_s()))
            .flat_map(|rate| [rate, rate])
            .collect();
        rates.sort_by(f64::total_cmp);
        expected.sort_by(f64::total_cmp);
        assert_eq!(rates.len(), expected.len());
        let errors = rates.iter().zip(&expected).map(|(r, e)| r / e - 1.0);
        check_worst(TOPIC, "decay of every mode, light damping, against the Floquet multipliers", errors, 1e-3);
    }
}
