//! See `maille_fuzz::limits`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::limits(bytes));
