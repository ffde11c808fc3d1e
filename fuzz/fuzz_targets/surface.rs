//! See `maille_fuzz::surface`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| maille_fuzz::surface(bytes));
