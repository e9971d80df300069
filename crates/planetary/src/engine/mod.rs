//! Bodies and connections of a transmission, put together.
