//! Static flexibility of a shaft on its bearings, by the force method: the beam's own flexibility from integrals over
//! its length, and the forces of the supports from a small system of equations. Exact for the Timoshenko beam, without
//! elements.

use nalgebra::{DMatrix, DVector, LU, Matrix4};

use super::beam::BeamSection;
use super::error::{ShaftError, ShaftItem, SupportDefect};
use super::shaft::Shaft;

/// Rigid-body stiffness over the largest one below which a support counts as singular.
const SINGULAR: f64 = 1e-12;

/// Force (N) and moment (N m) on a section of a shaft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionLoad {
    /// z of the section, m, from the apex plane.
    pub z_m: f64,
    /// F_x, F_y, F_z, M_x, M_y, M_z.
    pub load: [f64; 6],
}

/// A shaft under static loads.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticDeflection {
    /// Displacements (m, rad) of the sections that were asked for.
    pub displacements: Vec<[f64; 6]>,
    /// Force (N) and moment (N m) of every bearing on the shaft.
    pub bearings: Vec<[f64; 6]>,
    /// Axial force of the coupling on the shaft, N: of its spring, or what holds a floating shaft.
    pub coupling_axial_n: f64,
    /// Torque of the coupling on the shaft about z, N m.
    pub coupling_torque_nm: f64,
}

impl Shaft {
    /// Displacements u_x, u_y, u_z, φ_x, φ_y, φ_z (m, rad) of the sections `outputs_m` per force and moment (N, N m) at
    /// the sections `loads_m`, both in z from the apex plane: 6·outputs rows, 6·loads columns. φ_z = 0 at the coupling;
    /// a shaft that floats axially has u_z = 0 there too. Symmetric if the bearings are.
    ///
    /// # Errors
    /// As [`Shaft::validate`]; [`ShaftError::OutsideShaft`] for a section, [`ShaftError::SingularSupport`],
    /// [`ShaftError::IllConditioned`].
    pub fn flexibility(&self, outputs_m: &[f64], loads_m: &[f64]) -> Result<DMatrix<f64>, ShaftError> {
        let supported = SupportedShaft::new(self)?;
        let outputs = supported.sections(self, outputs_m.iter().copied())?;
        let loads = supported.sections(self, loads_m.iter().copied())?;
        let solution = supported.unit_loads(&loads);
        let mut flexibility = DMatrix::zeros(6 * outputs.len(), 6 * loads.len());
        for (i, output) in outputs.iter().enumerate() {
            for (j, load) in loads.iter().enumerate() {
                let own = supported.beam.influence(output, load);
                let mut block = flexibility.fixed_view_mut::<6, 6>(6 * i, 6 * j);
                own.add_to(|row, column, value| block[(row, column)] += value);
            }
        }
        flexibility += supported.of_supports(&outputs) * solution;
        if flexibility.iter().all(|value| value.is_finite()) {
            Ok(flexibility)
        } else {
            Err(ShaftError::IllConditioned { reason: "the flexibility is not finite" })
        }
    }

    /// Displacements of the sections `outputs_m` (z from the apex plane) and all reactions under loads.
    ///
    /// # Errors
    /// As [`Shaft::flexibility`].
    pub fn deflection(&self, loads: &[SectionLoad], outputs_m: &[f64]) -> Result<StaticDeflection, ShaftError> {
        let supported = SupportedShaft::new(self)?;
        let outputs = supported.sections(self, outputs_m.iter().copied())?;
        let sections = supported.sections(self, loads.iter().map(|load| load.z_m))?;
        let forces = DVector::from_iterator(6 * loads.len(), loads.iter().flat_map(|load| load.load));
        let solution = supported.unit_loads(&sections) * &forces;
        let mut displacements = supported.of_supports(&outputs) * &solution;
        for (i, output) in outputs.iter().enumerate() {
            for (j, load) in sections.iter().enumerate() {
                supported.beam.influence(output, load).add_to(|row, column, value| {
                    displacements[6 * i + row] += value * forces[6 * j + column];
                });
            }
        }
        if !displacements.iter().chain(&solution).all(|value| value.is_finite()) {
            return Err(ShaftError::IllConditioned { reason: "the deflections are not finite" });
        }
        let mut bearings = vec![[0.0; 6]; self.bearings.len()];
        let (mut coupling_axial_n, mut coupling_torque_nm) = (0.0, 0.0);
        for (spring, &force) in supported.springs.iter().zip(&solution) {
            match (spring.of, spring.direction) {
                (Some(bearing), direction) => bearings[bearing][direction] += force,
                (None, 2) => coupling_axial_n += force,
                (None, _) => coupling_torque_nm += force,
            }
        }
        let displacements = displacements.as_slice().chunks_exact(6).map(|u| std::array::from_fn(|i| u[i])).collect();
        Ok(StaticDeflection { displacements, bearings, coupling_axial_n, coupling_torque_nm })
    }
}

