//! Compute pipelines, made from the shader table when first used and kept as long as the device.

use std::{
    collections::HashMap,
    ffi::CStr,
    path::PathBuf,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

use ash::vk;
use displace_glsl::ComputeShader;

use super::{
    cache_file,
    error::{Error, Result, failed},
    features::MAX_PUSH_CONSTANT_BYTES,
    raw::{DescriptorSetLayout, PipelineCacheHandle, PipelineHandle, PipelineLayout, Raw, ShaderModule},
    schedule::GROUP_THREADS,
};

const ENTRY_POINT: &CStr = c"main";

/// Specialisation constant of `batch.glsl`.
const BATCH_CONSTANT: u32 = 2;

/// A pipeline specialised for streams of one page, or of several.
pub(crate) struct Pipeline {
    pub(crate) shader: &'static ComputeShader,
    pub(crate) handle: PipelineHandle,
    pub(crate) layout: PipelineLayout,
    pub(crate) set_layout: DescriptorSetLayout,
    /// Elements a thread handles.
    pub(crate) batch: u32,
    /// Set once it has run: software drivers compile at the first dispatch.
    warm: AtomicBool,
}

impl Pipeline {
    pub(crate) fn is_warm(&self) -> bool {
        self.warm.load(Ordering::Acquire)
    }

    pub(crate) fn set_warm(&self) {
        self.warm.store(true, Ordering::Release);
    }

    /// Descriptors one set of this pipeline takes.
    pub(crate) fn descriptors(&self) -> u32 {
        self.shader.bindings.iter().map(|binding| binding.count).sum()
    }

    fn new(
        raw: &Arc<Raw>,
        cache: &PipelineCacheHandle,
        shader: &'static ComputeShader,
        constants: [u32; 3],
    ) -> Result<Self> {
        check_limits(raw, shader)?;
        let batch = if has_constant(shader.words, BATCH_CONSTANT) { constants[BATCH_CONSTANT as usize] } else { 1 };
        let module = shader_module(raw, shader)?;
        let set_layout = set_layout(raw, shader)?;
        let layout = pipeline_layout(raw, shader, &set_layout)?;
        let handle = pipeline(raw, cache, &module, &layout, constants)?;
        raw.name(handle.handle, shader.name);
        Ok(Self { shader, handle, layout, set_layout, batch, warm: AtomicBool::new(false) })
    }
}

/// Software drivers accept what GPUs refuse, so the limits every GPU has are checked here.
fn check_limits(raw: &Raw, shader: &ComputeShader) -> Result<()> {
    let descriptors: u32 = shader.bindings.iter().map(|binding| binding.count).sum();
    let allowed = raw.limits.max_per_stage_descriptor_storage_buffers;
    if shader.local_size != [GROUP_THREADS as u32, 1, 1] {
        return Err(Error::internal(format!("{}: local size {:?} is not [64, 1, 1]", shader.name, shader.local_size)));
    }
    if shader.push_constant_bytes > MAX_PUSH_CONSTANT_BYTES {
        let bytes = shader.push_constant_bytes;
        return Err(Error::internal(format!("{}: {bytes} bytes of push constants, above 128", shader.name)));
    }
    if descriptors > allowed {
        return Err(Error::unsupported(format!(
            "pass {} binds {descriptors} storage buffers, the device allows {allowed}",
            shader.name
        )));
    }
    Ok(())
}

/// True if SPIR-V declares the specialisation constant `id`.
fn has_constant(words: &[u32], id: u32) -> bool {
    const OP_DECORATE: u32 = 71;
    const SPEC_ID: u32 = 1;
    let mut rest = words.get(5..).unwrap_or_default();
    while let Some(first) = rest.first() {
        let instruction = &rest[..(first >> 16).clamp(1, rest.len() as u32) as usize];
        if first & 0xFFFF == OP_DECORATE && instruction.get(2..4) == Some(&[SPEC_ID, id]) {
            return true;
        }
        rest = &rest[instruction.len()..];
    }
    false
}

fn shader_module(raw: &Arc<Raw>, shader: &ComputeShader) -> Result<ShaderModule> {
    let info = vk::ShaderModuleCreateInfo::default().code(shader.words);
    // SAFETY: the words are SPIR-V made and checked by the build.
    let handle = unsafe { raw.device.create_shader_module(&info, None) }.map_err(failed("creating a shader module"))?;
    raw.name(handle, shader.name);
    Ok(ShaderModule::new(raw, handle))
}

fn set_layout(raw: &Arc<Raw>, shader: &ComputeShader) -> Result<DescriptorSetLayout> {
    let bindings: Vec<_> = shader
        .bindings
        .iter()
        .map(|binding| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding.binding)
                .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                .descriptor_count(binding.count)
                .stage_flags(vk::ShaderStageFlags::COMPUTE)
        })
        .collect();
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
    // SAFETY: `info` lives to the end of the call; binding numbers are distinct by reflection.
    let handle = unsafe { raw.device.create_descriptor_set_layout(&info, None) }
        .map_err(failed("creating a descriptor set layout"))?;
    Ok(DescriptorSetLayout::new(raw, handle))
}

