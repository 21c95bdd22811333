//! From `POST …/cancel` to the state `canceled`.

use crate::documents;
use crate::times::Times;
use herringbone_tools::Failure;
use herringbone_tools::service::Service;
use serde_json::Value;
use std::time::{Duration, Instant};

const RUNS: usize = 20;

/// Name, stage to be in, document.
type Case = (&'static str, &'static str, fn() -> Value);

pub(crate) fn measure() -> Result<(), Failure> {
    let directory = tempfile::tempdir_in(".")?;
    let service = Service::start(&directory.path().join("cancel.db"), &[])?;
    let mut connection = service.connect()?;
    println!("| canceled while in | median of {RUNS} | longest |\n|---|---|---|");
    let stages: [Case; 6] = [
        ("finite elements (`fine`)", "mesh", documents::elements),
        ("contact (wide teeth, 200 slices, 1024 positions)", "mesh", documents::contact),
        ("contact (a face of 450 pitches)", "mesh", || documents::wide_contact(200.0)),
        ("response (10 million periods, one motion)", "response", || documents::integration(10_000_000)),
        ("sweep (100 000 periodic points)", "sweep", || documents::sweep(100_000)),
        ("sweep (integrated points, side by side)", "sweep", integrated_sweep),
    ];
    for (name, stage, document) in stages {
        let mut times = Times::default();
        for run in 0..RUNS {
            let path = connection.submit(&document())?;
            let job = connection
                .until(&path, Duration::from_millis(5), |job| job["stage"] == stage || job["ended_at"].is_string())?;
            if job["ended_at"].is_string() {
                return Err(format!("{name}: ended before it was canceled: {job}").into());
            }
            // At different moments of the stage.
            std::thread::sleep(Duration::from_millis(13 * run as u64));
            let began = Instant::now();
            connection.json("POST", &format!("{path}/cancel"), "")?;
            let job = connection.until(&path, Duration::from_millis(1), |job| job["ended_at"].is_string())?;
            if job["state"] != "canceled" {
                return Err(format!("{name}: {job}").into());
            }
            times.add(began.elapsed());
        }
        println!("| {name} | {:.0} ms | {:.0} ms |", times.ms(0.5), times.ms(1.0));
    }
    Ok(())
}

fn integrated_sweep() -> Value {
    let mut document = documents::sweep(1000);
    document["analysis"]["method"] = "integrate".into();
    document["analysis"]["mesh_periods"] = 100_000.into();
    document
}
