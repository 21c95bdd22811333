//! The standard normal distribution.

/// Coefficients of numerator and denominator, ascending.
type Rational = ([f64; 8], [f64; 8]);

const CENTRE: Rational = (
    [
        3.387_132_872_796_366_5,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_854e3,
    ],
);

const MIDDLE: Rational = (
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
);

const TAIL: Rational = (
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        2.965_605_718_285_048_7e-1,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        5.998_322_065_558_88e-1,
        1.369_298_809_227_358e-1,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
);

fn ratio((above, below): &Rational, at: f64) -> f64 {
    let value = |coefficients: &[f64; 8]| coefficients.iter().rev().fold(0.0, |sum, one| sum * at + one);
    value(above) / value(below)
}

/// The number below which a standard normal variable lies with probability `p`: Wichura 1988, algorithm AS 241 (PPND16,
/// doi:10.2307/2347330), relative error about 1e-16. Infinite at 0 and 1, NaN beyond.
pub fn normal_quantile(p: f64) -> f64 {
    let from_centre = p - 0.5;
    if from_centre.abs() <= 0.425 {
        return from_centre * ratio(&CENTRE, 0.180_625 - from_centre * from_centre);
    }
    let outside = p.min(1.0 - p);
    if outside <= 0.0 {
        return if p == 0.0 {
            f64::NEG_INFINITY
        } else if p == 1.0 {
            f64::INFINITY
        } else {
            f64::NAN
        };
    }
    let root = (-outside.ln()).sqrt();
    let size = if root <= 5.0 { ratio(&MIDDLE, root - 1.6) } else { ratio(&TAIL, root - 5.0) };
    size.copysign(from_centre)
}

/// Probability that a standard normal variable lies below `x`: the inverse of [`normal_quantile`], by bisection to the
/// last bits. For single values such as the probability of a cut.
pub fn normal_distribution(x: f64) -> f64 {
    if x > 0.0 {
        return 1.0 - normal_distribution(-x);
    }
    let (mut low, mut high) = (0.0, 0.5);
    for _ in 0..1100 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if normal_quantile(middle) < x { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Numbers of (0, 1), independent and uniform, made dependent: their normal scores have the correlation `correlation`
/// each with each other one, and each number is uniform still. By the symmetric root of the matrix of correlations,
/// √(1 − ρ) (1 − J/k) + √(1 + (k − 1) ρ) J/k with the matrix J of ones. `correlation` from −1/(k − 1) to 1.
pub fn correlated(numbers: &[f64], correlation: f64) -> Vec<f64> {
    let count = numbers.len().max(1) as f64;
    let apart = (1.0 - correlation).max(0.0).sqrt();
    let together = (1.0 + (count - 1.0) * correlation).max(0.0).sqrt();
    let scores: Vec<f64> = numbers.iter().map(|number| normal_quantile(*number)).collect();
    let mean = scores.iter().sum::<f64>() / count;
    let least = f64::EPSILON;
    scores
        .iter()
        .map(|score| normal_distribution(apart * (score - mean) + together * mean).clamp(least, 1.0 - least))
        .collect()
}
