//! Two users of NATS with least rights: the configuration of docs/SCALING.md works, and a worker can do nothing else.

use crate::documents;
use crate::nats::NatsServer;
use crate::program::Program;
use crate::worker::Worker;

/// The users of a space, as docs/SCALING.md gives them.
const USERS: &str = include_str!("../../deploy/cluster/users.conf");

#[test]
fn a_worker_can_only_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path.display().to_string()
    };
    let users = USERS.replace("SERVER_PASSWORD", "one").replace("WORKER_PASSWORD", "two").replace("gears", "test");
    let config = file("nats.conf", &users);
    let Some(nats) = NatsServer::start_with(folder.path(), &["--config", &config]) else { return };
    let (one, two) = (file("server", "one\n"), file("worker", "two\n"));
    let url = nats.url();
    let program = Program::at(folder.path()).with(&["--queue", &url, "--space", "test"]);
    let program = program.with(&["--nats-user", "herringbone-server", "--nats-password-file", &one]);
    let service = program.start();
    let options = ["--space", "test", "--nats-user", "herringbone-worker", "--nats-password-file", &two];
    let worker = Worker::start(folder.path(), &url, &options);
    let mut contact = documents::mesh();
    contact["model"]["mesh_stiffness"] = serde_json::json!({"source": "ltca"});
    for document in [contact, documents::sweep(100), documents::response()] {
        let path = service.submit(&document);
        assert_eq!(service.ended(&path)["state"], "succeeded");
    }
    assert!(!worker.log().contains("Permissions Violation"), "{}", worker.log());
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(intrude(&url));
    assert!(service.end().0.success());
}

/// As a worker's user: what belongs to the service is refused.
async fn intrude(url: &str) {
    let (send, mut errors) = tokio::sync::mpsc::unbounded_channel();
    let options = async_nats::ConnectOptions::with_user_and_password("herringbone-worker".into(), "two".into());
    let options = options.event_callback(move |event| {
        let _ = send.send(event.to_string());
        async {}
    });
    let client = options.connect(url).await.expect("connected");
    for subject in [
        "hb.test.work.0_1_0-7.single",
        "hb.test.cancel",
        "$JS.API.CONSUMER.MSG.NEXT.HB_test_RESULT.store",
        "$JS.API.STREAM.PURGE.HB_test_WORK",
        "$JS.API.STREAM.INFO.HB_test_RESULT",
        "hb.other.result.1",
    ] {
        client.publish(subject, "".into()).await.expect("sent");
        expect_refusal(&mut errors, subject).await;
    }
    for subject in ["hb.test.result.>", "hb.test.work.>", "hb.>"] {
        let _refused = client.subscribe(subject).await.expect("sent");
        expect_refusal(&mut errors, subject).await;
    }
}

async fn expect_refusal(errors: &mut tokio::sync::mpsc::UnboundedReceiver<String>, subject: &str) {
    let refused = async {
        while let Some(event) = errors.recv().await {
            let event = event.to_lowercase();
            if event.contains("permissions violation") && event.contains(&subject.to_lowercase()) {
                return;
            }
        }
    };
    let refused = tokio::time::timeout(std::time::Duration::from_secs(10), refused).await;
    assert!(refused.is_ok(), "{subject} was not refused");
}
