//! The bounds of a job over the corners of the ranges of its fields: work between two checkpoints, and memory.

use herringbone_job::document::JobDocument;
use herringbone_job::parse_value;
use herringbone_job::schema::field_descriptions;
use herringbone_job::study::{CheckedJob, SolveContext, SolveError, demand, solve};
use proptest::prelude::*;
use proptest::sample::{Index, select};
use rustix::time::{ClockId, clock_gettime};
use serde_json::{Value, json};
use std::cell::Cell;
use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Most computing time of one thread between two checkpoints. The invariant is 50 ms; this is a machine that is ten
/// times slower.
const LONGEST_GAP: Duration = Duration::from_millis(500);

/// Computing time of this thread.
fn thread_time() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec as u32)
}

thread_local! {
    /// Solve and computing time of the last checkpoint on this thread.
    static LAST: Cell<(u64, Duration)> = const { Cell::new((0, Duration::ZERO)) };
}

/// A solve that is canceled after so much computing time on all threads.
struct Recorder {
    solve: u64,
    budget: Duration,
    /// Computing time so far, and the longest between two checkpoints.
    spent: Mutex<(Duration, Duration)>,
}

impl Recorder {
    fn new(budget: Duration) -> Self {
        static SOLVES: Mutex<u64> = Mutex::new(0);
        let mut solves = SOLVES.lock().expect("no panic");
        *solves += 1;
        LAST.set((*solves, thread_time()));
        Self { solve: *solves, budget, spent: Mutex::default() }
    }

    /// Whether the solve is canceled.
    fn checkpoint(&self) -> bool {
        let now = thread_time();
        let (solve, before) = LAST.replace((self.solve, now));
        let gap = if solve == self.solve { now - before } else { Duration::ZERO };
        let mut spent = self.spent.lock().expect("no panic");
        *spent = (spent.0 + gap, spent.1.max(gap));
        spent.0 > self.budget
    }
}

/// Documents whose gears exist, each with much of what is costly.
fn bases() -> Vec<Value> {
    let example: Value = serde_json::from_str(include_str!("../../examples/table1.json")).expect("JSON");
    let with = |change: &dyn Fn(&mut Value)| {
        let mut document = example.clone();
        for gear in ["pinion", "gear"] {
            document["design"][gear].as_object_mut().expect("a gear").remove("bore_diameter_mm");
        }
        change(&mut document);
        document
    };
    let ltca = |document: &mut Value, members: Value| document["model"] = json!({"mesh_stiffness": members});
    // A thousand lines of contact.
    let wide = |document: &mut Value, fidelity: &str| {
        ltca(document, json!({"source": "ltca", "fidelity": fidelity, "elements": "coarse"}));
        document["design"]["normal_module_mm"] = json!(0.1);
        document["design"]["helix_angle_deg"] = json!(45.0);
        document["design"]["face_width_mm"] = json!(300.0);
        document["operation"]["pinion_torque_nm"] = json!(1.0);
    };
    vec![
        with(&|_| ()),
        with(&|document| ltca(document, json!({"source": "ltca"}))),
        with(&|document| ltca(document, json!({"source": "ltca", "fidelity": "fe", "elements": "coarse"}))),
        with(&|document| ltca(document, json!({"source": "ltca", "fidelity": "fe", "elements": "standard"}))),
        with(&|document| wide(document, "analytic")),
        with(&|document| wide(document, "uniform")),
        with(&|document| wide(document, "fe")),
        with(&|document| {
            ltca(document, json!({"source": "ltca"}));
            document["kind"] = json!("sweep");
            document["axes"] = json!([{"pointer": "/design/face_width_mm", "from": 20.0, "to": 2000.0, "points": 40}]);
        }),
        with(&|document| {
            document["analysis"] = json!({"method": "integrate", "mesh_periods": 100_000,
                "record_mesh_periods": 4000, "samples_per_mesh_period": 1000});
        }),
    ]
}

/// Sets up to six fields to the ends of their ranges.
fn corner_documents() -> BoxedStrategy<Value> {
    let fields: Vec<(String, Value)> = field_descriptions()
        .into_iter()
        .filter(|field| !field.pointer.starts_with("/axes"))
        .filter_map(|field| {
            let ends: Vec<Value> = match &field.schema["enum"] {
                Value::Array(words) => words.clone(),
                _ => [&field.schema["minimum"], &field.schema["maximum"]].into_iter().cloned().collect(),
            };
            let ends: Vec<Value> = ends.into_iter().filter(|end| !end.is_null()).collect();
            (!ends.is_empty()).then_some((field.pointer, Value::Array(ends)))
        })
        .collect();
    let changes = proptest::collection::vec((select(fields), any::<Index>()), 0..=6);
    (select(bases()), changes)
        .prop_map(|(mut document, changes)| {
            for ((pointer, ends), end) in changes {
                let ends = ends.as_array().expect("ends");
                set(&mut document, &pointer, ends[end.index(ends.len())].clone());
            }
            document
        })
        .boxed()
}

