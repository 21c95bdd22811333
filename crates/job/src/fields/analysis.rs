//! The operating point, and accuracy and method of the analysis.

use super::{MAX_SERIES_SAMPLES, conflict, number};
use crate::document::*;
use crate::reader::Object;
use crate::violation::Violation;

pub(super) fn operation(object: Object) -> OperationInput {
    let operation = OperationInput {
        pinion_speed_rpm: object
            .number("pinion_speed_rpm", number(0.1, 200_000.0, "r/min", None, "Speed of the pinion.")),
        pinion_torque_nm: object.number(
            "pinion_torque_nm",
            number(
                -1e7,
                1e7,
                "N m",
                None,
                "Torque of the whole pinion (both halves); negative: the gear drives, on the coast flanks.",
            ),
        ),
        rotation: object.choice(
            "rotation",
            &[("apex_leading", Rotation::ApexLeading), ("apex_trailing", Rotation::ApexTrailing)],
            Rotation::ApexLeading,
            "apex_leading",
            "Which ends of the teeth enter the mesh first: the inner (apex_leading) or the outer ones.",
        ),
    };
    object.finish();
    operation
}

pub(super) fn analysis(object: Object) -> AnalysisInput {
    let analysis = AnalysisInput {
        accuracy: object.number(
            "accuracy",
            number(
                1e-12,
                1e-2,
                "1",
                Some(1e-6),
                "Relative error of the reported RMS values that the solver has to reach.",
            ),
        ),
        method: object.choice(
            "method",
            &[("auto", MethodInput::Auto), ("periodic", MethodInput::Periodic), ("integrate", MethodInput::Integrate)],
            MethodInput::Auto,
            "auto",
            "auto (the cheapest that is right), periodic, or integrate from the initial state.",
        ),
        integrator: object.choice(
            "integrator",
            &[("taylor", IntegratorInput::Taylor), ("runge_kutta_4", IntegratorInput::RungeKutta4)],
            IntegratorInput::Taylor,
            "taylor",
            "Time integration: event-exact Taylor series, or the variable-step fourth-order Runge-Kutta of the source.",
        ),
        mesh_periods: object.integer("mesh_periods", 1, 10_000_000, Some(300), "Mesh periods to integrate.") as u32,
        record_mesh_periods: object.integer(
            "record_mesh_periods",
            1,
            100_000,
            Some(100),
            "Last mesh periods of them that are recorded.",
        ) as u32,
        samples_per_mesh_period: object.integer(
            "samples_per_mesh_period",
            8,
            4096,
            Some(256),
            "Samples per mesh period of each series.",
        ) as u32,
        channels: object.texts("channels", 64, None, "Channels to record as series, such as a_x_left; all when null."),
        initial_state: object.numbers(
            "initial_state",
            24,
            24,
            number(-1e6, 1e6, "SI", None, "12 displacements in the source's order (m, rad), then 12 velocities."),
        ),
    };
    if analysis.record_mesh_periods > analysis.mesh_periods && object.has("record_mesh_periods") {
        let detail = format!(
            "is {}; permitted: 1 to mesh_periods, which is {}",
            analysis.record_mesh_periods, analysis.mesh_periods
        );
        object.reading().violate(Violation::new(object.pointer_to("record_mesh_periods"), "conflict", detail));
    }
    let samples = u64::from(analysis.record_mesh_periods) * u64::from(analysis.samples_per_mesh_period);
    if samples > MAX_SERIES_SAMPLES {
        let detail = format!(
            "times record_mesh_periods gives {samples} samples per channel; permitted: at most {MAX_SERIES_SAMPLES}"
        );
        object.reading().violate(Violation::new(object.pointer_to("samples_per_mesh_period"), "conflict", detail));
    }
    if analysis.initial_state.is_some() && analysis.method != MethodInput::Integrate {
        conflict(&object, "initial_state", "needs method \"integrate\"");
    }
    object.finish();
    AnalysisInput { record_mesh_periods: analysis.record_mesh_periods.min(analysis.mesh_periods), ..analysis }
}
