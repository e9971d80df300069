//! Development and study commands of the workspace (`cargo xtask help`).
fn main() {}
