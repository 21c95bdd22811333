//! Tables 2 and 3 as printed in the source paper.

/// One row of both tables.
pub(crate) struct Printed {
    pub ratio: f64,
    /// "Pinion modification coefficient".
    pub coefficient: f64,
    /// Impact force by Zhou et al., kN.
    pub zhou_kn: f64,
    /// Impact force by the source's model, kN.
    pub buffered_kn: f64,
    /// RMS accelerations, m/s²: mesh circumferential and pinion axial. Two rows are blank.
    pub rms: Option<[f64; 2]>,
    /// Our document at this contact ratio.
    pub document: &'static str,
}

pub(crate) const PRINTED: [Printed; 5] = [
    Printed {
        ratio: 2.72,
        coefficient: 0.25,
        zhou_kn: 9.255,
        buffered_kn: 8.896,
        rms: Some([32.7, 2.07]),
        document: "examples/table2_2_72.json",
    },
    Printed {
        ratio: 2.91,
        coefficient: 0.12,
        zhou_kn: 8.661,
        buffered_kn: 8.378,
        rms: None,
        document: "examples/table2_2_91.json",
    },
    Printed {
        ratio: 3.30,
        coefficient: 0.0,
        zhou_kn: 6.593,
        buffered_kn: 6.469,
        rms: Some([15.8, 1.02]),
        document: "examples/table2_3_30.json",
    },
    Printed {
        ratio: 3.68,
        coefficient: -0.13,
        zhou_kn: 5.180,
        buffered_kn: 5.121,
        rms: None,
        document: "examples/table2_3_68.json",
    },
    Printed {
        ratio: 4.07,
        coefficient: -0.22,
        zhou_kn: 2.107,
        buffered_kn: 2.096,
        rms: Some([34.4, 2.56]),
        document: "examples/table2_4_07.json",
    },
];

impl Printed {
    /// Reduction by the pairs in mesh, %.
    pub(crate) fn reduction(&self) -> f64 {
        100.0 * (1.0 - self.buffered_kn / self.zhou_kn)
    }

    /// The load share of the entering pair that the two forces imply: (F_Zhou/F)² = 1 + L/(1 − L) for a small
    /// inclination.
    pub(crate) fn share(&self) -> f64 {
        1.0 - (self.buffered_kn / self.zhou_kn).powi(2)
    }
}
