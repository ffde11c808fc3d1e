//! See `maille_fuzz::states`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::states(bytes));
