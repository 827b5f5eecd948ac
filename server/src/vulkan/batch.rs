//! One command buffer with all it needs: recorded, submitted, waited for, measured, used again.

use std::sync::Arc;

use ash::vk;

use super::{
    error::{Error, Result, failed},
    memory::Buffer,
    pipeline::Pipeline,
    raw::{CommandPool, DescriptorPool, QueryPool, Raw, Timeline},
    schedule,
};

/// Measured pieces of work in a batch.
const MAX_ENTRIES: u32 = 128;
const MAX_SETS: u32 = 32;
const MAX_DESCRIPTORS: u32 = MAX_SETS * 16 * 8;

/// A piece of work and, once it has run, its time.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) name: &'static str,
    pub(crate) groups: u64,
    /// Bytes of the streams, counted with the first piece of a dispatch.
    pub(crate) bytes: u64,
    /// Threads of the dispatch done with this piece, and of all its pieces.
    pub(crate) done: u64,
    pub(crate) total: u64,
    pub(crate) ns: f64,
}

impl Entry {
    fn transfer(name: &'static str, bytes: u64) -> Self {
        Self { name, groups: 0, bytes, done: bytes, total: bytes, ns: 0.0 }
    }
}

/// Buffers to bind: binding number and one buffer for each descriptor of its array.
pub(crate) type BindingWrites = Vec<(u32, Vec<Arc<Buffer>>)>;

pub(crate) struct Batch {
    raw: Arc<Raw>,
    pool: CommandPool,
    command: vk::CommandBuffer,
    descriptors: DescriptorPool,
    queries: QueryPool,
    entries: Vec<Entry>,
    sets: u32,
    descriptors_used: u32,
    /// Everything the recorded commands use, until they have run.
    kept: Vec<Arc<Buffer>>,
    kept_pipelines: Vec<Arc<Pipeline>>,
}

