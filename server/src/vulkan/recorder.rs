//! Straight-line recording of a job: dispatches in order, one global barrier between them, cut into
//! submissions short enough to cancel, and measured.

use std::{sync::Arc, time::Instant};

use bytemuck::Pod;
use displace_glsl::{Binding, ComputeShader};

use super::{
    batch::{Batch, BindingWrites, Entry},
    device::Device,
    error::{Error, ErrorKind, Result},
    memory::Buffer,
    pipeline::Pipeline,
    schedule::{self, MAX_THREADS, SUBMISSION_NS},
    stream::Stream,
};

/// Asked between submissions whether to go on.
pub trait CancelSignal {
    fn is_cancelled(&self) -> bool;
}

/// Told after each submission how far each pass is.
pub trait PassObserver {
    /// `done` of `total` threads of the pass `name` have run.
    fn pass(&self, name: &str, done: u64, total: u64);
}

/// What a pass took, over all its dispatches.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// Name of the shader; `fill` for fills, `compile` for the making of pipelines.
    pub name: &'static str,
    pub ms: f64,
    /// Bytes of the streams bound: what the pass reads and writes at least once.
    pub bytes: u64,
}

/// Told the name of a pass, and how many of how many threads have run.
type Observe<'a> = Box<dyn Fn(&str, u64, u64) + 'a>;

/// Records and runs one job. Dropped without `finish`, it has run some prefix of what was recorded.
pub struct Recorder<'a> {
    device: Arc<Device>,
    cancelled: Box<dyn Fn() -> bool + 'a>,
    observe: Observe<'a>,
    /// Only absent once a run has failed or the recorder is finished.
    batch: Option<Batch>,
    /// Expected time of what the batch holds.
    pending_ns: f64,
    times: Vec<PassTime>,
}

impl<'a> Recorder<'a> {
    pub(crate) fn new(device: &Arc<Device>, cancelled: Box<dyn Fn() -> bool + 'a>, observe: Observe<'a>) -> Self {
        Self { device: device.clone(), cancelled, observe, batch: None, pending_ns: 0.0, times: Vec::new() }
    }

    /// Runs `shader` over `threads` threads. `params` are its push constants; `streams` are bound by the
    /// names the shader gives them, each once, all of them.
    pub fn dispatch<P: Pod>(
        &mut self,
        shader: &'static ComputeShader,
        threads: u64,
        params: &P,
        streams: &[(&str, &Stream)],
    ) -> Result<()> {
        check_params::<P>(shader, threads)?;
        let bound = bind(shader, streams)?;
        let writes = writes(&self.device, &bound);
        let bytes = bound.iter().map(|(_, stream)| stream.bytes()).sum();
        let paged = bound.iter().any(|(_, stream)| stream.pages().len() > 1);
        let pipeline = self.warm_up(shader, paged)?;
        let job = Job { pipeline, writes, params: bytemuck::bytes_of(params), threads, bytes };
        self.run_in_pieces(&job)
    }

    /// Fills a stream with one word.
    pub fn fill(&mut self, stream: &Stream, word: u32) -> Result<()> {
        for page in stream.pages() {
            let batch = self.batch(0)?;
            batch.barrier();
            batch.fill(page, word);
            batch.keep(std::slice::from_ref(page));
            self.pending_ns += page.bytes as f64 * 0.25; // 4 GB/s, slow on purpose
            self.flush_if_full()?;
        }
        Ok(())
    }

    /// Runs what is left, waits, and says what each pass took, in order of first use.
    pub fn finish(mut self) -> Result<Vec<PassTime>> {
        self.flush()?;
        Ok(std::mem::take(&mut self.times))
    }

    /// The pipeline of a shader, run once over no elements if that was never done: drivers that compile at
    /// the first dispatch do so here, where it is not taken for the time of the pass.
    pub(crate) fn warm_up(&mut self, shader: &'static ComputeShader, paged: bool) -> Result<Arc<Pipeline>> {
        let start = Instant::now();
        let pipeline = self.device.pipelines().get(shader, paged)?;
        if pipeline.is_warm() {
            return Ok(pipeline);
        }
        add(&mut self.times, "compile", start.elapsed().as_secs_f64() * 1e3, 0);
        let nothing = vec![0u8; shader.push_constant_bytes as usize];
        let writes =
            shader.bindings.iter().map(|binding| (binding.binding, padded(&self.device, binding, &[]))).collect();
        let batch = self.batch(pipeline.descriptors())?;
        batch.barrier();
        batch.bind(&pipeline, &writes, &nothing)?;
        batch.dispatch(0, 1, Entry { name: "compile", groups: 0, bytes: 0, done: 1, total: 1, ns: 0.0 });
        self.pending_ns += SUBMISSION_NS / 2.0;
        self.flush_if_full()?;
        Ok(pipeline)
    }

    fn run_in_pieces(&mut self, job: &Job<'_>) -> Result<()> {
        let name = job.pipeline.shader.name;
        let groups = schedule::groups_of(job.threads, job.pipeline.batch);
        let mut next = 0;
        while next < groups {
            let left_ns = SUBMISSION_NS - self.pending_ns;
            let take = self.device.rates().groups_within(name, left_ns).min(groups - next);
            let end = next + take;
            let done = (end * schedule::GROUP_THREADS * u64::from(job.pipeline.batch)).min(job.threads);
            let bytes = if next == 0 { job.bytes } else { 0 };
            let batch = self.batch(job.pipeline.descriptors())?;
            batch.barrier();
            batch.bind(&job.pipeline, &job.writes, job.params)?;
            batch.dispatch(next, end, Entry { name, groups: take, bytes, done, total: job.threads, ns: 0.0 });
            self.pending_ns += self.device.rates().estimate_ns(name, take);
            next = end;
            if next < groups { self.flush()? } else { self.flush_if_full()? }
        }
        Ok(())
    }

