//! Command line of gearwright.
fn main() {}
