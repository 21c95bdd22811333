# Recipes of the daily work; `just` lists them. Each is a command of CONTRIBUTING.md.

# list the recipes
default:
    @just --list

# check one crate: physics, job, macros, oracle, tools; without a name the service
check crate='':
    cargo check --locked -p herringbone{{ if crate == '' { '' } else { '-' + crate } }}

# tests of one crate's library, filtered by name: `just test physics gear::`
test crate filter='':
    cargo test --locked -p herringbone-{{ crate }} --lib -- {{ filter }}

# tests of the HTTP interface, filtered by name: no browser
api filter='':
    cargo test --locked --test api -- {{ filter }}

# browser tests, filtered by name
browser filter='':
    scripts/test-browser {{ filter }}

# run the debug build of the service on 127.0.0.1:8080
run *arguments:
    cargo run --locked -- serve {{ arguments }}

# solve a document
solve document='examples/table1.json' *arguments:
    cargo run --release --locked -- solve {{ document }} {{ arguments }}

# formatting, comments, links, lints, page scripts, documentation
lint:
    .ci/run format comments links lint pages docs

# documentation of all crates, opened in a browser
docs:
    cargo doc --locked --workspace --no-deps --open

# everything that has to hold before a change lands, or some steps of it
ci *steps:
    .ci/run {{ steps }}

# write the OpenAPI document that the service serves
openapi:
    "$(scripts/program)" openapi > openapi/openapi.json

# run a program of tools/: `just tool contact_stress 500`
tool name *arguments:
    scripts/tool {{ name }} {{ arguments }}

# measure every oracle, write docs/validation/tables
validation:
    scripts/validation

# benchmarks of the physics and of whole jobs
bench:
    cargo bench -p herringbone-physics --bench contact --bench dynamics
    cargo bench -p herringbone-job --bench chain