    /// The batch to record in, with room for one more dispatch.
    fn batch(&mut self, descriptors: u32) -> Result<&mut Batch> {
        if self.batch.as_ref().is_some_and(|batch| !batch.has_room(descriptors)) {
            self.flush()?;
        }
        if self.batch.is_none() {
            self.batch = Some(self.device.take_batch()?);
        }
        self.batch.as_mut().ok_or_else(|| Error::internal("no batch to record in"))
    }

    fn flush_if_full(&mut self) -> Result<()> {
        if self.pending_ns < 0.9 * SUBMISSION_NS { Ok(()) } else { self.flush() }
    }

    /// Runs what is recorded, unless the job was cancelled, and learns from it.
    fn flush(&mut self) -> Result<()> {
        self.check_cancelled()?;
        self.pending_ns = 0.0;
        let Some(mut batch) = self.batch.take() else { return Ok(()) };
        let entries = batch.run(self.device.timeline())?;
        self.device.give_batch(batch);
        for entry in entries {
            add(&mut self.times, entry.name, entry.ns * 1e-6, entry.bytes);
            self.device.rates().learn(entry.name, entry.groups, entry.ns);
            (self.observe)(entry.name, entry.done, entry.total);
        }
        self.check_cancelled()
    }

    fn check_cancelled(&self) -> Result<()> {
        if (self.cancelled)() {
            return Err(Error::new(ErrorKind::Cancelled, "the job was cancelled"));
        }
        Ok(())
    }
}

impl Drop for Recorder<'_> {
    fn drop(&mut self) {
        if let Some(batch) = self.batch.take() {
            self.device.give_batch(batch);
        }
    }
}

struct Job<'a> {
    pipeline: Arc<Pipeline>,
    writes: BindingWrites,
    params: &'a [u8],
    threads: u64,
    bytes: u64,
}

type Bound<'a> = Vec<(&'static Binding, &'a Stream)>;

fn check_params<P>(shader: &ComputeShader, threads: u64) -> Result<()> {
    if size_of::<P>() != shader.push_constant_bytes as usize {
        let (given, wanted) = (size_of::<P>(), shader.push_constant_bytes);
        return Err(Error::internal(format!("{}: {given} bytes of parameters, not {wanted}", shader.name)));
    }
    if threads > MAX_THREADS {
        return Err(Error::internal(format!("{}: {threads} threads, above {MAX_THREADS}", shader.name)));
    }
    Ok(())
}

/// Finds a stream for every binding, and a binding for every stream.
fn bind<'a>(shader: &'static ComputeShader, streams: &[(&str, &'a Stream)]) -> Result<Bound<'a>> {
    for (index, (name, _)) in streams.iter().enumerate() {
        let known = shader.bindings.iter().any(|binding| binding.name == *name);
        if !known || streams[..index].iter().any(|(earlier, _)| earlier == name) {
            return Err(Error::internal(format!("{}: '{name}' is not a binding, or given twice", shader.name)));
        }
    }
    shader.bindings.iter().map(|binding| Ok((binding, find(shader, binding, streams)?))).collect()
}

fn find<'a>(shader: &ComputeShader, binding: &Binding, streams: &[(&str, &'a Stream)]) -> Result<&'a Stream> {
    let found = streams.iter().find(|(name, _)| *name == binding.name).map(|(_, stream)| *stream);
    let stream =
        found.ok_or_else(|| Error::internal(format!("{}: nothing is bound to '{}'", shader.name, binding.name)))?;
    if stream.element_bytes() != binding.element_bytes {
        let (given, wanted) = (stream.element_bytes(), binding.element_bytes);
        return Err(Error::internal(format!(
            "{}: elements of '{}' have {wanted} bytes, those of stream '{}' {given}",
            shader.name,
            binding.name,
            stream.name()
        )));
    }
    if stream.pages().len() > binding.count as usize {
        return Err(Error::internal(format!(
            "{}: '{}' has more pages than the shader sees",
            shader.name, binding.name
        )));
    }
    let shared = streams.iter().filter(|(_, other)| !stream.is_empty() && std::ptr::eq(*other, stream)).count() > 1;
    if shared && binding.writable {
        return Err(Error::internal(format!("{}: '{}' is written and bound twice", shader.name, binding.name)));
    }
    Ok(stream)
}

/// Every descriptor of every array is written: pages first, an empty buffer for the rest.
fn writes(device: &Device, bound: &[(&'static Binding, &Stream)]) -> BindingWrites {
    bound.iter().map(|(binding, stream)| (binding.binding, padded(device, binding, stream.pages()))).collect()
}

fn padded(device: &Device, binding: &Binding, pages: &[Arc<Buffer>]) -> Vec<Arc<Buffer>> {
    let empty = std::iter::repeat(device.empty());
    pages.iter().chain(empty).take(binding.count as usize).cloned().collect()
}

fn add(times: &mut Vec<PassTime>, name: &'static str, ms: f64, bytes: u64) {
    match times.iter_mut().find(|time| time.name == name) {
        Some(time) => {
            time.ms += ms;
            time.bytes += bytes;
        }
        None => times.push(PassTime { name, ms, bytes }),
    }
}
