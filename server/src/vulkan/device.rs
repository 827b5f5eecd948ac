//! A device that passed its self-test: opened by options, shared by everything made on it.

use std::{fmt, ops::Range, path::PathBuf, sync::Arc, sync::Mutex, sync::PoisonError};

use displace_glsl::ComputeShader;

use super::{
    batch::Batch,
    cache_file,
    error::{Error, Result},
    features,
    instance::Instance,
    memory::{Buffer, Memory, Place},
    pipeline::Pipelines,
    raw::{Raw, Timeline},
    recorder::{CancelSignal, PassObserver, Recorder},
    schedule::Rates,
    select::{self, Candidate, DeviceInfo, DeviceKind},
    self_test,
    stream::PAGE_SHIFT,
};

/// Bytes copied at a time where memory has to be staged.
const STAGING_BYTES: u64 = 16 << 20;
/// A descriptor of an empty stream: readable, all zero.
const EMPTY_BYTES: u64 = 256;

/// How to open a device. Use with `..Default::default()`.
#[derive(Clone, Debug)]
pub struct DeviceOptions {
    /// UUID, index or part of the name; without one the best device that passes.
    pub selector: Option<String>,
    /// Turns on the validation layers, with synchronization validation. Their errors fail the next submission.
    pub validation: bool,
    /// Folder for pipelines and verdicts of the self-test. Mesa keeps what it compiles elsewhere, see
    /// `keep_driver_cache_in`.
    pub cache_dir: Option<PathBuf>,
    /// Most device memory in use at a time.
    pub budget_bytes: u64,
    pub testing: Testing,
}

impl Default for DeviceOptions {
    fn default() -> Self {
        Self { selector: None, validation: false, cache_dir: None, budget_bytes: 4 << 30, testing: Testing::default() }
    }
}

/// Ways to reach on a software device what otherwise only GPUs or huge inputs reach.
#[derive(Clone, Debug, Default)]
pub struct Testing {
    /// Copies through staging memory even where device memory is the host's.
    pub force_staging: bool,
    /// Elements of a page, as a power of two; 22 if not set.
    pub page_shift: Option<u32>,
    /// Elements a thread handles where the pass allows for several; by the kind of device if not set.
    pub batch: Option<u32>,
    /// Has no 64-bit atomics, whatever the device can do.
    pub no_int64_atomics: bool,
}

/// Fields drop in order: what lies in memory before the memory, everything before the device.
pub struct Device {
    info: DeviceInfo,
    pipelines: Pipelines,
    timeline: Timeline,
    batches: Mutex<Vec<Batch>>,
    staging: Mutex<Vec<Buffer>>,
    rates: Mutex<Rates>,
    /// Bound for streams without elements.
    empty: Arc<Buffer>,
    memory: Arc<Memory>,
    raw: Arc<Raw>,
    page_shift: u32,
    int64_atomics: bool,
}

impl fmt::Debug for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Device({})", self.info)
    }
}

impl Device {
    /// Opens the device the options ask for, or the best one that has all features and passes the self-test.
    pub fn open(options: &DeviceOptions) -> Result<Arc<Self>> {
        let instance = Instance::new(options.validation)?;
        let mut refusals = Vec::new();
        for candidate in select::select(&instance, options.selector.as_deref())? {
            match Self::try_open(&instance, &candidate, options) {
                Ok(device) => return Ok(device),
                Err(error) => {
                    tracing::warn!(device = %candidate.info, %error, "a device cannot be used");
                    refusals.push(error);
                }
            }
        }
        Err(only_or_all(refusals))
    }

    #[must_use]
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// Bytes of device memory in use now.
    #[must_use]
    pub fn used_bytes(&self) -> u64 {
        self.memory.budget.used_bytes()
    }

    /// What the validation layers found wrong so far: nothing, if it is not on.
    #[must_use]
    pub fn validation_messages(&self) -> Vec<String> {
        self.raw.instance.messages.as_ref().map(|messages| messages.texts()).unwrap_or_default()
    }

