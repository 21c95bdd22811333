//! The sections of the form, in the order of the design process, and their blocks. The section of a field, its name,
//! range, unit, default and help come from its declaration in the job document.

/// A section of the form.
pub(super) struct GroupPlan {
    pub id: &'static str,
    pub title: &'static str,
    /// The title in the list of sections.
    pub short: &'static str,
    pub help: &'static str,
    pub open: bool,
    /// Summary in the heading while all fields have their defaults.
    pub nothing: &'static str,
    pub blocks: &'static [BlockPlan],
}

/// Block of fields under a common (perhaps empty) title: the fields of the section in one object (or in several side by
/// side), and in the objects in it that have no block of their own.
pub(super) struct BlockPlan {
    pub title: &'static str,
    /// Whether the block is collapsed at first.
    pub folded: bool,
    pub layout: LayoutPlan,
}

pub(super) enum LayoutPlan {
    /// Pointer of the object.
    Fields(&'static str),
    /// Several objects with the same fields side by side: heading and pointer of each.
    Table(&'static [(&'static str, &'static str)]),
    /// The objects of a list, as many as one wants.
    List(ListPlan),
}

/// A list of objects in the form.
#[derive(Clone, Copy)]
pub(super) struct ListPlan<P = &'static str> {
    /// Pointer of the list.
    pub pointer: P,
    /// What one of its objects is called, and what it is of.
    pub item: &'static str,
    pub of: &'static str,
    /// Each object is a block of fields; otherwise a row of a table.
    pub as_blocks: bool,
}

impl BlockPlan {
    /// Pointers of the block's objects.
    pub(super) fn objects(&self) -> Vec<&'static str> {
        match self.layout {
            LayoutPlan::Fields(object) => vec![object],
            LayoutPlan::Table(columns) => columns.iter().map(|(_, object)| *object).collect(),
            LayoutPlan::List(_) => Vec::new(),
        }
    }
}

const fn block(title: &'static str, object: &'static str) -> BlockPlan {
    BlockPlan { title, folded: false, layout: LayoutPlan::Fields(object) }
}

const fn list(title: &'static str, plan: ListPlan) -> BlockPlan {
    BlockPlan { title, folded: false, layout: LayoutPlan::List(plan) }
}

const fn folded(title: &'static str, columns: &'static [(&'static str, &'static str)]) -> BlockPlan {
    BlockPlan { title, folded: true, layout: LayoutPlan::Table(columns) }
}

const PAIR: BlockPlan = BlockPlan {
    title: "",
    folded: false,
    layout: LayoutPlan::Table(&[("Pinion", "/design/pinion"), ("Gear", "/design/gear")]),
};

const MATERIALS: &[(&str, &str)] = &[("Pinion", "/design/pinion/material"), ("Gear", "/design/gear/material")];

const FLANKS: &[(&str, &str)] = &[
    ("Pinion, left", "/design/pinion/left"),
    ("Pinion, right", "/design/pinion/right"),
    ("Gear, left", "/design/gear/left"),
    ("Gear, right", "/design/gear/right"),
];

const COAST: &[(&str, &str)] = &[("Pinion", "/design/pinion/coast"), ("Gear", "/design/gear/coast")];

const COAST_FLANKS: &[(&str, &str)] = &[
    ("Pinion, left", "/design/pinion/coast/left"),
    ("Pinion, right", "/design/pinion/coast/right"),
    ("Gear, left", "/design/gear/coast/left"),
    ("Gear, right", "/design/gear/coast/right"),
];

/// Pointer of the shafts; its field says which of them are given.
pub(super) const SHAFTS: &str = "/design/shafts";

/// Objects in the shafts with the choices of [`SHAFTS`] for which their fields are in use.
pub(super) const SHAFT_PARTS: [(&str, &str); 3] = [
    ("/design/shafts/arrangement", "arrangement pinion gear"),
    ("/design/shafts/pinion", "pinion given"),
    ("/design/shafts/gear", "gear given"),
];

/// The choices of [`SHAFTS`].
pub(super) const SHAFT_CHOICES: [(&str, &str); 5] = [
    ("", "none: the bodies stand on the supports"),
    ("arrangement", "from a few numbers"),
    ("given", "segment by segment"),
    ("pinion", "the pinion's by segments, the gear's from a few numbers"),
    ("gear", "the gear's by segments, the pinion's from a few numbers"),
];

