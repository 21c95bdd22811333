//! Credentials files (`--nats-creds`): a NATS with an operator, whose users are known by signed tokens and keys.

use crate::documents;
use crate::nats::NatsServer;
use crate::program::Program;
use crate::worker::Worker;
use base64::Engine;
use base64::prelude::BASE64_URL_SAFE_NO_PAD;
use nkeys::KeyPair;
use serde_json::{Value, json};
use std::path::Path;
use std::time::{Duration, Instant};

/// A token of NATS: what is claimed about a key, signed by another one.
fn token(issuer: &KeyPair, subject: &KeyPair, name: &str, claims: Value) -> String {
    let header = json!({"typ": "JWT", "alg": "ed25519-nkey"});
    let body = json!({
        "jti": format!("test-{name}"), "iat": 1_700_000_000, "iss": issuer.public_key(), "name": name,
        "sub": subject.public_key(), "nats": claims,
    });
    let text = [header, body].map(|part| BASE64_URL_SAFE_NO_PAD.encode(part.to_string())).join(".");
    let signature = issuer.sign(text.as_bytes()).expect("signed");
    format!("{text}.{}", BASE64_URL_SAFE_NO_PAD.encode(signature))
}

/// A user with these permissions, as a credentials file.
fn user(account: &KeyPair, folder: &Path, name: &str, publish: &[&str], subscribe: &[&str]) -> String {
    let key = KeyPair::new_user();
    let claims = json!({
        "type": "user", "version": 2, "subs": -1, "data": -1, "payload": -1,
        "pub": {"allow": publish}, "sub": {"allow": subscribe},
    });
    let text = format!(
        "-----BEGIN NATS USER JWT-----\n{}\n------END NATS USER JWT------\n\n\
         -----BEGIN USER NKEY SEED-----\n{}\n------END USER NKEY SEED------\n",
        token(account, &key, name, claims),
        key.seed().expect("a seed")
    );
    let path = folder.join(format!("{name}.creds"));
    std::fs::write(&path, text).expect("written");
    path.display().to_string()
}

#[test]
fn credentials_files_open_nats_and_nothing_else_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let operator = KeyPair::new_operator();
    let [account, system, stranger] = [(); 3].map(|()| KeyPair::new_account());
    let of_operator = token(&operator, &operator, "operator", json!({"type": "operator", "version": 2}));
    let limits = json!({
        "subs": -1, "data": -1, "payload": -1, "imports": -1, "exports": -1, "wildcards": true, "conn": -1,
        "leaf": -1, "mem_storage": -1, "disk_storage": -1, "streams": -1, "consumer": -1,
    });
    let claims = json!({"type": "account", "version": 2, "limits": limits});
    let of_account = token(&operator, &account, "gears", claims);
    let of_system = token(&operator, &system, "system", json!({"type": "account", "version": 2}));
    let config = format!(
        "operator: {of_operator}\nsystem_account: {1}\nresolver: MEMORY\n\
         resolver_preload: {{ {0}: {of_account}, {1}: {of_system} }}\n",
        account.public_key(),
        system.public_key()
    );
    let path = folder.path().join("nats.conf");
    std::fs::write(&path, config).expect("written");
    let Some(nats) = NatsServer::start_with(folder.path(), &["--config", &path.display().to_string()]) else { return };
    let url = nats.url();
    let service = user(&account, folder.path(), "service", &[">"], &[">"]);
    let publish = [
        "hb.test.result.>",
        "hb.test.start",
        "hb.test.beat",
        "hb.test.stage.>",
        "$JS.API.CONSUMER.MSG.NEXT.HB_test_WORK.>",
        "$JS.API.CONSUMER.INFO.HB_test_WORK.>",
        "$JS.ACK.HB_test_WORK.>",
    ];
    let subscribe = ["_INBOX.>", "hb.test.cancel", "hb.test.wake"];
    let [known, unknown] = [&account, &stranger]
        .map(|signer| user(signer, folder.path(), &signer.public_key()[..8], &publish, &subscribe));
    let program = Program::at(folder.path()).with(&["--queue", &url, "--space", "test", "--nats-creds", &service]);
    let service = program.start();
    let worker = Worker::start(folder.path(), &url, &["--space", "test", "--nats-creds", &known]);
    // One whose user another account has signed, and one without a user.
    let refused = [
        Worker::start(folder.path(), &url, &["--space", "test", "--nats-creds", &unknown]),
        Worker::start(folder.path(), &url, &["--space", "test"]),
    ];
    for document in [documents::sweep(60), documents::response()] {
        let path = service.submit(&document);
        assert_eq!(service.ended(&path)["state"], "succeeded");
    }
    let log = worker.log();
    assert!(log.contains("connected to NATS") && !log.contains("Permissions Violation"), "{log}");
    let deadline = Instant::now() + Duration::from_secs(2);
    while Instant::now() < deadline {
        for worker in &refused {
            assert!(!worker.log().contains("connected to NATS"), "{}", worker.log());
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    // Neither tokens nor seeds are logged.
    for log in [program.log(), log, refused[0].log()] {
        assert!(!log.contains("SEED") && !log.contains("eyJ0"), "{log}");
    }
    assert!(service.end().0.success());
}
