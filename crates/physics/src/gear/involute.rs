//! The involute function and its inverse.

/// `inv(alpha) = tan(alpha) - alpha`, with the series for small angles where the difference cancels.
pub(super) fn inv(alpha_rad: f64) -> f64 {
    inv_of_tan(alpha_rad.tan())
}

/// The involute function in terms of `t = tan(alpha)`: `t - atan(t)`.
fn inv_of_tan(t: f64) -> f64 {
    if t.abs() < 0.05 {
        // t - atan(t) = t³/3 - t⁵/5 + t⁷/7 - …: the first term left out is below 1e-17 of t³ here.
        let t2 = t * t;
        t * t2
            * (1.0 / 3.0
                - t2 * (1.0 / 5.0 - t2 * (1.0 / 7.0 - t2 * (1.0 / 9.0 - t2 * (1.0 / 11.0 - t2 * (1.0 / 13.0))))))
    } else {
        t - t.atan()
    }
}

/// Angle in rad whose involute function is `value`; `None` for negative or non-finite values.
///
/// Newton's method on `t - atan(t) = value`, `t = tan(alpha)`: the function is convex for `t > 0`, so after the first
/// step the iteration falls monotonically to the root, whatever the value.
pub(super) fn inverse_inv(value: f64) -> Option<f64> {
    if !value.is_finite() || value < 0.0 {
        return None;
    }
    if value == 0.0 {
        return Some(0.0);
    }
    // Lower bound (3v)^(1/3); far out the root tends to v + pi/2.
    let mut t = (3.0 * value).cbrt().min(value + std::f64::consts::FRAC_PI_2);
    for _ in 0..100 {
        let step = (inv_of_tan(t) - value) * (1.0 + t * t) / (t * t);
        t -= step;
        if step.abs() <= 4.0 * f64::EPSILON * t {
            break;
        }
    }
    Some(t.atan())
}

/// Roll length on an involute: distance from the base tangent point to the circle of radius `r_m`, zero below the base.
pub(super) fn roll_length_m(r_m: f64, base_radius_m: f64) -> f64 {
    ((r_m - base_radius_m) * (r_m + base_radius_m)).max(0.0).sqrt()
}

/// Involute function of the pressure angle at radius `r_m` of the involute with this base radius, zero below the base.
pub(super) fn inv_at_radius(r_m: f64, base_radius_m: f64) -> f64 {
    inv_of_tan(roll_length_m(r_m, base_radius_m) / base_radius_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_returns_the_angle_over_the_whole_range() {
        for k in 0..900 {
            let alpha = f64::from(k) * 0.1_f64.to_radians();
            let back = inverse_inv(inv(alpha)).unwrap_or(f64::NAN);
            assert!((back - alpha).abs() < 1e-13, "{alpha}: {back}");
        }
    }

    #[test]
    fn series_and_difference_agree_where_they_meet() {
        let t: f64 = 0.05;
        assert!((inv_of_tan(t * (1.0 - 1e-15)) / (t - t.atan()) - 1.0).abs() < 1e-11);
    }

    #[test]
    fn has_no_inverse_below_zero() {
        assert_eq!(inverse_inv(-1e-9), None);
        assert_eq!(inverse_inv(f64::NAN), None);
        assert_eq!(inverse_inv(f64::INFINITY), None);
    }
}
