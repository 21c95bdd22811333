//! The addresses that may be asked: so that whoever sets an address cannot reach machines behind the service's
//! firewall.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr};
use std::str::FromStr;

/// A network in CIDR notation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Network {
    address: IpAddr,
    prefix: u8,
}

impl FromStr for Network {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "give a network such as 10.1.0.0/16".to_owned();
        let (address, prefix) = text.split_once('/').ok_or_else(wrong)?;
        let address: IpAddr = address.parse().map_err(|_| wrong())?;
        let prefix: u8 = prefix.parse().map_err(|_| wrong())?;
        let bits = if address.is_ipv4() { 32 } else { 128 };
        if prefix > bits { Err(wrong()) } else { Ok(Self { address, prefix }) }
    }
}

impl Network {
    const fn v4(a: u8, b: u8, c: u8, prefix: u8) -> Self {
        Self { address: IpAddr::V4(Ipv4Addr::new(a, b, c, 0)), prefix }
    }

    const fn v6(first: u16, second: u16, prefix: u8) -> Self {
        Self { address: IpAddr::V6(Ipv6Addr::new(first, second, 0, 0, 0, 0, 0, 0)), prefix }
    }

    pub(super) fn contains(&self, address: IpAddr) -> bool {
        let same = |a: u128, b: u128, bits: u32| {
            let shift = bits - u32::from(self.prefix);
            shift == bits || (a >> shift) == (b >> shift)
        };
        match (self.address, address) {
            (IpAddr::V4(network), IpAddr::V4(address)) => same(network.to_bits().into(), address.to_bits().into(), 32),
            (IpAddr::V6(network), IpAddr::V6(address)) => same(network.to_bits(), address.to_bits(), 128),
            _ => false,
        }
    }
}

/// What is not the public internet (IANA special-purpose address registries).
const NOT_PUBLIC: [Network; 28] = [
    Network::v4(0, 0, 0, 8),
    Network::v4(10, 0, 0, 8),
    Network::v4(100, 64, 0, 10),
    Network::v4(127, 0, 0, 8),
    Network::v4(169, 254, 0, 16),
    Network::v4(172, 16, 0, 12),
    Network::v4(192, 0, 0, 24),
    Network::v4(192, 0, 2, 24),
    Network::v4(192, 88, 99, 24),
    Network::v4(192, 168, 0, 16),
    Network::v4(198, 18, 0, 15),
    Network::v4(198, 51, 100, 24),
    Network::v4(203, 0, 113, 24),
    Network::v4(224, 0, 0, 4),
    Network::v4(240, 0, 0, 4),
    // Unspecified, loopback, and IPv4 inside IPv6 in its old forms.
    Network::v6(0, 0, 8),
    Network::v6(0x64, 0xff9b, 32),
    Network::v6(0x100, 0, 16),
    // Teredo, ORCHID, documentation.
    Network::v6(0x2001, 0, 23),
    Network::v6(0x2001, 0xdb8, 32),
    // 6to4: IPv4 inside IPv6.
    Network::v6(0x2002, 0, 16),
    Network::v6(0x3ffe, 0, 16),
    Network::v6(0x3fff, 0, 20),
    Network::v6(0x5f00, 0, 16),
    // Unique local, link-local, site-local, multicast.
    Network::v6(0xfc00, 0, 7),
    Network::v6(0xfe80, 0, 10),
    Network::v6(0xfec0, 0, 10),
    Network::v6(0xff00, 0, 8),
];

const WEB_PORTS: [u16; 2] = [80, 443];

/// Whether an address may be asked: it is public and has a port of the web, or it is in a permitted network, with any
/// port. IPv4 inside IPv6 counts as the IPv4 address that it is.
pub(super) fn is_permitted(address: IpAddr, port: u16, permitted: &[Network]) -> bool {
    let plain = address.to_canonical();
    if permitted.iter().any(|network| network.contains(address) || network.contains(plain)) {
        return true;
    }
    // An IPv4 address that is written as IPv6 is used by those alone who want it to be overlooked.
    let is_mapped = plain != address;
    !is_mapped && WEB_PORTS.contains(&port) && !NOT_PUBLIC.iter().any(|network| network.contains(address))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_public_addresses_with_ports_of_the_web_are_permitted() {
        let permitted = |text: &str, port| is_permitted(text.parse().unwrap(), port, &[]);
        for address in ["93.184.216.34", "1.1.1.1", "172.32.0.1", "100.128.0.1", "2606:4700::1111", "2a00:1450::1"] {
            assert!(permitted(address, 443) && permitted(address, 80), "{address}");
            assert!(!permitted(address, 8080) && !permitted(address, 22), "{address}");
        }
        for address in [
            "127.0.0.1",
            "127.255.255.254",
            "0.0.0.0",
            "10.0.0.1",
            "172.16.0.1",
            "172.31.255.255",
            "192.168.1.1",
            "169.254.169.254",
            "100.64.0.1",
            "100.127.255.255",
            "192.0.0.8",
            "198.18.0.1",
            "198.19.255.255",
            "224.0.0.1",
            "255.255.255.255",
            "::",
            "::1",
            "::ffff:127.0.0.1",
            "::ffff:93.184.216.34",
            "::7f00:1",
            "64:ff9b::7f00:1",
            "64:ff9b:1::1",
            "2002:7f00:1::1",
            "2001::1",
            "2001:db8::1",
            "fc00::1",
            "fd12::1",
            "fe80::1",
            "fec0::1",
            "ff02::1",
        ] {
            assert!(!permitted(address, 443), "{address}");
        }
    }

    #[test]
    fn a_permitted_network_has_every_port_and_nothing_beside_it() {
        let networks = ["10.1.0.0/16", "::1/128"].map(|text| text.parse().unwrap());
        let permitted = |text: &str| is_permitted(text.parse().unwrap(), 8080, &networks);
        assert!(permitted("10.1.255.255") && permitted("::1") && permitted("::ffff:10.1.0.1"));
        assert!(!permitted("10.2.0.0") && !permitted("::2") && !permitted("127.0.0.1"));
        let everything = ["0.0.0.0/0".parse().unwrap()];
        assert!(is_permitted("127.0.0.1".parse().unwrap(), 1, &everything));
        for wrong in ["10.1.0.0", "10.1.0.0/33", "::/129", "x/8", "10.1.0.0/-1"] {
            assert!(wrong.parse::<Network>().is_err(), "{wrong}");
        }
    }
}
