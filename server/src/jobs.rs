//! Jobs: admission, joining, cancellation, and the one thread that owns the device.
//!
//! A job's life: a handler turns a request into `Work`; `Jobs::submit` answers it from the store, joins it to
//! the same work under way, or admits it to the queue; the owner thread runs it, stores what it made, and
//! tells every listener. Not here: what work does (`displace`, `render`,
//! `compare`, `measure`, `chart`) and how it is asked for (`grpc`).

mod admission;
mod auto;
mod breakdown;
mod bumps;
mod calibration;
mod cautions;
mod chart;
mod compare;
mod displace;
mod exact;
mod fits;
mod images;
mod inputs;
mod job;
mod key;
mod lens;
mod levels;
mod looks;
mod measure;
mod normal_maps;
mod owner;
mod packing;
mod plans;
mod registry;
mod reliefs;
mod render;
mod seams;
mod sequence;
mod stability;
mod standard;
mod statistics;
mod strain;
mod work;

pub use chart::drawings as chart_drawings;
pub use job::{Finished, JobEvent, Listener};
pub use key::{BUILD_ID, ResultKey};
pub use owner::OpenExecutor;
pub use registry::{JobOptions, Jobs, Submission};
pub use standard::StandardRecipes;
pub use statistics::{Counters, KindTotals, Snapshot};
pub use work::{AssetReader, JobLimits, Output, Recipes, StoreReader, Work, WorkContext, WorkOutput};
