//! Vibration signals and condition indicators for gear health monitoring.
