//! Trains for tests and benches: the twelve degrees of freedom of a pair in their modes, alone or with further modes.
//! The module that includes this file has the names of `dynamics` in scope.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::{LinearOutput, ModalTrain, Parameters, Spring};

/// Mass matrix (diagonal), stiffness and damping matrix without the meshes, rows of s and torques of the twelve
/// degrees of freedom.
pub(crate) struct TwelveDegrees {
    pub masses: [f64; 12],
    pub stiffness: DMatrix<f64>,
    pub damping: DMatrix<f64>,
    pub mesh: [DVector<f64>; 2],
    pub torques: DVector<f64>,
}

impl TwelveDegrees {
    pub(crate) fn new(p: &Parameters) -> Self {
        let masses = std::array::from_fn(|i| {
            let h = &p.halves[i / 6];
            [
                h.pinion_mass_kg,
                h.pinion_mass_kg,
                h.pinion_inertia_kg_m2,
                h.gear_mass_kg,
                h.gear_mass_kg,
                h.gear_inertia_kg_m2,
            ][i % 6]
        });
        let (mut stiffness, mut damping) = (DMatrix::zeros(12, 12), DMatrix::zeros(12, 12));
        let mut add = |spring: Spring, row: &[(usize, f64)]| {
            let mut v = DVector::zeros(12);
            row.iter().for_each(|(i, value)| v[*i] = *value);
            stiffness += &v * v.transpose() * spring.stiffness;
            damping += &v * v.transpose() * spring.damping;
        };
        for (j, h) in p.halves.iter().enumerate() {
            let i = 6 * j;
            add(h.pinion_lateral, &[(i, 1.0)]);
            add(h.pinion_axial, &[(i + 1, 1.0)]);
            add(h.gear_lateral, &[(i + 3, 1.0)]);
            add(h.gear_axial, &[(i + 4, 1.0)]);
        }
        let c = &p.couplings;
        for (spring, i) in [
            (c.pinion_lateral, 0),
            (c.pinion_axial, 1),
            (c.pinion_torsion, 2),
            (c.gear_lateral, 3),
            (c.gear_axial, 4),
            (c.gear_torsion, 5),
        ] {
            // Axial displacements of the halves have the same direction.
            add(spring, &[(i, 1.0), (i + 6, -1.0)]);
        }
        let (sin, cos) = p.helix_angle_rad.sin_cos();
        let mesh = [sin, -sin].map(|_| DVector::zeros(12));
        let mut degrees = Self { masses, stiffness, damping, mesh, torques: DVector::zeros(12) };
        for (j, sin) in [sin, -sin].into_iter().enumerate() {
            let i = 6 * j;
            let row = [cos, sin, cos * p.pinion_radius_m, -cos, -sin, -cos * p.gear_radius_m];
            for (k, value) in row.into_iter().enumerate() {
                degrees.mesh[j][i + k] = value;
            }
            degrees.torques[i + 2] = p.halves[j].pinion_torque_nm;
            degrees.torques[i + 5] = -p.halves[j].pinion_torque_nm * p.gear_radius_m / p.pinion_radius_m;
        }
        degrees
    }
}

/// The pair as a train: its twelve degrees of freedom and `further` modes that the meshes excite, closed with the mean
/// mesh stiffnesses. `gyroscopic`: size of the gyroscopic terms relative to the frequencies.
pub(crate) fn train_of(p: &Parameters, further: usize, gyroscopic: f64) -> ModalTrain {
    let twelve = TwelveDegrees::new(p);
    let n = 12 + further;
    let roots: Vec<f64> = (0..n).map(|i| if i < 12 { 1.0 / twelve.masses[i].sqrt() } else { 1.0 }).collect();
    // Golden-ratio fractions: spread evenly over −1 … 1, never repeating.
    let spread = |i: usize, j: usize| 2.0 * ((i * 31 + j * 7 + 1) as f64 * 0.618_033_988_749_895).fract() - 1.0;
    let omega = |i: usize| std::f64::consts::TAU * 300.0 * 50f64.powf((i - 12) as f64 / further as f64);
    let scaled = |matrix: &DMatrix<f64>, r: usize, c: usize| {
        if r < 12 && c < 12 { matrix[(r, c)] * roots[r] * roots[c] } else { 0.0 }
    };
    let mut stiffness = DMatrix::from_fn(n, n, |r, c| {
        scaled(&twelve.stiffness, r, c) + if r == c && r >= 12 { omega(r).powi(2) } else { 0.0 }
    });
    let mesh = [0, 1]
        .map(|j| DVector::from_fn(n, |i, _| if i < 12 { twelve.mesh[j][i] * roots[i] } else { 0.12 * spread(i, j) }));
    let k_ref = [0, 1].map(|j| p.halves[j].mesh_stiffness.mean_n_per_m());
    for j in 0..2 {
        stiffness += &mesh[j] * mesh[j].transpose() * k_ref[j];
    }
    let damping = DMatrix::from_fn(n, n, |r, c| {
        let own = if r == c && r >= 12 { 2.0 * 0.02 * omega(r) } else { 0.0 };
        let turning = if r < c && c >= 12 && r >= 12 {
            gyroscopic * spread(r, c) * (omega(r) * omega(c)).sqrt()
        } else if r > c && c >= 12 {
            -gyroscopic * spread(c, r) * (omega(r) * omega(c)).sqrt()
        } else {
            0.0
        };
        scaled(&twelve.damping, r, c) + own + turning
    });
    let eigen = SymmetricEigen::new(stiffness);
    let shapes = &eigen.eigenvectors;
    let largest = eigen.eigenvalues.amax();
    let reduced = |row: &DVector<f64>| (shapes.transpose() * row).iter().copied().collect::<Vec<f64>>();
    let unit = |i: usize, value: f64| DVector::from_fn(n, |c, _| if c == i { value } else { 0.0 });
    // Reactions of the supports of the pinion, and of some further modes.
    let outputs = (0..12)
        .map(|k| {
            let spring = p.halves[k % 2].pinion_lateral;
            let at = if k < 2 { 6 * k } else { 12 + (k - 2) % further.max(1) };
            let row = |value: f64| if at < n { unit(at, -value * roots[at]) } else { unit(0, 0.0) };
            LinearOutput {
                name: format!("bearing_{}_y", k + 1),
                unit: "N".into(),
                displacement: reduced(&row(spring.stiffness)),
                velocity: reduced(&row(spring.damping)),
            }
        })
        .collect();
    let damping = shapes.transpose() * damping * shapes;
    ModalTrain {
        eigenvalues_rad2_s2: eigen.eigenvalues.iter().map(|l| if *l < 1e-12 * largest { 0.0 } else { *l }).collect(),
        damping_per_s: (0..n * n).map(|at| damping[(at / n, at % n)]).collect(),
        cross_stiffness_per_s2: None,
        mesh: mesh.each_ref().map(&reduced),
        reference_stiffness_n_per_m: k_ref,
        load_n: reduced(&DVector::from_fn(n, |i, _| if i < 12 { twelve.torques[i] * roots[i] } else { 0.0 })),
        displacements: std::array::from_fn(|i| reduced(&unit(i, roots[i]))),
        outputs,
    }
}
