//! See `maille_fuzz::frames`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::frames(bytes));
