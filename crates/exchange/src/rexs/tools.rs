//! Tools: the step of the manufacture that makes the root.

use super::model::Handle;
use super::pair::Pair;

fn generates(kind: &str) -> bool {
    matches!(kind, "rack_shaped_tool" | "cutter_wheel_tool")
}

/// The last generating tool of a gear: of its flanks' manufacturing steps; up to version 1.2, of the gear itself.
pub(super) fn tool_of(pair: &Pair, gear: Handle) -> Option<Handle> {
    let model = pair.model();
    let last = |steps: Vec<(Option<i64>, Handle)>| {
        let generating = steps.into_iter().filter(|(_, tool)| generates(model.kind(*tool)));
        // Of equal orders the last one in the file.
        generating.max_by_key(|(order, _)| order.unwrap_or(0)).map(|(_, tool)| tool)
    };
    let mut workpieces = pair.flanks(gear);
    workpieces.push(gear);
    let steps = workpieces.iter().flat_map(|workpiece| {
        model
            .relations_of(*workpiece)
            .filter(|relation| relation.kind == "manufacturing_step" && relation.role("workpiece") == Some(*workpiece))
            .filter_map(|relation| Some((relation.order, relation.role("tool")?)))
    });
    let references = || {
        workpieces.iter().flat_map(|workpiece| {
            model
                .relations_of(*workpiece)
                .filter(|relation| matches!(relation.kind.as_str(), "ordered_reference" | "reference"))
                .filter(|relation| relation.role("origin") == Some(*workpiece))
                .filter_map(|relation| Some((relation.order, relation.role("referenced")?)))
        })
    };
    last(steps.collect()).or_else(|| last(references().collect()))
}