/// A section with the integrals over the beam up to it.
#[derive(Debug, Clone, Copy)]
struct Station {
    /// Coordinate from the clamped section, m.
    t: f64,
    integrals: Integrals,
}

/// Integrals of the beam's flexibilities from the clamped section to a station, positive on both of its sides (the
/// first moment has the sign of the station).
#[derive(Debug, Clone, Copy, Default)]
struct Integrals {
    /// ∫ ds/(EA), m/N.
    tension: f64,
    /// ∫ ds/(GJ), rad/(N m).
    torsion: f64,
    /// ∫ ds/(κGA), m/N.
    shear: f64,
    /// ∫ sⁿ ds/(EI), n = 0, 1, 2.
    bending: [f64; 3],
}

impl Integrals {
    /// Adds a piece of the beam between two coordinates on the same side of the clamped section.
    fn add(&mut self, section: &BeamSection, from: f64, to: f64) {
        let length = (to - from).abs();
        self.tension += length / section.axial_n;
        self.torsion += length / section.torsion_n_m2;
        self.shear += length / section.shear_n;
        let per_length = length / section.bending_n_m2;
        self.bending[0] += per_length;
        self.bending[1] += per_length * 0.5 * (from + to);
        self.bending[2] += per_length * (from * from + from * to + to * to) / 3.0;
    }
}

/// The beam, imagined as clamped at one section.
#[derive(Debug)]
struct ClampedBeam {
    /// Position of the clamped section from the left end, m.
    clamped_m: f64,
    /// Ends of the segments in coordinates from the clamped section, and the sections between them.
    pieces: Vec<(f64, f64, BeamSection)>,
}

/// Displacements of one section of the clamped beam per load on another.
#[derive(Debug, Clone, Copy)]
struct Influence {
    tension: f64,
    torsion: f64,
    /// Deflection per force, deflection per moment, slope per force, slope per moment.
    bending: [f64; 4],
}

impl Influence {
    /// Calls `add(row, column, value)` for the entries of the 6×6 block that are not zero.
    fn add_to(&self, mut add: impl FnMut(usize, usize, f64)) {
        let [deflection, of_moment, slope, slope_of_moment] = self.bending;
        add(2, 2, self.tension);
        add(5, 5, self.torsion);
        // Plane x–z: u_x, φ_y.
        add(0, 0, deflection);
        add(0, 4, of_moment);
        add(4, 0, slope);
        add(4, 4, slope_of_moment);
        // Plane y–z: u_y, −φ_x.
        add(1, 1, deflection);
        add(1, 3, -of_moment);
        add(3, 1, -slope);
        add(3, 3, slope_of_moment);
    }
}

impl ClampedBeam {
    fn new(shaft: &Shaft, clamped_m: f64) -> ClampedBeam {
        let mut pieces = Vec::with_capacity(shaft.segments.len() + 1);
        let mut from = -clamped_m;
        for segment in &shaft.segments {
            let section = BeamSection::new(segment, &shaft.material);
            let to = from + segment.length_m;
            if from < 0.0 && to > 0.0 {
                pieces.push((from, 0.0, section));
                pieces.push((0.0, to, section));
            } else {
                pieces.push((from, to, section));
            }
            from = to;
        }
        ClampedBeam { clamped_m, pieces }
    }

