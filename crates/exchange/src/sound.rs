//! Recorded motions to be heard: WAV files (RIFF, 16 bits, mono).

use std::f64::consts::PI;

/// Half the width of the interpolation, in periods of its highest frequency; and how finely it is tabulated.
const HALF_WIDTH: f64 = 32.0;
const TABLE_PER_SAMPLE: usize = 256;
/// Shape of the window (Kaiser and Schafer, 1980): about 80 dB of attenuation.
const KAISER_BETA: f64 = 8.0;
/// Highest frequency that is kept, as a share of half the sampling rate of the sound.
const PASSED: f64 = 0.9;
/// Time over which the sound comes and goes.
const FADE_S: f64 = 0.01;
/// Share of the full scale that the largest value has when no full scale is given.
const PEAK: f64 = 0.8;

/// A sound to be made of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Sound<'a> {
    /// One or more whole periods of the motion: they are repeated as often as needed. Values that are not finite are
    /// silent.
    pub values: &'a [f64],
    /// Time between values.
    pub dt_s: f64,
    /// Length of the sound.
    pub seconds: f64,
    /// Sampling rate of the sound.
    pub rate_hz: u32,
    /// Value at full scale; larger ones are clipped. When it is not given, the largest value has four fifths of the
    /// scale.
    pub full_scale: Option<f64>,
    /// Unit of the values.
    pub unit: &'a str,
    /// What is heard; ends with the file, with the full scale.
    pub comment: &'a str,
}

impl Sound<'_> {
    /// The sound as a WAV file. The mean is taken off, frequencies above nine tenths of half the sampling rate too.
    pub fn to_wav(&self) -> Vec<u8> {
        let finite = || self.values.iter().copied().filter(|value| value.is_finite());
        let mean = finite().sum::<f64>() / finite().count().max(1) as f64;
        let values: Vec<f64> =
            self.values.iter().map(|value| if value.is_finite() { value - mean } else { 0.0 }).collect();
        let sound = self.resampled(&values);
        let peak = sound.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let scale = self.full_scale.unwrap_or(peak / PEAK);
        let level = |value: f64| if scale > 0.0 { value / scale } else { 0.0 };
        let samples = sound.iter().map(|value| (level(*value).clamp(-1.0, 1.0) * f64::from(i16::MAX)).round() as i16);
        let comment = format!("{}; full scale {scale:e} {}", self.comment, self.unit);
        wav(self.rate_hz, &samples.collect::<Vec<_>>(), &comment)
    }

    /// The values at the sampling rate of the sound: interpolated by a windowed sinc function, periodic.
    fn resampled(&self, values: &[f64]) -> Vec<f64> {
        let rate = f64::from(self.rate_hz);
        let n = (self.seconds * rate).round().max(0.0) as usize;
        if values.is_empty() {
            return vec![0.0; n];
        }
        let step = 1.0 / (rate * self.dt_s);
        let kernel = Kernel::new((PASSED / step).min(1.0));
        let period = values.len() as f64;
        let fade = (FADE_S * rate).min(n as f64 / 2.0).max(1.0);
        let at = |index: usize| {
            let place = (index as f64 * step).rem_euclid(period);
            let from_end = index.min(n - 1 - index) as f64;
            kernel.value(values, place) * (from_end / fade).min(1.0)
        };
        (0..n).map(at).collect()
    }
}

/// An interpolation that passes frequencies up to a share of half the sampling rate of the values.
struct Kernel {
    table: Vec<f64>,
    half_width: f64,
}

impl Kernel {
    fn new(share: f64) -> Self {
        let half_width = HALF_WIDTH / share;
        let n = (half_width * TABLE_PER_SAMPLE as f64).ceil() as usize + 2;
        let of = |index: usize| {
            let distance = index as f64 / TABLE_PER_SAMPLE as f64;
            let inside = (1.0 - (distance / half_width).powi(2)).max(0.0);
            let argument = PI * share * distance;
            let sinc = if argument == 0.0 { 1.0 } else { argument.sin() / argument };
            share * sinc * bessel_i0(KAISER_BETA * inside.sqrt()) / bessel_i0(KAISER_BETA)
        };
        Self { table: (0..n).map(of).collect(), half_width }
    }

    /// The value at a place, counted in values; the values repeat.
    fn value(&self, values: &[f64], place: f64) -> f64 {
        let (first, last) = ((place - self.half_width).ceil() as i64, (place + self.half_width).floor() as i64);
        let n = values.len();
        let mut at = first.rem_euclid(n as i64) as usize;
        let mut sum = 0.0;
        for index in first..=last {
            let distance = (place - index as f64).abs() * TABLE_PER_SAMPLE as f64;
            let cell = distance as usize;
            let share = distance - cell as f64;
            let (low, high) = (self.table[cell], self.table[cell + 1]);
            sum += values[at] * (low + share * (high - low));
            at = if at + 1 == n { 0 } else { at + 1 };
        }
        sum
    }
}

