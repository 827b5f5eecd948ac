//! How far two outlines differ.

use super::picture::Picture;

/// Pixels covered in exactly one of two pictures of one size; `None` where one does not tell what it covers.
#[must_use]
pub fn xor_px(a: &Picture, b: &Picture) -> Option<u64> {
    let pairs = a.covered.as_ref()?.iter().zip(b.covered.as_ref()?);
    Some(pairs.filter(|(a, b)| a != b).count() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_of_one_outline_alone_are_counted() {
        let picture = |covered: &[bool]| Picture { covered: Some(covered.to_vec()), ..Picture::default() };
        let (a, b) = (picture(&[true, true, false, false]), picture(&[true, false, true, false]));
        assert_eq!((xor_px(&a, &b), xor_px(&a, &a)), (Some(2), Some(0)));
        assert_eq!(xor_px(&a, &Picture::default()), None);
    }
}
