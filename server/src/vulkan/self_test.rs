//! Known answers every device has to give before it is used. Software drivers below Mesa 25 compute
//! wrongly without saying so, and the test decides, not the version.

use std::{
    collections::BTreeSet,
    path::Path,
    sync::{Arc, Mutex, PoisonError},
};

use bytemuck::{Pod, Zeroable};
use displace_glsl::{ComputeShader, SHADERS};

use super::{
    cache_file,
    device::Device,
    error::{Error, Result},
    recorder::Recorder,
    stream::Stream,
};

const PASSED: &[u8] = b"passed\n";
const ADVICE: &str = "install Mesa 25 or later (Debian 13, or the backports suite of Debian 12) or the driver of your GPU, or choose another device with --device";

/// Devices that have passed in this process, by the name of their verdict.
static PASSED_HERE: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// Fails unless the device gives all known answers, now or, with this very driver, before.
pub(crate) fn require(device: &Arc<Device>, identity: &str, cache_dir: Option<&Path>) -> Result<()> {
    let verdict = cache_file::path(cache_dir.unwrap_or(Path::new("")), "self-test", &depends_on(identity));
    let key = verdict.to_string_lossy().into_owned();
    let mut passed_here = PASSED_HERE.lock().unwrap_or_else(PoisonError::into_inner);
    if passed_here.contains(&key) || (cache_dir.is_some() && cache_file::read(&verdict) == PASSED) {
        return Ok(());
    }
    run(device)?;
    if cache_dir.is_some() {
        cache_file::write(&verdict, PASSED);
    }
    passed_here.insert(key);
    Ok(())
}

fn shaders() -> [&'static ComputeShader; 5] {
    [
        &SHADERS.selftest_loops,
        &SHADERS.selftest_atomics,
        &SHADERS.selftest_arithmetic,
        &SHADERS.selftest_bounds,
        &SHADERS.selftest_groups,
    ]
}

fn depends_on(identity: &str) -> Vec<&[u8]> {
    let words = shaders().into_iter().map(|shader| bytemuck::cast_slice(shader.words));
    std::iter::once(identity.as_bytes()).chain(words).collect()
}

fn run(device: &Arc<Device>) -> Result<()> {
    let mut recorder = Recorder::new(device, Box::new(|| false), Box::new(|_, _, _| ()));
    let loops = loops::record(device, &mut recorder)?;
    let atomics = device.has_int64_atomics().then(|| atomics::record(device, &mut recorder)).transpose()?;
    let arithmetic = arithmetic::record(device, &mut recorder)?;
    let bounds = bounds::record(device, &mut recorder)?;
    let groups = groups::record(device, &mut recorder)?;
    recorder.finish()?;
    let verdicts = [
        ("it cuts long loops short", loops::passes(&loops.read()?)),
        (
            "its 64-bit atomics are wrong",
            atomics.map_or(Ok(true), |words| words.read().map(|words| atomics::passes(&words)))?,
        ),
        ("its f32 arithmetic is wrong", arithmetic::passes(&arithmetic.read()?)),
        ("reads or writes past the end of a buffer are not contained", bounds::passes(&bounds.read()?)),
        ("it numbers the threads of a dispatch wrongly", groups::threads_pass(&groups.numbers.read()?)),
        ("its subgroups do not partition a workgroup", groups::subgroups_pass(&groups.mappings.read()?)),
    ];
    let failed: Vec<_> = verdicts.iter().filter(|(_, passes)| !passes).map(|(fault, _)| *fault).collect();
    if failed.is_empty() {
        return Ok(());
    }
    Err(Error::unsupported(format!("device {} fails its self-test: {}; {ADVICE}", device.info(), failed.join(", "))))
}

mod loops {
    use super::*;

    const THREADS: u32 = 8;
    const SINGLE: u32 = 70_000;
    const OUTER: u32 = 300;
    const INNER: u32 = 250;

