//! See `maille_fuzz::circles`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::circles(bytes));
