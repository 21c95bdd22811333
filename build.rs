//! The migrations are embedded at compile time; cargo only looks at them again when told to.
fn main() {
    println!("cargo:rerun-if-changed=migrations");
}
