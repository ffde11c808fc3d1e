//! See `maille_fuzz::design`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::design(bytes));
