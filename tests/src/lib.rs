//! Cross-crate tests live in `tests/`; this library holds what they share, and runs the Rust of the documentation's pages.

#[cfg(doctest)]
#[doc = include_str!("../../docs/library.md")]
pub struct LibraryPage;
