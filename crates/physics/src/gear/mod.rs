//! Involute helical gear geometry per ISO 21771: the pair, its tooth form, its lines of contact, flank
//! modifications and assembly errors as initial gaps, and what makes a design infeasible.
//!
//! Everything here is SI (m, rad, kg) and describes **one helix half** unless a name says otherwise.
//!
//! # Coordinates (used by `contact` and `impact` too)
//! - `x_m`: roll coordinate on the transverse line of action, from the pinion's base tangent point T1. The pinion's
//!   roll length is `x`, the gear's is `T1T2 - x`; `x` grows with time; the pinion turns by `x / r_b1`.
//! - `y_m`: axial station within the half, 0 at the inner end (the side of the gap), `face_width_m` at the outer end.
//! - `entry_m`: axial distance from the end where teeth leave the mesh: the mesh-in end is at `entry = b`. With
//!   rotation `ApexLeading` teeth enter at the inner end (`entry = b - y`), with `ApexTrailing` at the outer (`entry =
//!   y`).
//! - Tooth pair `k` touches along `x = x0 + k p_bt + entry tan(beta_b)`: pair `k + 1` entered before pair `k`.

mod body;
mod coast;
mod corner;
mod feasibility;
mod findings;
mod involute;
mod lines;
mod margins;
mod member;
mod modification;
mod outline;
mod pair;
mod spec;
mod tooth;
mod values;

pub use body::BodyStiffness;
pub use corner::CornerContact;
pub use findings::{
    AssemblyField, CenterDistanceFit, Consequence, GearField, Infeasibility, InfeasibilityReason, MaterialField,
    MemberId, SpecField, Warning, WarningReason,
};
pub use lines::ContactLine;
pub use margins::{Margin, MarginKind};
pub use member::Member;
pub use pair::Pair;
pub use spec::{
    Assembly, EndRelief, FlankModification, GearSpec, Half, Material, PairSpec, ReliefShape, Rotation, TipRelief,
};

#[cfg(test)]
pub(crate) mod fixtures;
#[cfg(test)]
mod tests;