const SEGMENTS: ListPlan =
    ListPlan { pointer: "/design/shafts/pinion/segments", item: "segment", of: "pinion", as_blocks: false };
const BEARINGS: ListPlan =
    ListPlan { pointer: "/design/shafts/pinion/bearings", item: "bearing", of: "pinion", as_blocks: true };
const BODIES: ListPlan =
    ListPlan { pointer: "/design/shafts/pinion/inertias", item: "body", of: "pinion", as_blocks: false };
const GEAR_SEGMENTS: ListPlan = ListPlan { pointer: "/design/shafts/gear/segments", of: "gear", ..SEGMENTS };
const GEAR_BEARINGS: ListPlan = ListPlan { pointer: "/design/shafts/gear/bearings", of: "gear", ..BEARINGS };
const GEAR_BODIES: ListPlan = ListPlan { pointer: "/design/shafts/gear/inertias", of: "gear", ..BODIES };

/// The list in the objects of another: the speeds in the table of a bearing.
pub(super) const INNER_ITEM: &str = "speed";

const DEFAULTS: &str = "as by default";

/// A section without a help text, with the default summary in its heading.
const fn section(id: &'static str, title: &'static str, open: bool, blocks: &'static [BlockPlan]) -> GroupPlan {
    GroupPlan { id, title, short: title, help: "", open, nothing: DEFAULTS, blocks }
}

pub(super) const GROUPS: &[GroupPlan] = &[
    section("job", "Job", true, &[block("", "")]),
    section(
        "gears",
        "Gears",
        true,
        &[
            block("", "/design"),
            PAIR,
            block("Material of both", "/design/material"),
            folded("Where the materials differ", MATERIALS),
        ],
    ),
    GroupPlan {
        short: "Widths",
        help: "Widths and angles are those of one half.",
        ..section("widths", "Widths and helix", true, &[block("", "/design"), PAIR])
    },
    GroupPlan {
        help: "Coefficients are multiples of the normal module.",
        ..section("tooth-form", "Tooth form", false, &[PAIR])
    },
    GroupPlan {
        help: "Amounts are material removed, in the transverse plane along the base tangent. They apply to both halves \
               unless a half says otherwise.",
        nothing: "none",
        ..section(
            "micro-geometry",
            "Micro-geometry",
            false,
            &[
                PAIR,
                folded("Where the halves differ", FLANKS),
                folded("Coast flanks (negative torque), where they differ", COAST),
                folded("Coast flanks, where the halves differ", COAST_FLANKS),
            ],
        )
    },
    GroupPlan {
        help: "Springs of each half, in place of shafts and bearings.",
        ..section("supports", "Supports", false, &[block("", "/design/supports")])
    },
    GroupPlan {
        short: "Shafts",
        help: "Elastic shafts on bearings, in place of the supports. Positions are measured from the left end of each shaft; the two are \
               aligned at their gear positions, the middle of the gap.",
        nothing: "none",
        ..section(
            "shafts",
            "Shafts and bearings",
            false,
            &[
                block("", SHAFTS),
                block("Arrangement", "/design/shafts/arrangement"),
                block("Shaft of the pinion", "/design/shafts/pinion"),
                list("Segments of the pinion's shaft, from left to right", SEGMENTS),
                list("Bearings of the pinion", BEARINGS),
                list("Further bodies on the pinion's shaft", BODIES),
                block("Shaft of the gear", "/design/shafts/gear"),
                list("Segments of the gear's shaft, from left to right", GEAR_SEGMENTS),
                list("Bearings of the gear", GEAR_BEARINGS),
                list("Further bodies on the gear's shaft", GEAR_BODIES),
            ],
        )
    },
    GroupPlan {
        short: "Assembly",
        nothing: "none",
        ..section("assembly", "Assembly errors", false, &[block("", "/design/assembly")])
    },
    section("operation", "Operation", true, &[block("", "/operation")]),
    GroupPlan {
        help: "One or two inputs that vary: give first and last value, or a list of values.",
        nothing: "no axis",
        ..section(
            "sweep",
            "Sweep",
            true,
            &[block("First axis", "/axes/0"), block("Second axis", "/axes/1"), block("", "")],
        )
    },
    section(
        "model",
        "Model",
        false,
        &[block("", "/model"), block("Mesh stiffness", "/model/mesh_stiffness"), block("Impact", "/model/impact")],
    ),
    section("analysis", "Analysis", false, &[block("", "/analysis")]),
];

/// Number of axes that a sweep can have.
pub(super) const AXES: usize = 2;
