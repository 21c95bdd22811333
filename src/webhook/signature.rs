//! Signatures: HMAC-SHA256 over id, time and body (Standard Webhooks 1.0, "Signature scheme").

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use hmac::{Hmac, KeyInit, Mac};
use sha2::Sha256;

const PREFIX: &str = "whsec_";
/// Bytes of a key.
const KEY_BYTES: std::ops::RangeInclusive<usize> = 16..=64;

/// Keys, the newest first: while a secret is being changed, every message is signed with each of them.
#[derive(Clone, Default)]
pub(super) struct SigningKeys(Vec<Vec<u8>>);

impl std::fmt::Debug for SigningKeys {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{} keys", self.0.len())
    }
}

impl SigningKeys {
    /// Reads secrets: `whsec_` and the key in Base64, one in a line.
    ///
    /// # Errors
    /// Why a line is no secret, without it.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        let mut keys = Vec::new();
        for (at, line) in text.lines().map(str::trim).enumerate().filter(|(_, line)| !line.is_empty()) {
            let encoded = line.strip_prefix(PREFIX).ok_or_else(|| format!("line {} lacks {PREFIX}", at + 1))?;
            let key = STANDARD.decode(encoded).map_err(|error| format!("line {} is no Base64: {error}", at + 1))?;
            if !KEY_BYTES.contains(&key.len()) {
                let (least, most) = KEY_BYTES.into_inner();
                return Err(format!("line {} has a key of {} bytes; permitted: {least} to {most}", at + 1, key.len()));
            }
            keys.push(key);
        }
        if keys.is_empty() { Err("it has no secret".to_owned()) } else { Ok(Self(keys)) }
    }

    /// The header `webhook-signature`: a signature with each key.
    pub(super) fn sign(&self, id: &str, time_s: i64, body: &str) -> String {
        let signatures = self.0.iter().filter_map(|key| {
            let mut mac = Hmac::<Sha256>::new_from_slice(key).ok()?;
            mac.update(format!("{id}.{time_s}.{body}").as_bytes());
            Some(format!("v1,{}", STANDARD.encode(mac.finalize().into_bytes())))
        });
        signatures.collect::<Vec<_>>().join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECRET: &str = "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw";

    /// The test vector of the specification.
    #[test]
    fn a_message_is_signed_as_the_specification_signs_it() {
        let keys = SigningKeys::read(SECRET).unwrap();
        let signature = keys.sign("msg_p5jXN8AQM9LWM0D4loKWxJek", 1_614_265_330, "{\"test\": 2432232314}");
        assert_eq!(signature, "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=");
    }

    #[test]
    fn every_secret_signs_and_what_is_none_is_refused_without_telling_it() {
        let keys = SigningKeys::read(&format!("\n{SECRET}\nwhsec_{}\n", STANDARD.encode([7; 32]))).unwrap();
        let signature = keys.sign("id", 1, "body");
        let parts: Vec<_> = signature.split(' ').collect();
        assert_eq!(parts.len(), 2);
        assert!(parts[0] != parts[1] && parts.iter().all(|part| part.starts_with("v1,")));
        for wrong in ["", "\n", "MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw", "whsec_***", "whsec_c2hvcnQ="] {
            let error = SigningKeys::read(wrong).unwrap_err();
            assert!(!error.contains("c2hvcnQ") && !error.contains("MfKQ"), "{error}");
        }
        assert_eq!(format!("{keys:?}"), "2 keys");
    }
}
