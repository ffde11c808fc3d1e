//! See `maille_fuzz::run`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::run(bytes));
