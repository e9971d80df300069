//! Lumped-parameter dynamics of a gear pair with contact loss.
