//! See `maille_fuzz::simulation`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::simulation(bytes));
