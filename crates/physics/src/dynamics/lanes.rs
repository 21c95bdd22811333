//! Numbers of several motions side by side, for vector instructions.
//!
//! The inner loops are written once, over [`Real`]: `f64` for one motion, [`Lanes`] for several. Every operation on
//! lanes is the scalar operation in each lane, in the same order (no fused multiply-add, no sums across lanes), so that
//! results are bit-identical in any lane and with any vector instructions.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A number, or one number per lane.
pub(crate) trait Real:
    Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// Number of lanes.
    const LANES: usize;

    /// Sets each lane from its index.
    fn from_fn(number: impl FnMut(usize) -> f64) -> Self;

    fn get(self, lane: usize) -> f64;

    fn set(&mut self, lane: usize, number: f64);

    #[inline(always)]
    fn splat(number: f64) -> Self {
        Self::from_fn(|_| number)
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self::from_fn(|lane| f(self.get(lane)))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self::from_fn(|lane| f(self.get(lane), other.get(lane)))
    }

    /// Whether `test` holds in any lane. Evaluates all lanes, without branches.
    #[inline(always)]
    fn any(self, test: impl Fn(f64) -> bool) -> bool {
        let mut found = false;
        for lane in 0..Self::LANES {
            found |= test(self.get(lane));
        }
        found
    }
}

impl Real for f64 {
    const LANES: usize = 1;

    #[inline(always)]
    fn from_fn(mut number: impl FnMut(usize) -> f64) -> Self {
        number(0)
    }

    #[inline(always)]
    fn get(self, _: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn set(&mut self, _: usize, number: f64) {
        *self = number;
    }
}

/// One number per lane.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(transparent)]
pub(crate) struct Lanes<const L: usize>([f64; L]);

impl<const L: usize> Default for Lanes<L> {
    fn default() -> Self {
        Self([0.0; L])
    }
}

impl<const L: usize> Real for Lanes<L> {
    const LANES: usize = L;

    // Plain loops, here and below: the closures of the array functions of `std` are not always inlined.
    #[inline(always)]
    fn from_fn(mut number: impl FnMut(usize) -> f64) -> Self {
        let mut out = [0.0; L];
        for (lane, out) in out.iter_mut().enumerate() {
            *out = number(lane);
        }
        Self(out)
    }

    #[inline(always)]
    fn get(self, lane: usize) -> f64 {
        self.0[lane]
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, number: f64) {
        self.0[lane] = number;
    }
}

macro_rules! lane_by_lane {
    ($($operation:ident :: $function:ident $symbol:tt),*) => {$(
        impl<const L: usize> $operation for Lanes<L> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                let mut out = [0.0; L];
                for lane in 0..L {
                    out[lane] = self.0[lane] $symbol other.0[lane];
                }
                Self(out)
            }
        }
    )*};
}
lane_by_lane!(Add::add +, Sub::sub -, Mul::mul *, Div::div /);

impl<const L: usize> Neg for Lanes<L> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let mut out = [0.0; L];
        for lane in 0..L {
            out[lane] = -self.0[lane];
        }
        Self(out)
    }
}

impl<const L: usize> AddAssign for Lanes<L> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const L: usize> SubAssign for Lanes<L> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// x^(1/k) with a relative error of about 1e-4, without branches, for step lengths. Valid from 1e-300 to 1e300; 0 gives
/// a very small number, infinity a very large one, NaN is not handled.
#[inline(always)]
pub(super) fn approximate_root(x: f64, k: f64) -> f64 {
    approximate_exp2(approximate_log2(x) / k)
}

/// 2^52: adding it to a small integer puts the integer into the last bits of the sum.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// Exponent bits, plus the logarithm of the mantissa m by the series ln m = 2 artanh((m − 1)/(m + 1)).
#[inline(always)]
fn approximate_log2(x: f64) -> f64 {
    let bits = x.to_bits();
    let exponent = f64::from_bits((bits >> 52) & 0x7ff | WHOLE.to_bits()) - WHOLE - 1023.0;
    let mantissa = f64::from_bits(bits & 0x000f_ffff_ffff_ffff | 1.0f64.to_bits());
    let z = (mantissa - 1.0) / (mantissa + 1.0);
    let square = z * z;
    let artanh = z * (1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0))));
    exponent + 2.0 * std::f64::consts::LOG2_E * artanh
}

/// Power series of e^t for |t| ≤ ln 2 / 2, with the integer part put into the exponent bits.
#[inline(always)]
fn approximate_exp2(x: f64) -> f64 {
    let x = x.clamp(-1000.0, 1000.0);
    // Adding 1.5 · 2^52 rounds to integers of either sign.
    let shifted = x + 1.5 * WHOLE;
    let t = (x - (shifted - 1.5 * WHOLE)) * std::f64::consts::LN_2;
    let series = 1.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0 + t * (1.0 / 24.0 + t * (1.0 / 120.0)))));
    series * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_good_enough_for_steps() {
        for x in [1e-290, 3e-17, 0.7, 1.0, 1.5, 2.0, 1e9, 7e288] {
            for k in [4.0, 13.0, 24.0] {
                let ratio = approximate_root(x, k) / f64::powf(x, 1.0 / k);
                assert!((ratio - 1.0).abs() < 1e-4, "{x} {k} {ratio}");
            }
        }
        assert!(approximate_root(0.0, 10.0) < 1e-30 && approximate_root(f64::INFINITY, 10.0) > 1e30);
    }

    #[test]
    fn lanes_do_what_scalars_do() {
        let a = Lanes::<4>::from_fn(|i| 1.0 + i as f64);
        let b = Lanes::<4>::splat(3.0);
        for lane in 0..4 {
            let x = 1.0 + lane as f64;
            assert_eq!(((a + b) * a / b - -a).get(lane), (x + 3.0) * x / 3.0 - -x);
        }
        assert!(a.any(|x| x == 4.0) && !a.any(|x| x > 4.0));
    }
}
