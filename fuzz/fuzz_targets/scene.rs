#![no_main]

use libfuzzer_sys::fuzz_target;
use viscera_scene::Scene;

// Any text is refused with words that show a line, or accepted and then written and read again as the same scene.
fuzz_target!(|text: &str| {
    match Scene::parse(text, "").and_then(|scene| scene.check()) {
        Err(errors) => assert!(errors.all().iter().all(|error| !error.message.is_empty() && !error.to_string().is_empty())),
        Ok(file) => {
            let written = file.to_toml().expect("a scene that was read can be written");
            let again = Scene::parse(&written, "").and_then(|scene| scene.check());
            assert_eq!(again.expect("a written scene can be read"), file);
        }
    }
});
