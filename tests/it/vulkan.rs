//! The device layer, from outside: dispatches of all sizes, paging, cancelling, budgets, staging,
//! and that nothing of it displeases the validation layers.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use displace_glsl::{ALL_SHADERS, SHADERS, layout::FillParams};
use displace_server::{
    domain::cancel::{Cancel, NoProgress, Progress},
    vulkan::{CancelSignal, Device, DeviceOptions, ErrorKind, Stream, Testing, list_devices},
};

/// For jobs nobody cancels.
struct Never;

impl CancelSignal for Never {
    fn is_cancelled(&self) -> bool {
        false
    }
}

fn open(options: DeviceOptions) -> Arc<Device> {
    Device::open(&options).expect("a Vulkan device that passes its self-test; run deploy/setup to install one")
}

fn validated(testing: Testing) -> Arc<Device> {
    open(DeviceOptions { validation: true, testing, ..Default::default() })
}

/// Numbers `threads` elements from 1, by one thread each.
fn number(device: &Arc<Device>, threads: u64) -> Stream {
    let numbers = Stream::new(device, "numbers", 4, threads).expect("fits");
    let none = Stream::new(device, "none", 16, 0).expect("fits");
    let mut recorder = device.recorder(&Never, &NoProgress);
    let streams = [("numbers", &numbers), ("mappings", &none)];
    recorder.dispatch(&SHADERS.selftest_groups, threads, &[threads as u32, 0], &streams).expect("dispatches");
    recorder.finish().expect("runs");
    numbers
}

fn assert_numbered(device: &Arc<Device>, threads: u64) {
    let numbers = number(device, threads);
    let mut expected = 1u32;
    numbers
        .read_pages(0..threads, |first, found: &[u32]| {
            assert_eq!(first + 1, u64::from(expected));
            for number in found {
                assert_eq!(*number, expected, "of {threads}");
                expected += 1;
            }
        })
        .expect("reads");
    assert_eq!(u64::from(expected), threads + 1);
}

#[test]
fn every_thread_runs_once_whatever_their_number() {
    let device = validated(Testing::default());
    for threads in [0, 1, 63, 64, 65, 4095, 4096 * 64, 4096 * 64 + 1, 1_000_003, (1 << 22) + 77] {
        assert_numbered(&device, threads);
    }
    assert_eq!(device.validation_messages(), [""; 0]);
}

#[test]
fn small_pages_give_the_same_numbers_as_large_ones() {
    let device = validated(Testing { page_shift: Some(8), ..Default::default() });
    for threads in [1, 255, 256, 257, 4095, 4096] {
        assert_numbered(&device, threads);
    }
    let refused = Stream::new(&device, "too long", 4, 4097).expect_err("17 pages");
    assert_eq!(refused.kind, ErrorKind::OutOfMemory);
    assert!(refused.message.contains("at most 4096"), "{}", refused.message);
}

#[test]
fn reads_past_the_pages_of_a_stream_give_zero() {
    let device = validated(Testing { page_shift: Some(4), ..Default::default() });
    let values: Vec<u32> = (1..=40).collect();
    let indices = [0, 15, 16, 39, 40, 47, 48, 255, 1 << 20, u32::MAX - 16];
    let values = Stream::from_slice(&device, "values", &values).expect("fits");
    let wanted = Stream::from_slice(&device, "indices", &indices).expect("fits");
    let results = Stream::new(&device, "results", 4, indices.len() as u64).expect("fits");
    let mut recorder = device.recorder(&Never, &NoProgress);
    let streams = [("values", &values), ("indices", &wanted), ("results", &results)];
    recorder
        .dispatch(&SHADERS.selftest_bounds, indices.len() as u64, &[indices.len() as u32], &streams)
        .expect("dispatches");
    recorder.finish().expect("runs");
    let results: Vec<u32> = results.read().expect("reads");
    assert_eq!(results[..8], [1, 16, 17, 40, 0, 0, 0, 0]);
}

#[test]
fn staged_copies_carry_what_mapped_ones_do() {
    let device = validated(Testing { force_staging: true, ..Default::default() });
    let numbers: Vec<u32> = (0..5_000_001).collect();
    let stream = Stream::from_slice(&device, "numbers", &numbers).expect("fits");
    assert!(stream.read::<u32>().expect("reads") == numbers);
    assert_eq!(stream.read_range::<u32>(4_194_300..4_194_310).expect("reads"), numbers[4_194_300..4_194_310]);
    let triples: Vec<[u32; 3]> = (0..2_000_000).map(|i| [i, i + 1, i + 2]).collect();
    let stream = Stream::from_slice(&device, "triples", &triples).expect("fits");
    assert!(stream.read::<[u32; 3]>().expect("reads") == triples);
    assert_eq!(stream.read::<u32>().expect("reads parts").len(), 6_000_000);
    assert_numbered(&device, 100_000);
    assert_eq!(device.validation_messages(), [""; 0]);
}