/// The modified Bessel function of the first kind and order 0, by its power series (DLMF 10.25.2).
fn bessel_i0(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut term, mut sum, mut order) = (1.0, 1.0, 1.0);
    while term > 1e-17 * sum {
        term *= quarter / (order * order);
        sum += term;
        order += 1.0;
    }
    sum
}

/// A file of 16-bit samples of one channel with a comment.
fn wav(rate_hz: u32, samples: &[i16], comment: &str) -> Vec<u8> {
    let chunk = |name: &[u8; 4], content: &[u8]| {
        let mut bytes = name.to_vec();
        bytes.extend_from_slice(&(content.len() as u32).to_le_bytes());
        bytes.extend_from_slice(content);
        bytes.resize(bytes.len().next_multiple_of(2), 0);
        bytes
    };
    let mut format = Vec::new();
    for word in [1_u16, 1] {
        format.extend_from_slice(&word.to_le_bytes());
    }
    for word in [rate_hz, rate_hz * 2] {
        format.extend_from_slice(&word.to_le_bytes());
    }
    for word in [2_u16, 16] {
        format.extend_from_slice(&word.to_le_bytes());
    }
    let mut text = comment.as_bytes().to_vec();
    text.push(0);
    let info = [b"INFO".to_vec(), chunk(b"ICMT", &text)].concat();
    let data: Vec<u8> = samples.iter().flat_map(|sample| sample.to_le_bytes()).collect();
    let content = [b"WAVE".to_vec(), chunk(b"fmt ", &format), chunk(b"LIST", &info), chunk(b"data", &data)].concat();
    chunk(b"RIFF", &content)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sampling rate, the samples and the rest of a file.
    fn read(bytes: &[u8]) -> (u32, Vec<i16>) {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!((&bytes[..4], &bytes[8..16], word(4) as usize), (&b"RIFF"[..], &b"WAVEfmt "[..], bytes.len() - 8));
        assert_eq!((word(16), &bytes[20..24], &bytes[32..36]), (16, &[1, 0, 1, 0][..], &[2, 0, 16, 0][..]));
        let start = bytes.windows(4).position(|name| name == b"data").unwrap();
        assert_eq!(word(start + 4) as usize, bytes.len() - start - 8);
        let samples = bytes[start + 8..].chunks(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect();
        (word(24), samples)
    }

    fn tone(frequencies_hz: &[(f64, f64)], n: usize, dt_s: f64) -> Vec<f64> {
        let of = |at: usize| {
            let time_s = at as f64 * dt_s;
            frequencies_hz.iter().map(|(hz, amplitude)| amplitude * (2.0 * PI * hz * time_s).sin()).sum::<f64>() + 3.0
        };
        (0..n).map(of).collect()
    }

    #[test]
    fn a_tone_keeps_pitch_and_amplitude_over_the_seams_and_what_is_too_high_is_taken_off() {
        // Ten periods of 500 Hz, sampled at 160 kHz; 64 kHz would be heard as 16 kHz.
        let dt_s = 1.0 / 160e3;
        let values = tone(&[(500.0, 2.0), (64_000.0, 1.0)], 3200, dt_s);
        let sound = Sound {
            values: &values,
            dt_s,
            seconds: 0.1,
            rate_hz: 44_100,
            full_scale: Some(4.0),
            unit: "m/s2",
            comment: "a test",
        };
        let bytes = sound.to_wav();
        let (rate_hz, samples) = read(&bytes);
        assert_eq!((rate_hz, samples.len()), (44_100, 4410));
        let has = |text: &str| bytes.windows(text.len()).any(|part| part == text.as_bytes());
        assert!(has("a test; full scale 4e0 m/s2"));
        let fade = 441;
        for (at, sample) in samples.iter().enumerate().skip(fade).take(samples.len() - 2 * fade) {
            let expected = 0.5 * (2.0 * PI * 500.0 * at as f64 / 44_100.0).sin();
            let heard = f64::from(*sample) / f64::from(i16::MAX);
            assert!((heard - expected).abs() < 2e-4, "{at}: {heard} {expected}");
        }
        assert_eq!((samples[0], samples[4409]), (0, 0));
    }

    #[test]
    fn without_a_scale_the_peak_is_at_four_fifths() {
        let values = tone(&[(1000.0, 1e-4)], 480, 1.0 / 48e3);
        let sound = Sound {
            values: &values,
            dt_s: 1.0 / 48e3,
            seconds: 0.05,
            rate_hz: 48_000,
            full_scale: None,
            unit: "m/s2",
            comment: "",
        };
        let (_, samples) = read(&sound.to_wav());
        let peak = samples.iter().map(|sample| sample.unsigned_abs()).max().unwrap();
        assert_eq!(peak, (0.8 * 32_767.0_f64).round() as u16);
        let silent = Sound { values: &[f64::NAN, 1.0, 1.0], ..sound.clone() };
        assert!(read(&silent.to_wav()).1.iter().all(|sample| *sample == 0));
        assert_eq!(read(&Sound { values: &[], ..sound }.to_wav()).1.len(), 2400);
    }
}
