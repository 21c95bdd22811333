//! Random numbers that are functions of a seed and a counter.

/// Random numbers of a stream: each is a hash of seed, stream and counter, so that any of them is found without those
/// before it. The mixing function is the finaliser of SplitMix64 (Steele, Lea and Flood 2014,
/// doi:10.1145/2714064.2660195).
#[derive(Debug, Clone)]
pub struct CounterRandom {
    key: u64,
    counter: u64,
}

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

fn mix(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

impl CounterRandom {
    /// The stream of a seed at a place, such as generation and index.
    pub fn new(seed: u64, place: &[u64]) -> Self {
        let key = place.iter().fold(mix(seed.wrapping_add(GOLDEN)), |key, part| {
            mix(key.wrapping_add(GOLDEN) ^ mix(part.wrapping_add(GOLDEN)))
        });
        Self { key, counter: 0 }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.counter = self.counter.wrapping_add(1);
        mix(self.key.wrapping_add(self.counter.wrapping_mul(GOLDEN)))
    }

    /// The next number of the open interval (0, 1), uniformly distributed.
    pub fn uniform(&mut self) -> f64 {
        ((self.bits() >> 11) as f64 + 0.5) * (1.0 / (1u64 << 53) as f64)
    }

    /// The next number with the standard normal distribution.
    pub fn normal(&mut self) -> f64 {
        crate::normal_quantile(self.uniform())
    }

    /// The next whole number below `end`; 0 if `end` is 0. The bias of the multiplication is below `end`/2⁶⁴.
    pub fn below(&mut self, end: usize) -> usize {
        ((u128::from(self.bits()) * end as u128) >> 64) as usize
    }

    /// Brings items into random order (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            let other = self.below(last + 1);
            items.swap(last, other);
        }
    }
}
