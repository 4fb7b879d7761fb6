#![no_main]

use libfuzzer_sys::fuzz_target;
use viscera_fuzz::hold_to_its_word;

fuzz_target!(|bytes: &[u8]| hold_to_its_word(viscera_io::vtu::parse(bytes)));
