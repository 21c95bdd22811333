//! Encrypted connections: certificates of both sides, made by `openssl`; without it the test says that it is skipped.

use crate::documents;
use crate::nats::NatsServer;
use crate::program::Program;
use crate::worker::Worker;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// An authority for certificates, in a folder.
struct Authority<'a> {
    folder: &'a Path,
    name: &'a str,
}

impl<'a> Authority<'a> {
    fn new(folder: &'a Path, name: &'a str) -> Option<Self> {
        let authority = Self { folder, name };
        let subject = format!("/CN={name}");
        let extension = "basicConstraints=critical,CA:TRUE";
        let words = ["req", "-x509", "-days", "2", "-subj", &subject, "-addext", extension];
        authority.key(name, &words)?;
        Some(authority)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn certificate(&self) -> String {
        self.file(&format!("{}.pem", self.name)).display().to_string()
    }

    /// Runs openssl with a new key in NAME.key and the output in NAME.pem; `None` where there is no openssl.
    fn key(&self, name: &str, words: &[&str]) -> Option<()> {
        let (key, certificate) = (self.file(&format!("{name}.key")), self.file(&format!("{name}.pem")));
        let mut command = Command::new("openssl");
        command.args(words).args(["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-keyout"]);
        command.arg(key).arg("-out").arg(certificate).stdin(Stdio::null());
        let Ok(output) = command.output() else {
            println!("skipped: no openssl here");
            return None;
        };
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(())
    }

    /// Signs a certificate for this machine; its paths and that of its key.
    fn sign(&self, name: &str) -> [String; 2] {
        let request = format!("{name}.request");
        self.key(&request, &["req", "-subj", &format!("/CN={name}")]).expect("openssl is there");
        let (extensions, certificate) = (self.file("extensions"), self.file(&format!("{name}.pem")));
        std::fs::write(&extensions, "subjectAltName=IP:127.0.0.1\nextendedKeyUsage=serverAuth,clientAuth\n")
            .expect("written");
        let mut command = Command::new("openssl");
        command.args(["x509", "-req", "-days", "2", "-CAcreateserial", "-CA"]).arg(self.certificate());
        command.arg("-CAkey").arg(self.file(&format!("{}.key", self.name))).arg("-extfile").arg(extensions);
        command.arg("-in").arg(self.file(&format!("{request}.pem"))).arg("-out").arg(&certificate);
        let output = command.output().expect("openssl runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        [certificate, self.file(&format!("{request}.key"))].map(|path| path.display().to_string())
    }
}

#[test]
fn connections_are_encrypted_and_certificates_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(authority) = Authority::new(folder.path(), "authority") else { return };
    let stranger = Authority::new(folder.path(), "stranger").expect("openssl is there");
    let (ca, [certificate, key]) = (authority.certificate(), authority.sign("server"));
    let [mine, my_key] = authority.sign("client");
    let words = ["--tlsverify", "--tlscacert", &ca, "--tlscert", &certificate, "--tlskey", &key];
    let Some(nats) = NatsServer::start_with(folder.path(), &words) else { return };
    let url = nats.url().replace("nats://", "tls://");
    let identity = ["--nats-ca", &ca, "--nats-cert", &mine, "--nats-key", &my_key];
    let service = Program::at(folder.path()).with(&["--queue", &url]).with(&identity).start();
    let worker = Worker::start(folder.path(), &url, &identity);
    // One that trusts another authority, and one without a certificate of its own.
    let elsewhere = stranger.certificate();
    let distrustful =
        Worker::start(folder.path(), &url, &["--nats-ca", &elsewhere, "--nats-cert", &mine, "--nats-key", &my_key]);
    let anonymous = Worker::start(folder.path(), &url, &["--nats-ca", &ca]);
    let path = service.submit(&documents::sweep(50));
    assert_eq!(service.ended(&path)["state"], "succeeded");
    assert!(worker.log().contains("connected to NATS"), "{}", worker.log());
    let deadline = Instant::now() + Duration::from_secs(3);
    while Instant::now() < deadline {
        for refused in [&distrustful, &anonymous] {
            assert!(!refused.log().contains("connected to NATS"), "{}", refused.log());
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    assert!(service.end().0.success());
}
