//! See `maille_fuzz::pieces`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::pieces(bytes));
