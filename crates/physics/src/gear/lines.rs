//! Lines of contact of one half in the plane of action.

use super::pair::Pair;

/// The stretch of one tooth pair's line of contact inside the zone of contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLine {
    /// Index `k` of the pair: it touches along `x = x0 + k p_bt + entry tan(beta_b)`.
    pub pair: i32,
    /// Axial interval, distance from the mesh-out end, from lower to upper.
    pub entry_m: [f64; 2],
    /// Roll coordinates at the ends of `entry_m`.
    pub x_m: [f64; 2],
}

impl ContactLine {
    /// Axial extent of the line.
    pub fn width_m(&self) -> f64 {
        self.entry_m[1] - self.entry_m[0]
    }
}

impl Pair {
    /// Lines of contact at mesh position `x0_m`, in the order of `k`; lines without length are left out.
    pub fn contact_lines(&self, x0_m: f64) -> Vec<ContactLine> {
        let b = self.spec.face_width_m;
        let tan_bb = self.base_helix_angle_rad.tan();
        let p = self.base_pitch_m;
        let first = ((self.path_start_m - b * tan_bb - x0_m) / p).ceil();
        let last = ((self.path_end_m - x0_m) / p).floor();
        (first as i32..=last as i32)
            .filter_map(|pair| {
                let foot = x0_m + f64::from(pair) * p;
                let entry = if tan_bb > 0.0 {
                    [((self.path_start_m - foot) / tan_bb).max(0.0), ((self.path_end_m - foot) / tan_bb).min(b)]
                } else {
                    [0.0, b]
                };
                let line = ContactLine { pair, entry_m: entry, x_m: entry.map(|e| foot + e * tan_bb) };
                (line.width_m() > 0.0).then_some(line)
            })
            .collect()
    }

    /// Total length of the lines of contact of one half at mesh position `x0_m`, along the lines.
    pub fn contact_length_m(&self, x0_m: f64) -> f64 {
        self.contact_lines(x0_m).iter().map(ContactLine::width_m).sum::<f64>() / self.base_helix_angle_rad.cos()
    }

    /// Mean of the contact length over a mesh period: `eps_alpha b / cos(beta_b)`.
    pub fn mean_contact_length_m(&self) -> f64 {
        self.transverse_contact_ratio * self.spec.face_width_m / self.base_helix_angle_rad.cos()
    }

    /// Least and greatest contact length over a mesh period, in closed form (the least as in AGMA 908; the greatest by
    /// the same argument). Both equal the mean when a contact ratio is whole.
    pub fn contact_length_range_m(&self) -> [f64; 2] {
        let (ea, eb) = (self.transverse_contact_ratio, self.overlap_ratio);
        let unit = self.spec.face_width_m / self.base_helix_angle_rad.cos();
        let (na, nb) = (ea.fract(), eb.fract());
        if eb < 1e-9 {
            return [unit * ea.floor(), unit * if na > 0.0 { ea.floor() + 1.0 } else { ea }];
        }
        let least = if na <= 1.0 - nb { ea - na * nb / eb } else { ea - (1.0 - na) * (1.0 - nb) / eb };
        let greatest = if na <= nb { ea + na * (1.0 - nb) / eb } else { ea + nb * (1.0 - na) / eb };
        [unit * least, unit * greatest]
    }
}
