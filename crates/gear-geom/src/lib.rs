//! Involute gear geometry: flanks, fillets, micro-geometry, landmarks and mesh kinematics.