impl Batch {
    pub(crate) fn new(raw: &Arc<Raw>) -> Result<Self> {
        let pool = command_pool(raw)?;
        let info = vk::CommandBufferAllocateInfo::default().command_pool(pool.handle).command_buffer_count(1);
        // SAFETY: the pool is alive and used by this thread alone.
        let commands = unsafe { raw.device.allocate_command_buffers(&info) }.map_err(failed("allocating commands"))?;
        let command = *commands.first().ok_or_else(|| Error::internal("no command buffer was made"))?;
        let mut batch = Self {
            raw: raw.clone(),
            pool,
            command,
            descriptors: descriptor_pool(raw)?,
            queries: query_pool(raw)?,
            entries: Vec::new(),
            sets: 0,
            descriptors_used: 0,
            kept: Vec::new(),
            kept_pipelines: Vec::new(),
        };
        batch.begin()?;
        Ok(batch)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Room for one more dispatch of `descriptors` descriptors.
    pub(crate) fn has_room(&self, descriptors: u32) -> bool {
        self.entries.len() < MAX_ENTRIES as usize
            && self.sets < MAX_SETS
            && self.descriptors_used + descriptors <= MAX_DESCRIPTORS
    }

    /// Makes everything done so far visible to what follows.
    pub(crate) fn barrier(&self) {
        self.memory_barrier(
            vk::PipelineStageFlags2::COMPUTE_SHADER | vk::PipelineStageFlags2::ALL_TRANSFER,
            vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE,
        );
    }

    /// Binds a pipeline, its streams and its parameters for the pieces that follow.
    pub(crate) fn bind(&mut self, pipeline: &Arc<Pipeline>, writes: &BindingWrites, params: &[u8]) -> Result<()> {
        let set = self.descriptor_set(pipeline)?;
        self.write_set(set, writes);
        let device = &self.raw.device;
        // SAFETY: the command buffer is being recorded; all handles are alive and kept below until it has
        // run; the sizes of the parameters were checked against the layout.
        unsafe {
            let point = vk::PipelineBindPoint::COMPUTE;
            device.cmd_bind_pipeline(self.command, point, pipeline.handle.handle);
            device.cmd_bind_descriptor_sets(self.command, point, pipeline.layout.handle, 0, &[set], &[]);
            if !params.is_empty() {
                let stages = vk::ShaderStageFlags::COMPUTE;
                device.cmd_push_constants(self.command, pipeline.layout.handle, stages, 0, params);
            }
        }
        self.kept_pipelines.push(pipeline.clone());
        self.kept.extend(writes.iter().flat_map(|(_, buffers)| buffers.iter().cloned()));
        Ok(())
    }

    /// Records groups `first..end` of what was bound last.
    pub(crate) fn dispatch(&mut self, first: u64, end: u64, entry: Entry) {
        self.measured(entry, |batch| {
            for piece in schedule::pieces(first, end) {
                let ([x, y], [columns, rows]) = (piece.base, piece.count);
                // SAFETY: a pipeline with the DISPATCH_BASE flag is bound; the counts are within every device's limits.
                unsafe { batch.raw.device.cmd_dispatch_base(batch.command, x, y, 0, columns, rows, 1) };
            }
        });
    }

    /// Records filling a buffer with one word. The buffer outlives the next `run`.
    pub(crate) fn fill(&mut self, buffer: &Buffer, word: u32) {
        self.measured(Entry::transfer("fill", buffer.bytes), |batch| {
            // SAFETY: the caller keeps the buffer until the commands have run; its size is a multiple of 4.
            unsafe { batch.raw.device.cmd_fill_buffer(batch.command, buffer.handle(), 0, vk::WHOLE_SIZE, word) };
        });
    }

    /// Records a copy of `bytes` bytes. Both buffers hold as many there, and outlive the next `run`.
    pub(crate) fn copy(&mut self, from: (&Buffer, u64), to: (&Buffer, u64), bytes: u64) {
        let regions = [vk::BufferCopy { src_offset: from.1, dst_offset: to.1, size: bytes }];
        self.measured(Entry::transfer("copy", bytes), |batch| {
            // SAFETY: the caller keeps both buffers until the commands have run and stays within them.
            unsafe { batch.raw.device.cmd_copy_buffer(batch.command, from.0.handle(), to.0.handle(), &regions) };
        });
    }

    /// Keeps buffers until the commands that use them have run.
    pub(crate) fn keep(&mut self, buffers: &[Arc<Buffer>]) {
        self.kept.extend_from_slice(buffers);
    }

    /// Submits, waits, reads the times, and is ready to record anew. Returns what ran.
    pub(crate) fn run(&mut self, timeline: &Timeline) -> Result<Vec<Entry>> {
        self.memory_barrier(vk::PipelineStageFlags2::HOST, vk::AccessFlags2::HOST_READ);
        // SAFETY: the command buffer is being recorded.
        unsafe { self.raw.device.end_command_buffer(self.command) }.map_err(failed("recording commands"))?;
        let entered = self.enter()?;
        let waited = self.raw.submit_and_wait(self.command, timeline);
        self.kept[..entered].iter().for_each(|buffer| buffer.access.leave_device());
        waited?;
        self.read_times()?;
        self.kept_pipelines.iter().for_each(|pipeline| pipeline.set_warm());
        let entries = std::mem::take(&mut self.entries);
        self.reset()?;
        Ok(entries)
    }

    /// Forgets what was recorded and begins anew. The last submission has ended.
    pub(crate) fn reset(&mut self) -> Result<()> {
        self.raw.check_alive()?;
        self.entries.clear();
        self.kept.clear();
        self.kept_pipelines.clear();
        (self.sets, self.descriptors_used) = (0, 0);
        // SAFETY: nothing recorded from these pools is in flight, since submissions are waited for.
        unsafe {
            let device = &self.raw.device;
            device
                .reset_command_pool(self.pool.handle, vk::CommandPoolResetFlags::empty())
                .map_err(failed("resetting commands"))?;
            device
                .reset_descriptor_pool(self.descriptors.handle, vk::DescriptorPoolResetFlags::empty())
                .map_err(failed("resetting descriptors"))?;
        }
        self.begin()
    }

    fn begin(&mut self) -> Result<()> {
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        let device = &self.raw.device;
        // SAFETY: the command buffer is in its initial state, and the pool of queries is not in use.
        unsafe {
            device.begin_command_buffer(self.command, &info).map_err(failed("recording commands"))?;
            device.cmd_reset_query_pool(self.command, self.queries.handle, 0, 2 * MAX_ENTRIES);
        }
        Ok(())
    }

    /// Tells every kept buffer that the device uses it; the number told.
    fn enter(&self) -> Result<usize> {
        for (index, buffer) in self.kept.iter().enumerate() {
            if let Err(error) = buffer.access.enter_device() {
                self.kept[..index].iter().for_each(|buffer| buffer.access.leave_device());
                return Err(error);
            }
        }
        Ok(self.kept.len())
    }

    fn measured(&mut self, entry: Entry, record: impl FnOnce(&mut Self)) {
        let query = 2 * self.entries.len() as u32;
        self.raw.label(self.command, entry.name);
        self.timestamp(query);
        record(self);
        self.timestamp(query + 1);
        self.entries.push(entry);
    }

    fn timestamp(&self, query: u32) {
        let stage = vk::PipelineStageFlags2::ALL_COMMANDS;
        // SAFETY: the query is below the size of the pool, since `has_room` was asked, and was reset at the beginning.
        unsafe { self.raw.device.cmd_write_timestamp2(self.command, stage, self.queries.handle, query) };
    }

    fn read_times(&mut self) -> Result<()> {
        let mut ticks = vec![0u64; 2 * self.entries.len()];
        if ticks.is_empty() {
            return Ok(());
        }
        // SAFETY: these queries were written by the submission that has ended.
        unsafe {
            let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
            self.raw.device.get_query_pool_results(self.queries.handle, 0, &mut ticks, flags)
        }
        .map_err(failed("reading timestamps"))?;
        for (entry, ticks) in self.entries.iter_mut().zip(ticks.chunks_exact(2)) {
            entry.ns = self.raw.nanoseconds(ticks[0], ticks[1]);
        }
        Ok(())
    }

    fn memory_barrier(&self, stages: vk::PipelineStageFlags2, access: vk::AccessFlags2) {
        let barriers = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::COMPUTE_SHADER | vk::PipelineStageFlags2::ALL_TRANSFER)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(stages)
            .dst_access_mask(access)];
        let info = vk::DependencyInfo::default().memory_barriers(&barriers);
        // SAFETY: the command buffer is being recorded; synchronization2 is enabled.
        unsafe { self.raw.device.cmd_pipeline_barrier2(self.command, &info) };
    }

    fn descriptor_set(&mut self, pipeline: &Pipeline) -> Result<vk::DescriptorSet> {
        let layouts = [pipeline.set_layout.handle];
        let info =
            vk::DescriptorSetAllocateInfo::default().descriptor_pool(self.descriptors.handle).set_layouts(&layouts);
        // SAFETY: pool and layout are alive, and the pool is used by this thread alone.
        let sets =
            unsafe { self.raw.device.allocate_descriptor_sets(&info) }.map_err(failed("allocating descriptors"))?;
        self.sets += 1;
        self.descriptors_used += pipeline.descriptors();
        sets.first().copied().ok_or_else(|| Error::internal("no descriptor set was made"))
    }

    fn write_set(&self, set: vk::DescriptorSet, writes: &BindingWrites) {
        let infos: Vec<Vec<_>> = writes
            .iter()
            .map(|(_, buffers)| {
                buffers
                    .iter()
                    .map(|buffer| vk::DescriptorBufferInfo {
                        buffer: buffer.handle(),
                        offset: 0,
                        range: vk::WHOLE_SIZE,
                    })
                    .collect()
            })
            .collect();
        let writes: Vec<_> = writes
            .iter()
            .zip(&infos)
            .map(|((binding, _), infos)| {
                vk::WriteDescriptorSet::default()
                    .dst_set(set)
                    .dst_binding(*binding)
                    .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                    .buffer_info(infos)
            })
            .collect();
        // SAFETY: the set is fresh, and the buffers are alive and of storage usage.
        unsafe { self.raw.device.update_descriptor_sets(&writes, &[]) };
    }
}

