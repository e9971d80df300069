//! Finite elements of a housing, and its reduction to an [`ElasticBody`](crate::elastic::ElasticBody).
