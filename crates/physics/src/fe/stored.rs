//! A flexibility as bytes: little-endian, versioned, with a digest.
//!
//! `HFEF`, version, counts of profile nodes, stations and matrices (`u32` each), then `f64`: rolls, arc lengths,
//! stations, half-space part, bulk matrices; SHA-256 of all that.

use sha2::{Digest, Sha256};

use super::flexibility::FlankFlexibility;
use super::input::{FeError, MESH_VERSION};

const MAGIC: [u8; 4] = *b"HFEF";
const HEADER: usize = 20;
const DIGEST: usize = 32;

impl FlankFlexibility {
    /// The bytes [`FlankFlexibility::from_bytes`] reads, same on every machine.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        for count in [MESH_VERSION as usize, self.rolls_m.len(), self.stations_m.len(), self.bulk.len()] {
            bytes.extend((count as u32).to_le_bytes());
        }
        let lists = [&self.rolls_m, &self.profile_m, &self.stations_m, &self.half_space];
        for value in lists.into_iter().chain(&self.bulk).flatten() {
            bytes.extend(value.to_le_bytes());
        }
        let digest = Sha256::digest(&bytes);
        bytes.extend_from_slice(&digest);
        bytes
    }

    /// Reads what [`FlankFlexibility::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`FeError::Stored`] for anything else, another version included.
    pub fn from_bytes(bytes: &[u8]) -> Result<FlankFlexibility, FeError> {
        let wrong = |reason| Err(FeError::Stored { reason });
        if bytes.len() < HEADER + DIGEST || bytes[..4] != MAGIC {
            return wrong("not a flexibility");
        }
        let (content, digest) = bytes.split_at(bytes.len() - DIGEST);
        let header = |i: usize| {
            let at = 4 + 4 * i;
            u32::from_le_bytes([content[at], content[at + 1], content[at + 2], content[at + 3]])
        };
        if header(0) != MESH_VERSION {
            return wrong("another version");
        }
        let [rows, stations, matrices] = [1, 2, 3].map(|i| u128::from(header(i)));
        let nodes = rows * stations;
        let values = 2 * rows + stations + nodes * nodes * (matrices + 1);
        if rows < 2 || stations < 2 || matrices < 1 || 8 * values + HEADER as u128 != content.len() as u128 {
            return wrong("the length is wrong");
        }
        if Sha256::digest(content)[..] != *digest {
            return wrong("the digest is wrong");
        }
        let mut numbers = content[HEADER..]
            .chunks_exact(8)
            .map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]));
        let mut take = |count: u128| -> Vec<f64> { numbers.by_ref().take(count as usize).collect() };
        let read = FlankFlexibility {
            rolls_m: take(rows),
            profile_m: take(rows),
            stations_m: take(stations),
            half_space: take(nodes * nodes),
            bulk: (0..matrices).map(|_| take(nodes * nodes)).collect(),
        };
        let rising = |list: &[f64]| list.windows(2).all(|pair| pair[0] < pair[1]);
        let finite = [&read.rolls_m, &read.profile_m, &read.stations_m, &read.half_space]
            .into_iter()
            .chain(&read.bulk)
            .flatten()
            .all(|value| value.is_finite());
        if !finite || !rising(&read.rolls_m) || !rising(&read.profile_m) || !rising(&read.stations_m) {
            return wrong("the values are not those of a flank");
        }
        Ok(read)
    }
}
