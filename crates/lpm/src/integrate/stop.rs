//! A question asked during long computations: whether to stop.

use std::fmt;

/// Whether a computation is to stop; by default never. A stopped one ends with [`crate::LpmError::Stopped`].
#[derive(Clone, Copy, Default)]
pub struct Stop<'a>(Option<&'a (dyn Fn() -> bool + Sync)>);

impl<'a> Stop<'a> {
    /// Stops once `asked` returns true; it is called from the thread that computes.
    #[must_use]
    pub fn when(asked: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self(Some(asked))
    }

    pub(crate) fn is_requested(&self) -> bool {
        self.0.is_some_and(|asked| asked())
    }
}

impl fmt::Debug for Stop<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Stop(when asked)" } else { "Stop(never)" })
    }
}

/// Options are compared by what they compute: a question does not change it.
impl PartialEq for Stop<'_> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