/// Sets a member and the objects above it.
fn set(document: &mut Value, pointer: &str, value: Value) {
    let mut place = document;
    for name in pointer.trim_start_matches('/').split('/') {
        if !place.is_object() {
            *place = json!({});
        }
        place = &mut place[name];
    }
    *place = value;
}

/// Threads of a solve.
const THREADS: usize = 2;
/// Memory limit above which a document is refused, MiB.
const MEMORY_MIB: f64 = 1024.0;

/// The job of a document whose gears exist, and its memory by the estimate, MiB; none above the limit.
fn accepted(value: &Value) -> Option<(CheckedJob, f64)> {
    let document: JobDocument = parse_value(value).ok()?;
    let estimate_mib = demand(&document, THREADS).total_mib();
    let job = CheckedJob::new(document).ok()?;
    (estimate_mib <= MEMORY_MIB).then_some((job, estimate_mib))
}

/// Time in which a solve is looked at.
const LONGEST_SOLVE: Duration = Duration::from_secs(4);
/// What every process takes, MiB.
const EVERY_PROCESS_MIB: f64 = 40.0;

/// Peak memory of `herringbone solve` in a process of its own, MiB, up to its end or for so long.
fn peak_mib(document: &Value, longest: Duration) -> f64 {
    let mut process = Command::new(env!("CARGO_BIN_EXE_herringbone"))
        .args(["solve", "-", "--table"])
        .env("RAYON_NUM_THREADS", THREADS.to_string())
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("a process");
    process.stdin.take().expect("input").write_all(document.to_string().as_bytes()).expect("written");
    let status = format!("/proc/{}/status", process.id());
    let (began, mut peak_kib) = (Instant::now(), 0.0f64);
    while process.try_wait().expect("a process").is_none() && began.elapsed() < longest {
        let status = std::fs::read_to_string(&status).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse().ok());
        peak_kib = peak_kib.max(kib.unwrap_or(0.0));
        std::thread::sleep(Duration::from_millis(5));
    }
    let _ = process.kill();
    process.wait().expect("it ends");
    peak_kib / 1024.0
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20, max_global_rejects: 100_000, ..ProptestConfig::default() })]

    /// Every thread of a solve looks often whether it is canceled, and comes to its end soon after.
    #[test]
    fn checkpoints_are_close(value in corner_documents(), budget_ms in 0_u64..2000) {
        let accepted = accepted(&value);
        prop_assume!(accepted.is_some());
        let (job, _) = accepted.expect("assumed");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(THREADS).stack_size(8 << 20).build().expect("threads");
        let (is_canceled, longest, last) = pool.install(|| {
            let recorder = Recorder::new(Duration::from_millis(budget_ms));
            let canceled = || recorder.checkpoint();
            let outcome = solve(&job, &SolveContext { canceled: &canceled, ..SolveContext::none() });
            let is_canceled = matches!(outcome, Err(SolveError::Canceled(_)));
            drop(outcome);
            let longest = recorder.spent.lock().expect("no panic").1;
            // From the checkpoint that canceled to the end, memory given back.
            let (solve, before) = LAST.get();
            (is_canceled, longest, if solve == recorder.solve { thread_time() - before } else { Duration::ZERO })
        });
        println!("canceled: {is_canceled}; longest {longest:?}, last {last:?}");
        prop_assert!(longest < LONGEST_GAP, "{:?} between two checkpoints", longest);
        prop_assert!(last < LONGEST_GAP, "{:?} after the last checkpoint", last);
    }

    /// The peak of a solve is within the estimate by which it was accepted.
    #[test]
    #[cfg(target_os = "linux")]
    fn memory_is_within_the_estimate(value in corner_documents()) {
        let accepted = accepted(&value);
        prop_assume!(accepted.is_some());
        let (_, estimate_mib) = accepted.expect("assumed");
        let peak_mib = peak_mib(&value, LONGEST_SOLVE);
        println!("estimate {estimate_mib:.0} MiB, peak {peak_mib:.0} MiB");
        prop_assert!(peak_mib > 1.0, "nothing was measured");
        prop_assert!(peak_mib <= estimate_mib + EVERY_PROCESS_MIB, "peak {} MiB, estimate {} MiB", peak_mib, estimate_mib);
    }
}