    fn station(&self, position_m: f64) -> Station {
        let t = position_m - self.clamped_m;
        let mut integrals = Integrals::default();
        for (from, to, section) in &self.pieces {
            if t > 0.0 && *to > 0.0 && *from < t {
                integrals.add(section, *from, to.min(t));
            } else if t < 0.0 && *from < 0.0 && *to > t {
                integrals.add(section, from.max(t), *to);
            }
        }
        Station { t, integrals }
    }

    /// By virtual work: a force at l bends the section s between it and the clamped one with the moment l − s, a moment
    /// with 1; the two loads' products are integrated up to the nearer station.
    fn influence(&self, output: &Station, load: &Station) -> Influence {
        if output.t * load.t <= 0.0 {
            return Influence { tension: 0.0, torsion: 0.0, bending: [0.0; 4] };
        }
        let nearer = if output.t.abs() < load.t.abs() { output } else { load };
        let Integrals { tension, torsion, shear, bending: [zeroth, first, second] } = nearer.integrals;
        let (o, l) = (output.t, load.t);
        Influence {
            tension,
            torsion,
            bending: [
                o * l * zeroth - (o + l) * first + second + shear,
                o * zeroth - first,
                l * zeroth - first,
                zeroth,
            ],
        }
    }
}

/// One unknown force of a support.
#[derive(Debug, Clone, Copy)]
struct SupportSpring {
    /// Bearing, or `None` for the coupling.
    of: Option<usize>,
    /// Index of the displacement that it resists.
    direction: usize,
    /// Station, an index into those of the supports.
    station: usize,
    /// Stiffness over the six displacements of the station, N/m or N m/rad; `None` for a rigid support.
    stiffness: Option<[f64; 6]>,
}

/// The beam with its supports solved for.
struct SupportedShaft {
    beam: ClampedBeam,
    stations: Vec<Station>,
    springs: Vec<SupportSpring>,
    /// Equations of support forces and of the six displacements of the clamped section, factored; rows scaled by
    /// `rows`, unknowns by `columns`.
    equations: LU<f64, nalgebra::Dyn, nalgebra::Dyn>,
    rows: Vec<f64>,
    columns: Vec<f64>,
}

/// Displacements (6 rows) of a section at `t` per displacement of the clamped section: one entry for each row on the
/// diagonal, and two levers.
fn rigid_body(row: usize, column: usize, t: f64) -> f64 {
    match (row, column) {
        (0, 4) => t,
        (1, 3) => -t,
        _ if row == column => 1.0,
        _ => 0.0,
    }
}

impl SupportedShaft {
    fn new(shaft: &Shaft) -> Result<SupportedShaft, ShaftError> {
        shaft.validate()?;
        shaft.check_support()?;
        let middle: f64 = shaft.bearings.iter().map(|bearing| bearing.position_m).sum::<f64>();
        let beam = ClampedBeam::new(shaft, (middle / shaft.bearings.len() as f64).clamp(0.0, shaft.length_m()));
        let mut stations = Vec::new();
        let mut springs = Vec::new();
        for (i, bearing) in shaft.bearings.iter().enumerate() {
            let station = stations.len();
            stations.push(beam.station(shaft.on_shaft(ShaftItem::Bearing(i), bearing.position_m)?));
            for (direction, row) in bearing.stiffness().into_iter().enumerate() {
                if row.iter().any(|&k| k != 0.0) {
                    springs.push(SupportSpring { of: Some(i), direction, station, stiffness: Some(row) });
                }
            }
        }
        let station = stations.len();
        stations.push(beam.station(shaft.on_shaft(ShaftItem::Coupling, shaft.coupling.position_m)?));
        springs.push(SupportSpring { of: None, direction: 5, station, stiffness: None });
        if shaft.floats_axially() {
            springs.push(SupportSpring { of: None, direction: 2, station, stiffness: None });
        } else if shaft.coupling.axial_n_per_m > 0.0 {
            let stiffness = [0.0, 0.0, shaft.coupling.axial_n_per_m, 0.0, 0.0, 0.0];
            springs.push(SupportSpring { of: None, direction: 2, station, stiffness: Some(stiffness) });
        }
        let (equations, rows, columns) = factored(&beam, &stations, &springs, shaft.length_m())?;
        Ok(SupportedShaft { beam, stations, springs, equations, rows, columns })
    }

