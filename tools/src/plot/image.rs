//! A coloured map as an image inside an SVG: a PNG, stored without compression, in base64.

/// Viridis at ten steps (van der Walt and Smith), from least to most.
const VIRIDIS: [[u8; 3]; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [68, 191, 112],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];

/// The colour at a part of the scale.
pub fn color(part: f64) -> [u8; 3] {
    let place = part.clamp(0.0, 1.0) * 10.0;
    let low = (place as usize).min(9);
    let rest = place - low as f64;
    [0, 1, 2].map(|c| {
        let [a, b] = [VIRIDIS[low][c], VIRIDIS[low + 1][c]].map(f64::from);
        (a + rest * (b - a)).round() as u8
    })
}

/// An `image` element: rows of colours from the top, at a place (left, top, width, height).
pub fn image(rows: &[Vec<[u8; 3]>], place: [f64; 4]) -> String {
    let [left, top, width, height] = place;
    format!(
        "<image x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>",
        base64(&png(rows))
    )
}

/// A PNG of 8 bits per colour.
fn png(rows: &[Vec<[u8; 3]>]) -> Vec<u8> {
    let width = rows.first().map_or(0, Vec::len) as u32;
    let mut raw = Vec::new();
    for row in rows {
        raw.push(0); // no filter
        raw.extend(row.iter().flatten());
    }
    let mut header = Vec::new();
    header.extend(width.to_be_bytes());
    header.extend((rows.len() as u32).to_be_bytes());
    header.extend([8, 2, 0, 0, 0]);
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    chunk(&mut file, b"IHDR", &header);
    chunk(&mut file, b"IDAT", &stored(&raw));
    chunk(&mut file, b"IEND", &[]);
    file
}

fn chunk(file: &mut Vec<u8>, name: &[u8; 4], data: &[u8]) {
    file.extend((data.len() as u32).to_be_bytes());
    let begin = file.len();
    file.extend(name);
    file.extend(data);
    let sum = crc(&file[begin..]);
    file.extend(sum.to_be_bytes());
}

/// A zlib stream of stored blocks (RFC 1950, 1951).
fn stored(raw: &[u8]) -> Vec<u8> {
    let mut stream = vec![0x78, 0x01];
    let blocks = raw.len().div_ceil(65535).max(1);
    for (index, block) in raw.chunks(65535).enumerate() {
        stream.push(u8::from(index + 1 == blocks));
        stream.extend((block.len() as u16).to_le_bytes());
        stream.extend((!(block.len() as u16)).to_le_bytes());
        stream.extend(block);
    }
    let (a, b) = raw.iter().fold((1u32, 0u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (b + a) % 65521)
    });
    stream.extend(((b << 16) | a).to_be_bytes());
    stream
}

/// CRC-32 (ISO 3309), bit by bit.
fn crc(data: &[u8]) -> u32 {
    !data.iter().fold(!0u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| if sum & 1 == 1 { (sum >> 1) ^ 0xedb8_8320 } else { sum >> 1 })
    })
}

fn base64(data: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in data.chunks(3) {
        let bits =
            group.iter().enumerate().fold(0u32, |bits, (index, byte)| bits | u32::from(*byte) << (16 - 8 * index));
        for digit in 0..4 {
            let character = if digit <= group.len() { DIGITS[(bits >> (18 - 6 * digit) & 63) as usize] } else { b'=' };
            text.push(char::from(character));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// RFC 4648, section 10.
    #[test]
    fn base64_of_the_standards_examples() {
        assert_eq!([&b""[..], b"f", b"fo", b"foo", b"foob"].map(base64), ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg=="]);
    }

    /// CRC-32's check value, and the trailer of every zlib stream of "abc" (RFC 1950's Adler-32).
    #[test]
    fn sums_of_known_data() {
        assert_eq!(crc(b"123456789"), 0xcbf4_3926);
        assert_eq!(stored(b"abc")[10..], 0x024d_0127_u32.to_be_bytes());
    }
}