fn command_pool(raw: &Arc<Raw>) -> Result<CommandPool> {
    let info = vk::CommandPoolCreateInfo::default().queue_family_index(raw.family);
    // SAFETY: the family is the one the device was made with, here and in the next two.
    let handle = unsafe { raw.device.create_command_pool(&info, None) }.map_err(failed("creating a command pool"))?;
    Ok(CommandPool::new(raw, handle))
}

fn descriptor_pool(raw: &Arc<Raw>) -> Result<DescriptorPool> {
    let sizes = [vk::DescriptorPoolSize { ty: vk::DescriptorType::STORAGE_BUFFER, descriptor_count: MAX_DESCRIPTORS }];
    let info = vk::DescriptorPoolCreateInfo::default().max_sets(MAX_SETS).pool_sizes(&sizes);
    // SAFETY: see `command_pool`.
    let handle =
        unsafe { raw.device.create_descriptor_pool(&info, None) }.map_err(failed("creating a descriptor pool"))?;
    Ok(DescriptorPool::new(raw, handle))
}

fn query_pool(raw: &Arc<Raw>) -> Result<QueryPool> {
    let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2 * MAX_ENTRIES);
    // SAFETY: see `command_pool`.
    let handle = unsafe { raw.device.create_query_pool(&info, None) }.map_err(failed("creating a query pool"))?;
    Ok(QueryPool::new(raw, handle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vulkan::{Device, DeviceOptions, memory::Place};

    #[test]
    fn a_missing_barrier_fails_the_submission_when_validation_is_on() {
        let device = Device::open(&DeviceOptions { validation: true, ..Default::default() }).expect("a device");
        let buffer = Buffer::new(device.memory(), "racy", Place::Device, 64).expect("fits");
        let mut batch = device.take_batch().expect("made");
        batch.fill(&buffer, 1);
        batch.fill(&buffer, 2);
        let error = batch.run(device.timeline()).expect_err("is a hazard");
        assert!(error.message.contains("SYNC-HAZARD-WRITE"), "{error}");
        assert!(!device.validation_messages().is_empty());
    }
}
