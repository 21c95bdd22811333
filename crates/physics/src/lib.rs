//! # herringbone-physics
//!
//! Contact ratios, loaded tooth contact, mesh-in impact and nonlinear vibration of double-helical gear pairs: pure
//! functions without I/O, clock, async or HTTP. Every quantity is in SI units (m, N, kg, s, rad, Pa) unless its name
//! says otherwise; a unit at the end of a name (`_m`, `_n_per_m`) states the unit of the value.
//!
//! | module | contents |
//! |---|---|
//! | [`gear`] | involute geometry (ISO 21771-1), feasibility, contact ratios, lines of contact, flank modifications |
//! | [`compliance`] | compliance of teeth, gear bodies and local contact, analytic or from finite elements |
//! | [`fe`] | finite elements of one gear |
//! | [`contact`] | load distribution, mesh stiffness, transmission error, load shares over the mesh period |
//! | [`iso6336`] | mesh stiffness by ISO 6336-1, method B; face load factor of the pinion by method C |
//! | [`impact`] | mesh-in impact: first contact, velocity, force |
//! | [`dynamics`] | equations of motion of both halves, integration, periodic solutions, natural modes |
//! | [`equations`] | parameters of the equations of motion from a pair and its loaded contact |
//! | [`response`] | steady vibration: RMS values, spectra, regime, series |
//! | [`shafts`] | shafts on bearings: static flexibility, natural modes and vibration of the geared rotor |
//! | [`numerics`] | quadrature, splines, interpolation, dense linear algebra |
//! | [`watch`] | progress and cancellation of long calculations |
//!
//! # Example: from a gear pair to the RMS acceleration of its mesh
//!
//! ```
//! use herringbone_physics::compliance::{Compliance, Settings};
//! use herringbone_physics::contact::solve_pair_of_halves;
//! use herringbone_physics::equations::{Mounting, OperatingPoint, base_plane_parameters};
//! use herringbone_physics::gear::{GearSpec, Pair, PairSpec};
//! use herringbone_physics::response::{self, Analysis};
//! use herringbone_physics::watch::Watch;
//!
//! // Module 6 mm, normal pressure angle 20°, helix angle 24.43°, face width 75 mm per half, 17 and 44 teeth.
//! let angles_rad = [20f64.to_radians(), 24.43f64.to_radians()];
//! let spec = PairSpec::plain(6e-3, angles_rad, 75e-3, [17, 44].map(GearSpec::plain));
//! let (pair, _warnings) = Pair::new(&spec).expect("a feasible pair");
//! // 800 N m at 2000 r/min.
//! let operation = OperatingPoint { pinion_speed_rad_s: 209.44, pinion_torque_nm: 800.0 };
//! let settings = Settings::default();
//! let compliance = Compliance::analytic(&pair, &settings, Watch::none()).expect("not canceled");
//! let contact = solve_pair_of_halves(&pair, 800.0, 0.0, &compliance, &settings, Watch::none())?;
//! let mounting = Mounting {
//!     lateral_n_per_m: [600e6; 2],
//!     gear_axial_n_per_m: 200e6,
//!     halves_axial_n_per_m: [300e6; 2],
//!     damping_ratio: 0.03,
//!     mesh_damping_ratio: 0.1,
//!     half_backlash_m: 1e-6,
//! };
//! let parameters = base_plane_parameters(&pair, &contact, &operation, &mounting);
//! let response = response::solve(&parameters, &Analysis::default(), &Watch::none())?;
//! let rms = response.summary.rms.mesh_circumferential_acceleration_m_s2;
//! assert!(rms.left > 0.1 && rms.left < 1000.0 && rms.left == rms.right, "{rms:?} m/s²");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![warn(missing_docs)]

pub mod compliance;
pub mod contact;
pub mod dynamics;
pub mod equations;
pub mod fe;
pub mod gear;
pub mod impact;
pub mod iso6336;
pub mod numerics;
pub mod recent;
pub mod response;
pub mod shafts;
pub(crate) mod simd;
pub mod watch;
