//! A service with workers on other machines: real NATS servers, real processes, faults of each. Without `nats-server`
//! (Debian's package of this name, or a path in `HERRINGBONE_NATS_SERVER`) the tests say that they are skipped.

#[allow(dead_code)]
#[path = "../faults/audit.rs"]
mod audit;
#[allow(dead_code)]
#[path = "../faults/chance.rs"]
mod chance;
#[allow(dead_code)]
#[path = "../faults/client.rs"]
mod client;
#[allow(dead_code)]
#[path = "../faults/documents.rs"]
mod documents;
#[allow(dead_code)]
#[path = "../faults/program.rs"]
mod program;

mod both;
mod chaos;
mod clock;
mod credentials;
mod equal;
mod faults;
mod lives;
mod nats;
mod proxy;
mod queue;
mod rates;
mod rights;
mod searches;
mod setting;
mod tls;
mod worker;