#[test]
fn fills_and_dispatches_see_each_others_results() {
    let device = validated(Testing::default());
    let words = Stream::new(&device, "words", 4, 1000).expect("fits");
    let mut recorder = device.recorder(&Never, &NoProgress);
    recorder.fill(&words, 7).expect("fills");
    let params = FillParams { count: 400, value: 8 };
    recorder.dispatch(&SHADERS.fill, 1000, &params, &[("words", &words)]).expect("dispatches");
    let times = recorder.finish().expect("runs");
    let expected: Vec<u32> = (0..1000).map(|i| if i < 400 { 8 } else { 7 }).collect();
    assert_eq!(words.read::<u32>().expect("reads"), expected);
    let fills: Vec<_> = times.iter().filter(|time| time.name == "fill").collect();
    assert_eq!((fills.len(), fills[0].bytes), (1, 8000));
}

#[test]
fn threads_may_handle_several_elements() {
    for batch in [1, 3, 8] {
        let device = validated(Testing { batch: Some(batch), ..Default::default() });
        for count in [1u32, 64, 511, 512, 513, 4096 * 64 * 3 + 5] {
            let words = Stream::from_slice(&device, "words", &vec![7u32; count as usize + 9]).expect("fits");
            let mut recorder = device.recorder(&Never, &NoProgress);
            let params = FillParams { count, value: 8 };
            recorder.dispatch(&SHADERS.fill, u64::from(count), &params, &[("words", &words)]).expect("dispatches");
            recorder.finish().expect("runs");
            let found: Vec<u32> = words.read().expect("reads");
            let (written, rest) = found.split_at(count as usize);
            assert!(written.iter().all(|word| *word == 8) && *rest == [7; 9], "{count} by {batch}");
        }
    }
}

#[test]
fn what_is_dropped_after_recording_is_kept_until_it_has_run() {
    let device = validated(Testing::default());
    let kept = Stream::new(&device, "kept", 4, 64).expect("fits");
    let mut recorder = device.recorder(&Never, &NoProgress);
    for value in 0..200 {
        let dropped = Stream::new(&device, "dropped", 4, 64).expect("fits");
        let params = FillParams { count: 64, value };
        recorder.dispatch(&SHADERS.fill, 64, &params, &[("words", &dropped)]).expect("dispatches");
        recorder.dispatch(&SHADERS.fill, 64, &params, &[("words", &kept)]).expect("dispatches");
    }
    recorder.finish().expect("runs");
    assert_eq!(kept.read::<u32>().expect("reads"), [199; 64]);
}

#[test]
fn wrong_bindings_are_refused_by_name() {
    let device = validated(Testing::default());
    let words = Stream::new(&device, "words", 4, 8).expect("fits");
    let wide = Stream::new(&device, "wide", 16, 8).expect("fits");
    let params = FillParams { count: 8, value: 1 };
    let mut recorder = device.recorder(&Never, &NoProgress);
    let mut refusal = |streams: &[(&str, &Stream)]| {
        recorder.dispatch(&SHADERS.fill, 8, &params, streams).expect_err("is refused").message
    };
    assert_eq!(refusal(&[]), "fill: nothing is bound to 'words'");
    assert_eq!(refusal(&[("words", &words), ("other", &wide)]), "fill: 'other' is not a binding, or given twice");
    assert_eq!(refusal(&[("words", &wide)]), "fill: elements of 'words' have 4 bytes, those of stream 'wide' 16");
    let refused = recorder.dispatch(&SHADERS.fill, 8, &[1u32], &[("words", &words)]).expect_err("is refused");
    assert_eq!(refused.message, "fill: 4 bytes of parameters, not 8");
}

#[test]
fn a_budget_that_is_too_small_fails_the_stream_and_not_the_device() {
    let device = open(DeviceOptions { budget_bytes: 4 << 20, ..Default::default() });
    let before = device.used_bytes();
    let refused = Stream::new(&device, "positions", 12, 400_000).expect_err("does not fit");
    assert_eq!(refused.kind, ErrorKind::OutOfMemory);
    let expected = format!("'positions' needs 4800000 bytes of device memory, {} are available", (4 << 20) - before);
    assert!(refused.message.starts_with(&expected), "{}", refused.message);
    assert_eq!(device.used_bytes(), before);
    assert_numbered(&device, 10_000);
    assert_eq!(device.used_bytes(), before);
}

