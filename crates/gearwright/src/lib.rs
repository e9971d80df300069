//! The gearwright application: case files in, result files out.