    pub(super) fn record(device: &Arc<Device>, recorder: &mut Recorder<'_>) -> Result<Stream> {
        let results = Stream::new(device, "self-test loops", 4, u64::from(THREADS))?;
        let params = [THREADS, SINGLE, OUTER, INNER];
        recorder.dispatch(&SHADERS.selftest_loops, u64::from(THREADS), &params, &[("results", &results)])?;
        Ok(results)
    }

    pub(super) fn passes(results: &[u32]) -> bool {
        results.iter().zip(0..THREADS).all(|(result, thread)| *result == expected(thread))
    }

    fn expected(thread: u32) -> u32 {
        let advance = |state: u32| state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let state = (0..SINGLE).fold(thread, |state, _| advance(state));
        (0..OUTER).fold(state, |state, j| (0..INNER).fold(state, |state, _| advance(state) ^ j))
    }
}

mod atomics {
    use super::*;

    const THREADS: u32 = 1024;

    pub(super) fn record(device: &Arc<Device>, recorder: &mut Recorder<'_>) -> Result<Stream> {
        let words = Stream::from_slice(device, "self-test atomics", &[0u64, u64::MAX, 0])?;
        recorder.dispatch(&SHADERS.selftest_atomics, u64::from(THREADS), &[THREADS], &[("words", &words)])?;
        Ok(words)
    }

    pub(super) fn passes(words: &[u64]) -> bool {
        let keys = || (0..THREADS).map(|i| u64::from(i.wrapping_mul(2_654_435_761)) << 32 | u64::from(i));
        let sum = (0..THREADS).map(|i| u64::from(u32::MAX) + u64::from(i)).sum();
        words == [sum, keys().min().unwrap_or(0) + 1, keys().max().unwrap_or(0)]
    }
}

mod arithmetic {
    use super::*;

    #[repr(C)]
    #[derive(Clone, Copy, Pod, Zeroable)]
    pub(super) struct Answer {
        sum: f32,
        product: f32,
        chained: f32,
        quotient: f32,
        root: f32,
        floored: f32,
        truncated: i32,
        sine: f32,
    }

    /// Numbers of all magnitudes that passes meet, with full mantissas.
    fn operands() -> Vec<[f32; 3]> {
        let mut state = 1u32;
        let mut next = |scale: f32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state as f32 / 2_147_483_648.0 - 1.0 + 1e-3) * scale
        };
        let scales = [1e-6, 1e-2, 1.0, 3.7, 1e3];
        scales
            .iter()
            .flat_map(|scale| (0..32).map(|_| [next(*scale), next(1.7), next(300.0)]).collect::<Vec<_>>())
            .collect()
    }

    pub(super) fn record(device: &Arc<Device>, recorder: &mut Recorder<'_>) -> Result<Stream> {
        let operands = operands();
        let count = operands.len() as u32;
        let inputs = Stream::from_slice(device, "self-test operands", &operands)?;
        let answers = Stream::new(device, "self-test answers", size_of::<Answer>() as u32, u64::from(count))?;
        let streams = [("operands", &inputs), ("answers", &answers)];
        recorder.dispatch(&SHADERS.selftest_arithmetic, u64::from(count), &[count], &streams)?;
        Ok(answers)
    }

    pub(super) fn passes(answers: &[Answer]) -> bool {
        operands().iter().zip(answers).all(|(operands, answer)| is_right(*operands, answer))
    }

    /// Vulkan wants sums and products rounded right, quotients within 2.5 units in the last place.
    fn is_right([a, b, c]: [f32; 3], answer: &Answer) -> bool {
        let near = |x: f32, y: f32, ulps: f32| (x - y).abs() <= ulps * f32::EPSILON * y.abs();
        answer.sum == a + b
            && answer.product == a * b
            && answer.chained == a * b + c
            && near(answer.quotient, a / b, 2.5)
            && near(answer.root, a.abs().sqrt(), 4.0)
            && answer.floored == c.floor()
            && answer.truncated == c as i32
            && (answer.sine - c.sin()).abs() < 2e-3
    }
}