    fn sections(&self, shaft: &Shaft, z_m: impl Iterator<Item = f64>) -> Result<Vec<Station>, ShaftError> {
        z_m.enumerate()
            .map(|(i, z)| Ok(self.beam.station(shaft.on_shaft(ShaftItem::Section(i), z + shaft.gear_position_m)?)))
            .collect()
    }

    /// Support forces and displacements of the clamped section (rows) per unit load on the stations (columns).
    fn unit_loads(&self, loads: &[Station]) -> DMatrix<f64> {
        let supports = self.springs.len();
        let mut sides = DMatrix::zeros(supports + 6, 6 * loads.len());
        let influences: Vec<Vec<Influence>> = self
            .stations
            .iter()
            .map(|station| loads.iter().map(|load| self.beam.influence(station, load)).collect())
            .collect();
        for (row, spring) in self.springs.iter().enumerate() {
            for (j, influence) in influences[spring.station].iter().enumerate() {
                influence.add_to(|displacement, column, value| {
                    sides[(row, 6 * j + column)] -= spring.weight(displacement) * value;
                });
            }
        }
        for (j, load) in loads.iter().enumerate() {
            for force in 0..6 {
                for motion in 0..6 {
                    sides[(supports + motion, 6 * j + force)] -= rigid_body(force, motion, load.t);
                }
            }
        }
        for (row, &scale) in self.rows.iter().enumerate() {
            sides.row_mut(row).scale_mut(scale);
        }
        // A pivot of zero was refused when the equations were factored.
        self.equations.solve_mut(&mut sides);
        for (row, &scale) in self.columns.iter().enumerate() {
            sides.row_mut(row).scale_mut(scale);
        }
        sides
    }

    /// Displacements of the outputs per support force and displacement of the clamped section.
    fn of_supports(&self, outputs: &[Station]) -> DMatrix<f64> {
        let supports = self.springs.len();
        let mut matrix = DMatrix::zeros(6 * outputs.len(), supports + 6);
        for (i, output) in outputs.iter().enumerate() {
            for (j, spring) in self.springs.iter().enumerate() {
                let influence = self.beam.influence(output, &self.stations[spring.station]);
                influence.add_to(|row, column, value| {
                    if column == spring.direction {
                        matrix[(6 * i + row, j)] += value;
                    }
                });
            }
            for row in 0..6 {
                for motion in 0..6 {
                    matrix[(6 * i + row, supports + motion)] = rigid_body(row, motion, output.t);
                }
            }
        }
        matrix
    }
}

impl SupportSpring {
    /// Factor of a displacement of the station in the equation of this support.
    fn weight(&self, displacement: usize) -> f64 {
        match self.stiffness {
            Some(row) => row[displacement],
            None => f64::from(u8::from(displacement == self.direction)),
        }
    }
}