/// Minutes of work for one core.
fn long_job(device: &Arc<Device>, cancel: &Cancel, progress: &dyn Progress) -> ErrorKind {
    let threads = 1u64 << 22;
    let results = Stream::new(device, "results", 4, threads).expect("fits");
    let mut recorder = device.recorder(cancel, progress);
    let params = [threads as u32, 40_000, 0, 0];
    let result = recorder
        .dispatch(&SHADERS.selftest_loops, threads, &params, &[("results", &results)])
        .and_then(|()| recorder.finish());
    result.expect_err("is cancelled").kind
}

#[test]
fn a_long_job_ends_within_250_ms_of_being_cancelled() {
    let device = open(DeviceOptions::default());
    device.warm_up(&[&SHADERS.selftest_loops]).expect("warms up");
    let cancel = Cancel::default();
    let remote = cancel.clone();
    let canceller = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(700));
        remote.cancel();
        Instant::now()
    });
    let kind = long_job(&device, &cancel, &NoProgress);
    let took = canceller.join().expect("sleeps").elapsed();
    assert_eq!(kind, ErrorKind::Cancelled);
    assert!(took < Duration::from_millis(250), "{took:?}");
    assert_numbered(&device, 1000);
}

#[test]
fn progress_rises_while_a_long_dispatch_runs() {
    struct CancelAtFifth(Cancel, std::sync::Mutex<Vec<(u64, u64)>>);
    impl Progress for CancelAtFifth {
        fn pass(&self, _name: &str, done: u64, total: u64) {
            let mut seen = self.1.lock().expect("one thread");
            seen.push((done, total));
            if seen.len() == 5 {
                self.0.cancel();
            }
        }
    }
    let device = open(DeviceOptions::default());
    device.warm_up(&[&SHADERS.selftest_loops]).expect("warms up");
    let cancel = Cancel::default();
    let progress = CancelAtFifth(cancel.clone(), Default::default());
    assert_eq!(long_job(&device, &cancel, &progress), ErrorKind::Cancelled);
    let seen = progress.1.into_inner().expect("one thread");
    assert_eq!(seen.len(), 5);
    assert!(seen.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[1].1 == 1 << 22), "{seen:?}");
}

#[test]
fn two_threads_may_share_a_device() {
    let device = validated(Testing::default());
    std::thread::scope(|scope| {
        for threads in [300_000, 300_001] {
            let device = &device;
            scope.spawn(move || (0..5).for_each(|_| assert_numbered(device, threads)));
        }
    });
    assert_eq!(device.validation_messages(), [""; 0]);
}

#[test]
fn devices_are_found_by_index_uuid_and_name_and_refused_by_a_wrong_one() {
    let devices = list_devices().expect("lists");
    let first = devices.first().expect("a Vulkan device; run deploy/setup to install one");
    for selector in [first.uuid.clone(), "0".into(), first.name.to_uppercase()] {
        let device = open(DeviceOptions { selector: Some(selector), ..Default::default() });
        assert_eq!(device.info().uuid, first.uuid);
    }
    let error = Device::open(&DeviceOptions { selector: Some("no such thing".into()), ..Default::default() })
        .expect_err("is refused");
    assert_eq!(error.kind, ErrorKind::NotSupported);
    assert!(error.message.contains("'no such thing'") && error.message.contains(&first.name), "{}", error.message);
}

#[test]
fn a_cache_folder_keeps_the_verdict_of_the_self_test() {
    let folder = tempfile::tempdir().expect("a folder");
    let options = DeviceOptions { cache_dir: Some(folder.path().join("cache")), ..Default::default() };
    drop(open(options.clone()));
    let files: Vec<_> = std::fs::read_dir(folder.path().join("cache")).expect("made").flatten().collect();
    let names: Vec<_> = files.iter().map(|file| file.file_name().to_string_lossy().into_owned()).collect();
    assert!(names.iter().any(|name| name.starts_with("self-test-")), "{names:?}");
    assert!(names.iter().any(|name| name.starts_with("pipelines-")), "{names:?}");
    assert!(!names.iter().any(|name| name.ends_with(".part")), "{names:?}");
    for file in files {
        std::fs::write(file.path(), b"torn").expect("writes");
    }
    assert_numbered(&open(options), 1000);
}

#[test]
fn every_shader_stays_within_the_limits_all_devices_have() {
    for shader in ALL_SHADERS {
        let descriptors: u32 = shader.bindings.iter().map(|binding| binding.count).sum();
        assert_eq!(shader.local_size, [64, 1, 1], "{}", shader.name);
        assert!(shader.push_constant_bytes <= 128, "{}", shader.name);
        assert!(descriptors <= 16 * 16, "{}: {descriptors} descriptors", shader.name);
    }
}
