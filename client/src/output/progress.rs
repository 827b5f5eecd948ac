//! Moving progress on stderr: bytes of transfers, passes of jobs. Hidden, it costs nothing.

use std::{cell::RefCell, time::Duration};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Makes bars; hidden ones where stderr is no terminal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Progress {
    shown: bool,
}

impl Progress {
    pub(crate) fn new(shown: bool) -> Self {
        Self { shown }
    }

    fn bar(self, length: Option<u64>, template: &str) -> Bar {
        let target = if self.shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(length, target);
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        Bar { bar, pass: RefCell::default() }
    }

    /// A transfer of so many bytes.
    pub(crate) fn bytes(self, what: &str, total: u64) -> Bar {
        let template = format!("{what:>10} [{{bar:30}}] {{bytes}}/{{total_bytes}} {{bytes_per_sec}}");
        self.bar(Some(total), &template)
    }

    /// A job, pass by pass.
    pub(crate) fn passes(self) -> Bar {
        let bar = self.bar(Some(0), "{prefix:>10} [{bar:30}] {msg} {elapsed}");
        if self.shown {
            bar.bar.enable_steady_tick(Duration::from_millis(200));
        }
        bar
    }
}

/// One line of progress; it goes away when dropped.
pub(crate) struct Bar {
    bar: ProgressBar,
    pass: RefCell<String>,
}

impl Bar {
    pub(crate) fn advance(&self, by: u64) {
        self.bar.inc(by);
    }

    pub(crate) fn set(&self, position: u64) {
        self.bar.set_position(position);
    }

    pub(crate) fn queued(&self, position: u32) {
        self.bar.set_prefix("queued");
        self.bar.set_message(format!("{position} before this"));
    }

    pub(crate) fn pass(&self, name: &str, done: u64, total: u64) {
        if self.pass.replace(name.to_owned()) != name {
            self.bar.set_prefix(name.to_owned());
            self.bar.set_message("");
        }
        self.bar.set_length(total);
        self.bar.set_position(done);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
