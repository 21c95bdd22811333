//! Units of REXS files.

/// What an attribute measures. Each has one unit into which it is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// A plain number.
    Number,
    /// mm.
    Length,
    /// Degrees.
    Angle,
    /// Revolutions per minute.
    Speed,
    /// N·m.
    Torque,
    /// kW.
    Power,
    /// N/mm².
    Stress,
    /// kg/dm³.
    Density,
    /// kg.
    Mass,
    /// kg·m².
    Inertia,
    /// N/m.
    LinearStiffness,
    /// N·mm/rad.
    AngularStiffness,
    /// Percent.
    Share,
    /// Hours.
    Time,
}

/// Spellings of units with their factors.
type Table = &'static [(&'static str, f64)];

impl Quantity {
    /// The units that are read, without blanks; the first is that into which it is read.
    fn table(self) -> Table {
        match self {
            Quantity::Number => &[("none", 1.0), ("-", 1.0), ("1", 1.0)],
            Quantity::Length => &[("mm", 1.0), ("mum", 1e-3), ("µm", 1e-3), ("μm", 1e-3), ("um", 1e-3), ("m", 1e3)],
            Quantity::Angle => &[("deg", 1.0), ("°", 1.0), ("degree", 1.0), ("rad", 180.0 / std::f64::consts::PI)],
            Quantity::Speed => &[("1/min", 1.0), ("rpm", 1.0), ("min^-1", 1.0), ("rad/s", 30.0 / std::f64::consts::PI)],
            Quantity::Torque => &[("Nm", 1.0), ("Nmm", 1e-3), ("kNm", 1e3)],
            Quantity::Power => &[("kW", 1.0), ("W", 1e-3)],
            Quantity::Stress => &[("N/mm^2", 1.0), ("MPa", 1.0), ("N/mm²", 1.0), ("GPa", 1e3), ("Pa", 1e-6)],
            Quantity::Density => &[("kg/dm^3", 1.0), ("kg/dm³", 1.0), ("kg/m^3", 1e-3), ("kg/m³", 1e-3)],
            Quantity::Mass => &[("kg", 1.0), ("mg", 1e-6)],
            Quantity::Inertia => &[("kgm^2", 1.0), ("kgm²", 1.0)],
            Quantity::LinearStiffness => &[("N/m", 1.0), ("N/mm", 1e3), ("N/mum", 1e6), ("N/µm", 1e6)],
            Quantity::AngularStiffness => &[("Nmm/rad", 1.0), ("Nm/rad", 1e3)],
            Quantity::Share => &[("%", 1.0)],
            Quantity::Time => &[("h", 1.0), ("s", 1.0 / 3600.0)],
        }
    }

    /// Factor from a unit of the file; `None` for a unit that this quantity does not have.
    pub(crate) fn factor(self, unit: &str) -> Option<f64> {
        let plain: String = unit.chars().filter(|letter| !letter.is_whitespace() && *letter != '·').collect();
        self.table().iter().find(|(name, _)| *name == plain).map(|(_, factor)| *factor)
    }

    /// The unit into which it is read.
    pub(crate) fn unit(self) -> &'static str {
        match self {
            Quantity::Number => "none",
            other => other.table()[0].0,
        }
    }

    /// The units that are read, for messages.
    pub(crate) fn names(self) -> String {
        self.table().iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
    }
}

/// A converted value without the errors of its last digits: to 15 significant ones.
pub(crate) fn clean(value: f64) -> f64 {
    // The text of a number reads back as a number.
    format!("{value:.14e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_one_unit_mean_the_same() {
        for unit in ["N / mm^2", "N/mm^2", "MPa"] {
            assert_eq!(Quantity::Stress.factor(unit), Some(1.0), "{unit}");
        }
        for unit in ["°", "deg", "degree"] {
            assert_eq!(Quantity::Angle.factor(unit), Some(1.0), "{unit}");
        }
        assert_eq!(Quantity::Length.factor("mum"), Some(1e-3));
        assert_eq!(Quantity::AngularStiffness.factor("N mm / rad"), Some(1.0));
    }

    #[test]
    fn a_unit_of_another_quantity_is_none() {
        for (quantity, unit) in [
            (Quantity::Length, "inch"),
            (Quantity::Length, "MM"),
            (Quantity::Angle, "mm"),
            (Quantity::Torque, "N"),
            (Quantity::Speed, "1 / s"),
        ] {
            assert_eq!(quantity.factor(unit), None, "{unit}");
        }
    }

    #[test]
    fn cleaning_keeps_fifteen_digits() {
        assert_eq!(clean((0.1 + 0.14) / 2.0 * 1000.0), 120.0);
        assert_eq!(clean(0.231415), 0.231415);
        assert_eq!(clean(1.0 / 3.0), 0.333333333333333);
    }
}
