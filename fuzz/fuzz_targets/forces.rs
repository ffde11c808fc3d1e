//! See `maille_fuzz::forces`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::forces(bytes));
