//! See `maille_fuzz::study`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::study(bytes));
