//! Prefix sums, compaction, expansion and sorting against their twins.

use displace_glsl::reference::{compact::kept, expand::places, scan::exclusive_sums, sort::sorted};
use displace_server::{
    domain::cancel::{Cancel, NoProgress},
    render::lists::{compact::Compact, expand, scan::Scan, sort::Sort},
    vulkan::{Recorder, Stream},
};
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

use crate::raster::device;

/// Around a block, and over several pages.
const COUNTS: [usize; 8] = [0, 1, 63, 64, 2047, 2048, 2049, 1 << 24];

fn run(record: impl FnOnce(&mut Recorder<'_>)) {
    let cancel = Cancel::default();
    let mut recorder = device().recorder(&cancel, &NoProgress);
    record(&mut recorder);
    recorder.finish().expect("runs");
}

fn random(count: usize, below: u32) -> Vec<u32> {
    let mut random = StdRng::seed_from_u64(count as u64);
    (0..count).map(|_| random.random_range(0..below)).collect()
}

fn scan(items: &[u32]) -> (Vec<u32>, u64) {
    let count = items.len() as u64;
    let scan = Scan::new(device(), count).expect("fits");
    let items = Stream::from_slice(device(), "items", items).expect("fits");
    let offsets = Stream::new(device(), "offsets", 4, count).expect("fits");
    run(|recorder| scan.record(recorder, &items, &offsets, count).expect("records"));
    (offsets.read().expect("reads"), scan.total().expect("reads"))
}

#[test]
fn prefix_sums_are_exact_at_every_block_boundary() {
    for count in COUNTS {
        // No more than 2^32 together.
        let items = random(count, 250);
        let (expected, expected_total) = exclusive_sums(&items);
        let (offsets, total) = scan(&items);
        assert_eq!(total, expected_total, "{count} items");
        assert!(offsets.iter().map(|&o| u64::from(o)).eq(expected), "{count} items");
    }
}

#[test]
fn a_total_beyond_32_bits_is_told_as_it_is() {
    assert_eq!(scan(&vec![u32::MAX; 5000]).1, 5000 * u64::from(u32::MAX));
}

#[test]
fn compaction_keeps_what_is_flagged_in_its_order() {
    for count in COUNTS {
        for flags in [random(count, 2), vec![0; count.min(5000)], vec![1; count.min(5000)]] {
            let count = flags.len() as u64;
            let compact = Compact::new(device(), count).expect("fits");
            let stream = Stream::from_slice(device(), "flags", &flags).expect("fits");
            let list = Stream::new(device(), "kept", 4, count).expect("fits");
            run(|recorder| compact.record(recorder, &stream, &list, count).expect("records"));
            let (found, expected): (Vec<u32>, _) = (list.read().expect("reads"), kept(&flags));
            assert_eq!(compact.total().expect("reads"), expected.len() as u64, "{count} flags");
            assert!(found[..expected.len()] == expected, "{count} flags");
        }
    }
}

#[test]
fn every_place_finds_its_item_over_items_without_any() {
    for count in COUNTS {
        // Most items have no place, so that as many places as items come out.
        let counts: Vec<u32> = random(count, 8).into_iter().map(|n| n.saturating_sub(4)).collect();
        let (offsets, total) = scan(&counts);
        let offsets = Stream::from_slice(device(), "offsets", &offsets).expect("fits");
        let stream = Stream::new(device(), "places", 8, total).expect("fits");
        run(|recorder| expand::record(recorder, &offsets, &stream, counts.len() as u64, total).expect("records"));
        let found: Vec<[u32; 2]> = stream.read().expect("reads");
        assert!(found == places(&counts), "{count} items, {total} places");
    }
}

#[test]
fn records_are_sorted_by_their_keys_and_equal_ones_keep_their_order() {
    for count in COUNTS {
        // Few keys show the order of equal ones; many show every digit.
        for bits in [3, 24, 32].into_iter().take(if count > 1 << 20 { 2 } else { 3 }) {
            let keys = random(count, 1u32.checked_shl(bits).unwrap_or(u32::MAX));
            let records: Vec<[u32; 2]> = keys.into_iter().zip(0..).map(|(key, i)| [key, i]).collect();
            let sort = Sort::new(device(), count as u64).expect("fits");
            let stream = Stream::from_slice(device(), "records", &records).expect("fits");
            run(|recorder| sort.record(recorder, &stream, count as u64, bits).expect("records"));
            let found: Vec<[u32; 2]> = stream.read().expect("reads");
            assert!(found == sorted(&records, bits), "{count} records, {bits} bits");
        }
    }
}
