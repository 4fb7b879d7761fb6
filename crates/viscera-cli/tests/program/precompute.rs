//! `precompute`: responses in a file, which a run takes, and refuses when the scene has changed.

use crate::{CUBE, Desk};

#[test]
fn responses_are_kept_in_a_file_that_a_run_takes_and_a_changed_scene_refuses() {
    let desk = Desk::new();
    let linear = CUBE.replace("\"st-venant-kirchhoff\"", "\"linear\"");
    let scene = format!("{linear}model = {{ kind = \"precomputed\", responses = \"cube.responses\" }}\n");
    desk.write("cube.toml", &scene);
    desk.viscera(&["run", "cube.toml", "--pictures=0"]).ends_with(2).complains("`viscera precompute` writes it");
    desk.viscera(&["precompute", "cube.toml"]).ends_with(0).says("cube.responses");
    let bytes = desk.read_bytes("cube.responses");
    desk.viscera(&["precompute", "cube.toml", "--threads", "2"]).ends_with(0);
    assert!(desk.read_bytes("cube.responses") == bytes, "threads change no bit");

    desk.viscera(&["run", "cube.toml", "--pictures=0", "--out", "kept"]).ends_with(0);
    desk.write("without.toml", scene.replace(", responses = \"cube.responses\"", ""));
    desk.viscera(&["run", "without.toml", "--pictures=0", "--out", "computed"]).ends_with(0);
    assert_eq!(desk.read("kept/observables.csv"), desk.read("computed/observables.csv"));

    let stale = ["run", "cube.toml", "--pictures=0", "--set", "body.cube.law.young=11 kPa"];
    desk.viscera(&stale).ends_with(2).complains("computed for another tissue");
    desk.write("cube.responses", &bytes[..bytes.len() / 2]);
    desk.viscera(&["run", "cube.toml", "--pictures=0"]).ends_with(2).complains("damaged");
    desk.write("moving.toml", CUBE);
    desk.viscera(&["precompute", "moving.toml"]).ends_with(1).complains("no body of `moving`");
}

#[test]
fn what_a_precomputed_body_cannot_do_is_refused_where_the_scene_says_it() {
    let desk = Desk::new();
    let linear = CUBE.replace("\"st-venant-kirchhoff\"", "\"linear\"");
    let model = "model = { kind = \"precomputed\" }\n";
    let cautery = "[instrument.cautery]\nkind = \"cautery\"\nradius = \"1 cm\"\npath = [0, 0, 0]\n";
    desk.write("cut.toml", format!("{linear}{model}{cautery}"));
    let refused = desk.viscera(&["check", "cut.toml"]).ends_with(1);
    refused.complains("no body here can lose cells to a cautery").complains("take the model `hybrid`");
    desk.write("law.toml", format!("{CUBE}{model}"));
    desk.viscera(&["check", "law.toml"]).ends_with(1).complains("take the law `linear`");
    desk.write("damped.toml", format!("{linear}{model}damping = \"3 1/s\"\n"));
    desk.viscera(&["check", "damped.toml"]).ends_with(1).complains("rests at the end of every step");
    desk.write("loose.toml", format!("{}{model}", linear.replace("fix = \"y-max\"\n", "")));
    desk.viscera(&["check", "loose.toml"]).ends_with(1).complains("nothing holds the body");
    desk.write("key.toml", format!("{linear}model = {{ kind = \"precomputed\", dynamic = \"all\" }}\n"));
    desk.viscera(&["check", "key.toml"]).ends_with(1).complains("`dynamic` is a setting of the model `hybrid`");
}