    /// Starts recording a job.
    pub fn recorder<'a, C, P>(self: &Arc<Self>, cancel: &'a C, progress: &'a P) -> Recorder<'a>
    where
        C: CancelSignal + ?Sized,
        P: PassObserver + ?Sized,
    {
        Recorder::new(
            self,
            Box::new(|| cancel.is_cancelled()),
            Box::new(|name, done, total| progress.pass(name, done, total)),
        )
    }

    /// Makes the pipelines of these shaders and has the driver compile them, by running one group that does nothing.
    pub fn warm_up(self: &Arc<Self>, shaders: &[&'static ComputeShader]) -> Result<()> {
        let mut recorder = Recorder::new(self, Box::new(|| false), Box::new(|_, _, _| ()));
        for shader in shaders.iter().filter(|shader| self.uses(shader)) {
            recorder.warm_up(shader, false)?;
        }
        recorder.finish()?;
        self.pipelines.save();
        Ok(())
    }

    /// Whether its shaders may have 64-bit atomics.
    #[must_use]
    pub fn has_int64_atomics(&self) -> bool {
        self.int64_atomics
    }

    /// Of the two kinds of shaders that write keys of the visibility buffer, one.
    fn uses(&self, shader: &ComputeShader) -> bool {
        if self.int64_atomics { !shader.name.ends_with("_words") } else { !shader.needs_int64_atomics() }
    }

    fn try_open(instance: &Arc<Instance>, candidate: &Candidate, options: &DeviceOptions) -> Result<Arc<Self>> {
        if !candidate.info.missing.is_empty() {
            return Err(Error::unsupported(format!(
                "device {} lacks {}: update its driver or choose another with --device",
                candidate.info,
                candidate.info.missing.join(", ")
            )));
        }
        let device = Arc::new(Self::new(instance, candidate, options)?);
        self_test::require(&device, &candidate.identity, options.cache_dir.as_deref())?;
        Ok(device)
    }

    fn new(instance: &Arc<Instance>, candidate: &Candidate, options: &DeviceOptions) -> Result<Self> {
        let int64_atomics =
            !options.testing.no_int64_atomics && features::has_int64_atomics(instance, candidate.physical);
        let raw = Raw::new(instance, candidate, int64_atomics)?;
        let memory = Memory::new(&raw, options.budget_bytes, options.testing.force_staging)?;
        let file = options.cache_dir.as_deref();
        let file = file.map(|folder| cache_file::path(folder, "pipelines", &[candidate.identity.as_bytes()]));
        let page_shift = options.testing.page_shift.unwrap_or(PAGE_SHIFT).clamp(1, PAGE_SHIFT);
        let batch = options.testing.batch.unwrap_or_else(|| batch(candidate.info.kind)).max(1);
        let device = Self {
            info: candidate.info.clone(),
            pipelines: Pipelines::new(&raw, file, page_shift, batch)?,
            timeline: Timeline::new(&raw)?,
            batches: Mutex::default(),
            staging: Mutex::default(),
            rates: Mutex::default(),
            empty: Arc::new(Buffer::new(&memory, "empty", Place::Device, EMPTY_BYTES)?),
            memory,
            raw,
            page_shift,
            int64_atomics,
        };
        device.run_batch(|batch| batch.fill(&device.empty, 0))?;
        Ok(device)
    }

    pub(crate) fn memory(&self) -> &Arc<Memory> {
        &self.memory
    }

    pub(crate) fn pipelines(&self) -> &Pipelines {
        &self.pipelines
    }

    pub(crate) fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    pub(crate) fn rates(&self) -> std::sync::MutexGuard<'_, Rates> {
        self.rates.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn empty(&self) -> &Arc<Buffer> {
        &self.empty
    }

    pub(crate) fn page_shift(&self) -> u32 {
        self.page_shift
    }

    /// A batch ready to record, used before if there is one.
    pub(crate) fn take_batch(&self) -> Result<Batch> {
        let idle = self.batches.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.map_or_else(|| Batch::new(&self.raw), Ok)
    }

    /// Takes back a batch. One that cannot be reset is dropped.
    pub(crate) fn give_batch(&self, mut batch: Batch) {
        if batch.is_empty() || batch.reset().is_ok() {
            self.batches.lock().unwrap_or_else(PoisonError::into_inner).push(batch);
        }
    }

    /// Records and runs something at once.
    fn run_batch(&self, record: impl FnOnce(&mut Batch)) -> Result<()> {
        let mut batch = self.take_batch()?;
        batch.barrier();
        record(&mut batch);
        batch.run(&self.timeline)?;
        self.give_batch(batch);
        Ok(())
    }

    fn take_staging(&self) -> Result<Buffer> {
        let idle = self.staging.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.map_or_else(|| Buffer::new(&self.memory, "staging", Place::Staging, STAGING_BYTES), Ok)
    }

    fn give_staging(&self, buffer: Buffer) {
        self.staging.lock().unwrap_or_else(PoisonError::into_inner).push(buffer);
    }

    /// Fills `page` by `write(offset, bytes)`, called for successive ranges of whole elements.
    pub(crate) fn upload(
        &self,
        page: &mut Buffer,
        stride: u64,
        mut write: impl FnMut(u64, &mut [u8]) -> Result<()>,
    ) -> Result<()> {
        if self.memory.direct {
            return page.with_bytes_mut(|bytes| write(0, bytes))?;
        }
        for range in chunks(0..page.bytes, stride) {
            let mut staging = self.take_staging()?;
            let len = range.end - range.start;
            staging.with_bytes_mut(|bytes| write(range.start, &mut bytes[..len as usize]))??;
            self.run_batch(|batch| batch.copy((&staging, 0), (page, range.start), len))?;
            self.give_staging(staging);
        }
        Ok(())
    }

    /// Hands a range of a page to `read(offset, bytes)`, piece by piece.
    pub(crate) fn download(
        &self,
        page: &Buffer,
        range: Range<u64>,
        stride: u64,
        mut read: impl FnMut(u64, &[u8]) -> Result<()>,
    ) -> Result<()> {
        if self.memory.direct {
            return page.with_bytes(|bytes| read(range.start, &bytes[range.start as usize..range.end as usize]))?;
        }
        for range in chunks(range, stride) {
            let staging = self.take_staging()?;
            let len = range.end - range.start;
            self.run_batch(|batch| batch.copy((page, range.start), (&staging, 0), len))?;
            staging.with_bytes(|bytes| read(range.start, &bytes[..len as usize]))??;
            self.give_staging(staging);
        }
        Ok(())
    }
}

/// Elements a thread handles in the passes that allow for several. Software devices start a thread in the
/// time of a short element, GPUs want many threads.
fn batch(kind: DeviceKind) -> u32 {
    if kind == DeviceKind::Cpu { 8 } else { 1 }
}

/// Parts of a range that fit staging memory and hold whole elements.
fn chunks(range: Range<u64>, stride: u64) -> impl Iterator<Item = Range<u64>> {
    let step = STAGING_BYTES / stride * stride;
    let starts = (range.start..range.end).step_by(step as usize);
    starts.map(move |start| start..(start + step).min(range.end))
}

/// The one refusal, or all of them in one sentence.
fn only_or_all(mut refusals: Vec<Error>) -> Error {
    if refusals.len() == 1 {
        return refusals.remove(0);
    }
    let sentences: Vec<_> = refusals.iter().map(|error| error.message.as_str()).collect();
    Error::unsupported(format!("no device can be used: {}", sentences.join("; ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_hold_whole_elements_and_cover_the_range() {
        let parts: Vec<_> = chunks(24..40_000_008, 12).collect();
        assert!(parts.iter().all(|part| (part.start - 24) % 12 == 0 && part.end - part.start <= STAGING_BYTES));
        assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].start));
        assert_eq!((parts[0].start, parts[parts.len() - 1].end), (24, 40_000_008));
        assert_eq!(chunks(8..8, 4).count(), 0);
    }
}
