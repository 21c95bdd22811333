//! Errors of shafts and of the geared rotor.

use crate::watch::Canceled;
use std::fmt;

/// The part of a shaft that an error is about. Indices count from 0 in the order of the shaft's lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShaftItem {
    /// A segment.
    Segment(usize),
    /// A bearing.
    Bearing(usize),
    /// The coupling.
    Coupling,
    /// The machine behind the coupling.
    Machine,
    /// The rigid body at mid-face of each half.
    HalfBody,
    /// A further rigid body.
    Body(usize),
    /// The apex plane of the gear halves.
    Gear,
    /// The material.
    Material,
    /// A section of which a displacement is asked, or on which a load acts.
    Section(usize),
    /// A mesh spring.
    Mesh(usize),
}

impl fmt::Display for ShaftItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ShaftItem::Segment(i) => write!(f, "segment {}", i + 1),
            ShaftItem::Bearing(i) => write!(f, "bearing {}", i + 1),
            ShaftItem::Coupling => f.write_str("the coupling"),
            ShaftItem::Machine => f.write_str("the machine"),
            ShaftItem::HalfBody => f.write_str("the body of a half"),
            ShaftItem::Body(i) => write!(f, "body {}", i + 1),
            ShaftItem::Gear => f.write_str("the gear"),
            ShaftItem::Material => f.write_str("the material"),
            ShaftItem::Section(i) => write!(f, "section {}", i + 1),
            ShaftItem::Mesh(i) => write!(f, "mesh spring {}", i + 1),
        }
    }
}

/// Rigid-body motion that the bearings of a shaft leave free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SupportDefect {
    /// Translation along x, the line of centres.
    TranslationX,
    /// Translation along y, perpendicular to the line of centres.
    TranslationY,
    /// Rotation about x: tilting in the plane y–z.
    TiltingAboutX,
    /// Rotation about y: tilting in the plane x–z.
    TiltingAboutY,
}

impl fmt::Display for SupportDefect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            SupportDefect::TranslationX => "no bearing holds the shaft along x",
            SupportDefect::TranslationY => "no bearing holds the shaft along y",
            SupportDefect::TiltingAboutX => {
                "the shaft can tilt about x: a second bearing that is stiff along y, or a tilting stiffness, is needed"
            }
            SupportDefect::TiltingAboutY => {
                "the shaft can tilt about y: a second bearing that is stiff along x, or a tilting stiffness, is needed"
            }
        })
    }
}

/// Errors of a shaft or of the geared rotor.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ShaftError {
    /// The calculation was canceled.
    #[error(transparent)]
    Canceled(#[from] Canceled),
    /// The shaft has no segments.
    #[error("the shaft has no segments")]
    NoSegments,
    /// The shaft has no bearings.
    #[error("the shaft has no bearings")]
    NoBearing,
    /// A number out of its range.
    #[error("{item}: {quantity} is {value}, but {reason}")]
    InvalidValue {
        /// What the number belongs to.
        item: ShaftItem,
        /// Name of the number, with its unit.
        quantity: &'static str,
        /// The number.
        value: f64,
        /// What it has to be.
        reason: &'static str,
    },
    /// A position that is not on the shaft.
    #[error("{item} is at {position_m} m from the left end of a shaft of {length_m} m")]
    OutsideShaft {
        /// What is at the position.
        item: ShaftItem,
        /// Position from the left end, m.
        position_m: f64,
        /// Length of the shaft, m.
        length_m: f64,
    },
    /// The bearings leave the shaft free in another direction than its axis.
    #[error("singular support: {defect}")]
    SingularSupport {
        /// The motion that is free.
        defect: SupportDefect,
    },
    /// Neither shaft of the pair is held axially.
    #[error("both shafts are free axially: a bearing or a coupling of one of them has to be stiff along z")]
    BothFloatAxially,
    /// A frequency range that is not positive and finite.
    #[error("{quantity} is {value}, but it must be a positive finite number")]
    InvalidRange {
        /// Name of the number, with its unit.
        quantity: &'static str,
        /// The number.
        value: f64,
    },
    /// The symmetric part of the bearings' stiffness is negative in some motion: the train at rest is unstable.
    #[error(
        "the bearings' stiffness is negative for some motion of the shafts (eigenvalue {eigenvalue_rad2_s2:e} rad²/s²)"
    )]
    NegativeStiffness {
        /// Upper limit of the eigenvalue ω² of that motion, rad²/s².
        eigenvalue_rad2_s2: f64,
    },
    /// The train cannot be solved in double precision, its stiffnesses or masses being too far apart.
    #[error("the equations of the shafts cannot be solved in double precision: {reason}")]
    IllConditioned {
        /// What failed.
        reason: &'static str,
    },
    /// The natural modes did not converge.
    #[error("{converged} of {wanted} natural modes converged")]
    ModesNotConverged {
        /// Number of converged modes.
        converged: usize,
        /// Number of modes below the frequency limit.
        wanted: usize,
    },
    /// More unknowns than are accepted.
    #[error("the shafts need {elements} elements; at most {limit} are accepted")]
    TooLarge {
        /// Number of elements.
        elements: usize,
        /// The limit.
        limit: usize,
    },
}