mod bounds {
    use super::*;

    const VALUES: [u32; 4] = [11, 12, 13, 14];
    const INDICES: [u32; 8] = [0, 3, 4, 5, 1000, 70_000, 1 << 20, 1 << 27];

    pub(super) fn record(device: &Arc<Device>, recorder: &mut Recorder<'_>) -> Result<Stream> {
        let count = INDICES.len() as u32;
        let values = Stream::from_slice(device, "self-test values", &VALUES)?;
        let indices = Stream::from_slice(device, "self-test indices", &INDICES)?;
        let results = Stream::new(device, "self-test results", 4, u64::from(count))?;
        let streams = [("values", &values), ("indices", &indices), ("results", &results)];
        recorder.dispatch(&SHADERS.selftest_bounds, u64::from(count), &[count], &streams)?;
        Ok(results)
    }

    pub(super) fn passes(results: &[u32]) -> bool {
        results == INDICES.map(|index| VALUES.get(index as usize).copied().unwrap_or(0))
    }
}

mod groups {
    use super::*;
    use crate::vulkan::schedule::{GROUP_THREADS, ROW_GROUPS};

    /// More than a row, so that pieces start within rows and beyond the first.
    const THREADS: u64 = (ROW_GROUPS + 1) * GROUP_THREADS + 7;
    const MAPPED: u64 = 4 * GROUP_THREADS;

    #[repr(C)]
    #[derive(Clone, Copy, Pod, Zeroable)]
    pub(super) struct Mapping {
        subgroup: u32,
        lane: u32,
        subgroups: u32,
        elected: u32,
    }

    pub(super) struct Streams {
        pub(super) numbers: Stream,
        pub(super) mappings: Stream,
    }

    pub(super) fn record(device: &Arc<Device>, recorder: &mut Recorder<'_>) -> Result<Streams> {
        let numbers = Stream::new(device, "self-test numbers", 4, THREADS)?;
        let mappings = Stream::new(device, "self-test subgroups", size_of::<Mapping>() as u32, MAPPED)?;
        let streams = [("numbers", &numbers), ("mappings", &mappings)];
        recorder.dispatch(&SHADERS.selftest_groups, THREADS, &[THREADS as u32, MAPPED as u32], &streams)?;
        Ok(Streams { numbers, mappings })
    }

    pub(super) fn threads_pass(numbers: &[u32]) -> bool {
        numbers.iter().zip(1..).all(|(number, expected)| *number == expected)
    }

    /// In each workgroup every thread has a place of its own, and each subgroup elects one thread.
    pub(super) fn subgroups_pass(mappings: &[Mapping]) -> bool {
        mappings.chunks(GROUP_THREADS as usize).all(|group| {
            let subgroups = group[0].subgroups;
            let places: BTreeSet<_> = group.iter().map(|thread| (thread.subgroup, thread.lane)).collect();
            let elected = group.iter().filter(|thread| thread.elected == 1).count();
            places.len() == group.len()
                && elected == subgroups as usize
                && group.iter().all(|thread| thread.subgroups == subgroups && thread.subgroup < subgroups)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_cut_at_65_535_iterations_are_noticed() {
        let advance = |state: u32| state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let cut: Vec<u32> = (0..8).map(|thread| (0..65_535).fold(thread, |state, _| advance(state))).collect();
        assert!(!loops::passes(&cut));
    }

    #[test]
    fn reads_that_wrap_around_are_noticed() {
        assert!(bounds::passes(&[11, 14, 0, 0, 0, 0, 0, 0]));
        assert!(!bounds::passes(&[11, 14, 0, 0, 0, 0, 0, 11]));
    }

    #[test]
    fn a_lost_atomic_or_a_misnumbered_thread_is_noticed() {
        assert!(!atomics::passes(&[0, 0, 0]));
        assert!(groups::threads_pass(&[1, 2, 3]));
        assert!(!groups::threads_pass(&[1, 2, 2]));
    }
}