fn pipeline_layout(raw: &Arc<Raw>, shader: &ComputeShader, set: &DescriptorSetLayout) -> Result<PipelineLayout> {
    let sets = [set.handle];
    let ranges =
        [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(shader.push_constant_bytes)];
    let ranges = if shader.push_constant_bytes == 0 { &ranges[..0] } else { &ranges[..] };
    let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets).push_constant_ranges(ranges);
    // SAFETY: the set layout is alive.
    let handle =
        unsafe { raw.device.create_pipeline_layout(&info, None) }.map_err(failed("creating a pipeline layout"))?;
    Ok(PipelineLayout::new(raw, handle))
}

fn pipeline(
    raw: &Arc<Raw>,
    cache: &PipelineCacheHandle,
    module: &ShaderModule,
    layout: &PipelineLayout,
    constants: [u32; 3],
) -> Result<PipelineHandle> {
    let entries =
        [0, 1, 2].map(|id| vk::SpecializationMapEntry::default().constant_id(id).offset(id * 4).size(size_of::<u32>()));
    let specialization = vk::SpecializationInfo::default().map_entries(&entries).data(bytemuck::bytes_of(&constants));
    let stage = vk::PipelineShaderStageCreateInfo::default()
        .stage(vk::ShaderStageFlags::COMPUTE)
        .module(module.handle)
        .name(ENTRY_POINT)
        .specialization_info(&specialization);
    let infos = [vk::ComputePipelineCreateInfo::default()
        .flags(vk::PipelineCreateFlags::DISPATCH_BASE)
        .stage(stage)
        .layout(layout.handle)];
    // SAFETY: all handles are alive, and `infos` lives to the end of the call.
    let made = unsafe { raw.device.create_compute_pipelines(cache.handle, &infos, None) };
    let handles = made.map_err(|(_, result)| failed("creating a compute pipeline")(result))?;
    handles
        .first()
        .map(|handle| PipelineHandle::new(raw, *handle))
        .ok_or_else(|| Error::internal("no pipeline was made"))
}

/// All pipelines of a device, and the driver's cache of them on disk.
pub(crate) struct Pipelines {
    made: Mutex<HashMap<(&'static str, bool), Arc<Pipeline>>>,
    cache: PipelineCacheHandle,
    file: Option<PathBuf>,
    /// What the file holds, so that nothing is written that is there already.
    stored: Mutex<Vec<u8>>,
    page_shift: u32,
    batch: u32,
    raw: Arc<Raw>,
}

impl Pipelines {
    pub(crate) fn new(raw: &Arc<Raw>, file: Option<PathBuf>, page_shift: u32, batch: u32) -> Result<Self> {
        let stored = file.as_deref().map(cache_file::read).unwrap_or_default();
        let info = vk::PipelineCacheCreateInfo::default().initial_data(&stored);
        // SAFETY: drivers check the header of the data, and the file is ours, whole, and named after driver and device.
        let handle =
            unsafe { raw.device.create_pipeline_cache(&info, None) }.map_err(failed("creating the pipeline cache"))?;
        Ok(Self {
            made: Mutex::default(),
            cache: PipelineCacheHandle::new(raw, handle),
            file,
            stored: Mutex::new(stored),
            page_shift,
            batch,
            raw: raw.clone(),
        })
    }

    /// The pipeline of `shader` for streams of one page or, `paged`, of several.
    pub(crate) fn get(&self, shader: &'static ComputeShader, paged: bool) -> Result<Arc<Pipeline>> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = made.get(&(shader.name, paged)) {
            return Ok(pipeline.clone());
        }
        let constants = [u32::from(paged), self.page_shift, self.batch];
        let pipeline = Arc::new(Pipeline::new(&self.raw, &self.cache, shader, constants)?);
        made.insert((shader.name, paged), pipeline.clone());
        Ok(pipeline)
    }

    /// Writes the driver's cache if it has grown. A failure costs time at the next start, nothing else.
    pub(crate) fn save(&self) {
        let Some(file) = &self.file else { return };
        // SAFETY: the cache is alive.
        let Ok(data) = (unsafe { self.raw.device.get_pipeline_cache_data(self.cache.handle) }) else { return };
        let mut stored = self.stored.lock().unwrap_or_else(PoisonError::into_inner);
        if data != *stored && cache_file::write(file, &data) {
            *stored = data;
        }
    }
}

impl Drop for Pipelines {
    fn drop(&mut self) {
        if !self.raw.is_abandoned() {
            self.save();
        }
    }
}

#[cfg(test)]
mod tests {
    use displace_glsl::SHADERS;

    use super::*;

    #[test]
    fn batched_shaders_are_known_by_their_constant() {
        assert!(has_constant(SHADERS.fill.words, BATCH_CONSTANT));
        assert!(!has_constant(SHADERS.selftest_groups.words, BATCH_CONSTANT));
        assert!(!has_constant(&[], 0) && !has_constant(&[0; 9], 0));
    }
}
