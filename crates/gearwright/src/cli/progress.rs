//! Progress on the terminal: a bar where there is one, plain lines of stages otherwise.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use fecm::statics::Observer;
use indicatif::{ProgressBar, ProgressStyle};

use crate::run::RunObserver;

/// Shows progress on standard error.
pub struct Terminal {
    bar: Mutex<Option<ProgressBar>>,
    interactive: bool,
    stopped: Arc<AtomicBool>,
}

impl Terminal {
    /// A bar if standard error is a terminal. From now on, an interrupt (Ctrl-C) asks the run to stop and tidy up; a second one ends the
    /// program at once.
    pub fn new() -> Self {
        let stopped = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stopped);
        // Without a handler an interrupt simply ends the program.
        let _ = ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        });
        Self { bar: Mutex::new(None), interactive: std::io::stderr().is_terminal(), stopped }
    }

    /// Whether a signal has asked the run to stop.
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// Clears the bar.
    pub fn finish(&self) {
        if let Some(bar) = self.bar.lock().ok().and_then(|mut bar| bar.take()) {
            bar.finish_and_clear();
        }
    }
}

impl RunObserver for Terminal {
    fn stage(&self, name: &str) {
        self.finish();
        if !self.interactive {
            super::output::note(&format!("{name} ..."));
            return;
        }
        let style = ProgressStyle::with_template("{spinner} {msg} {wide_bar} {pos}/{len} {eta}");
        let bar = ProgressBar::new(0).with_message(name.to_owned());
        if let Ok(style) = style {
            bar.set_style(style);
        }
        bar.enable_steady_tick(std::time::Duration::from_millis(120));
        if let Ok(mut current) = self.bar.lock() {
            *current = Some(bar);
        }
    }
}

impl Observer for Terminal {
    fn is_cancelled(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    fn advanced(&self, done: usize, total: usize) {
        if let Ok(bar) = self.bar.lock()
            && let Some(bar) = bar.as_ref()
        {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        }
    }
}