/// Equations r + K u = 0 of springs, u = 0 of rigid supports, and equilibrium, scaled and factored.
#[allow(clippy::type_complexity)]
fn factored(
    beam: &ClampedBeam,
    stations: &[Station],
    springs: &[SupportSpring],
    length_m: f64,
) -> Result<(LU<f64, nalgebra::Dyn, nalgebra::Dyn>, Vec<f64>, Vec<f64>), ShaftError> {
    let n = springs.len() + 6;
    let supports = springs.len();
    let mut a = DMatrix::zeros(n, n);
    for (row, spring) in springs.iter().enumerate() {
        if spring.stiffness.is_some() {
            a[(row, row)] = 1.0;
        }
        for (column, other) in springs.iter().enumerate() {
            let influence = beam.influence(&stations[spring.station], &stations[other.station]);
            influence.add_to(|displacement, force, value| {
                if force == other.direction {
                    a[(row, column)] += spring.weight(displacement) * value;
                }
            });
        }
        let t = stations[spring.station].t;
        for motion in 0..6 {
            a[(row, supports + motion)] = (0..6).map(|u| spring.weight(u) * rigid_body(u, motion, t)).sum();
            a[(supports + motion, row)] = rigid_body(spring.direction, motion, t);
        }
    }
    // Moments over the length and rotations times the length are comparable with forces and displacements;
    // displacements are in units of 1 N over the largest stiffness.
    let stiffest =
        springs.iter().filter_map(|s| s.stiffness.map(|row| row[s.direction] / lever(s.direction, length_m)));
    let softest_m_per_n = 1.0 / stiffest.fold(f64::MIN_POSITIVE, f64::max).min(1e300);
    let mut columns: Vec<f64> = springs.iter().map(|s| lever(s.direction, length_m).sqrt()).collect();
    columns.extend((0..6).map(|motion| softest_m_per_n / lever(motion, length_m).sqrt()));
    for (column, &scale) in columns.iter().enumerate() {
        a.column_mut(column).scale_mut(scale);
    }
    let rows: Vec<f64> = (0..n).map(|row| 1.0 / a.row(row).amax()).collect();
    for (row, &scale) in rows.iter().enumerate() {
        a.row_mut(row).scale_mut(scale);
    }
    if !a.iter().all(|value| value.is_finite()) {
        return Err(ShaftError::IllConditioned { reason: "a stiffness is too large or too small" });
    }
    let equations = LU::new(a);
    let pivots = equations.u().diagonal();
    if pivots.iter().any(|pivot| pivot.abs() < 1e-14 || !pivot.is_finite()) {
        return Err(ShaftError::IllConditioned { reason: "the supports' stiffnesses are too far apart" });
    }
    Ok((equations, rows, columns))
}

/// Square of a length for rotations, 1 for translations.
fn lever(direction: usize, length_m: f64) -> f64 {
    if direction < 3 { 1.0 } else { length_m * length_m }
}

impl Shaft {
    /// Fails when the bearings leave a translation along x or y or a tilting free.
    ///
    /// # Errors
    /// [`ShaftError::SingularSupport`], [`ShaftError::IllConditioned`].
    pub fn check_support(&self) -> Result<(), ShaftError> {
        let length = self.length_m();
        let middle = self.bearings.iter().map(|b| b.position_m).sum::<f64>() / self.bearings.len().max(1) as f64;
        // Over u_x, u_y, length·φ_x, length·φ_y of the section in the middle of the bearings.
        let mut stiffness = Matrix4::<f64>::zeros();
        for bearing in &self.bearings {
            let t = (bearing.position_m - middle) / length;
            let motions = [[1.0, 0.0], [0.0, 1.0], [0.0, -t], [t, 0.0]];
            for (i, row) in motions.iter().enumerate() {
                for (j, column) in motions.iter().enumerate() {
                    let k = &bearing.radial_n_per_m;
                    let radial = (0..2).map(|a| row[a] * (k[a][0] * column[0] + k[a][1] * column[1])).sum::<f64>();
                    stiffness[(i, j)] += radial;
                }
            }
            for i in 2..4 {
                stiffness[(i, i)] += bearing.tilting_nm_per_rad / (length * length);
            }
        }
        let scaled = stiffness / stiffness.amax().max(f64::MIN_POSITIVE);
        if !scaled.iter().all(|value| value.is_finite()) {
            return Err(ShaftError::IllConditioned { reason: "a stiffness is too large" });
        }
        let svd = scaled.svd(false, true);
        let largest = svd.singular_values.max();
        if svd.singular_values.min() > SINGULAR * largest {
            return Ok(());
        }
        let motion = svd.v_t.map(|v_t| v_t.row(svd.singular_values.imin()).transpose().iamax());
        let defect = match motion {
            Some(1) => SupportDefect::TranslationY,
            Some(2) => SupportDefect::TiltingAboutX,
            Some(3) => SupportDefect::TiltingAboutY,
            _ => SupportDefect::TranslationX,
        };
        Err(ShaftError::SingularSupport { defect })
    }
}
