//! `profile` and `bench`: what they say, not how long it took.

use viscera_io::write::write_tet_msh;

use crate::{CUBE, Desk, plain_and_tangled};

/// The numbers of a column of percentages add up to all of it.
fn shares(text: &str) -> Vec<f64> {
    let rows = text.lines().skip_while(|line| !line.starts_with("stage")).skip(1).take_while(|line| !line.is_empty());
    let share = |line: &str| line.split(" %").next()?.rsplit(' ').next()?.parse().ok();
    rows.filter_map(share).collect()
}

#[test]
fn a_profile_of_explicit_steps_accounts_for_all_of_their_time_and_names_the_cell_that_limits_them() {
    let desk = Desk::new();
    desk.write("cube.toml", format!("precision = \"double\"\n{CUBE}").replace("[2, 2, 2]", "[4, 4, 4]"));
    let outcome = desk
        .viscera(&["profile", "cube.toml", "--frame", "20 ms"])
        .ends_with(0)
        .says("cube: 384 cells, double precision, 10 steps of 10.0 ms explicit")
        .says("forces: tensor-mass")
        .says("frequency bound")
        .says("for every 20.0 ms simulated")
        .says("largest cost");
    let shares = shares(&outcome.out);
    let (all, parts) = shares.split_last().expect("rows");
    assert_eq!(*all, 100.0);
    // One decimal each.
    assert!((parts.iter().sum::<f64>() - 100.0).abs() < 0.06 * parts.len() as f64, "{parts:?}");
    assert!(!desk.path("out").exists(), "a profile leaves nothing behind");
}

#[test]
fn a_profile_of_implicit_steps_tells_products_from_the_rest_of_the_solve() {
    let desk = Desk::new();
    let law = "law = { kind = \"st-venant-kirchhoff\", young = \"10 kPa\", poisson = 0.4 }";
    let corotational =
        "law = { kind = \"linear\", young = \"10 kPa\", poisson = 0.4 }\nmodel = { kind = \"corotational\" }";
    let implicit = "integrator = { kind = \"backward-euler\", linear = { iterations = 25 } }\n";
    desk.write("cube.toml", format!("{implicit}{}", CUBE.replace(law, corotational)));
    let outcome = desk
        .viscera(&["profile", "cube.toml", "--no-trials"])
        .ends_with(0)
        .says("by backward-euler, 25 linear iterations each")
        .says("products: corotational")
        .says("vectors of the conjugate gradient")
        .says("preconditioner")
        .says("linearisation");
    assert!(!outcome.out.contains("what would lower it"));
    let products = outcome.out.lines().find(|line| line.starts_with("products")).expect("a row");
    // One for the residual of the guess, and one for each iteration.
    assert!(products.split_whitespace().any(|word| word == "26"), "{products}");
}

#[test]
fn a_profile_of_a_step_that_fails_says_so_and_shows_the_steps_before_it() {
    let desk = Desk::new();
    let force = "[[\"0.05 s\", [0, 0, 0]], [\"0.1 s\", [0, \"-1e15 kN\", 0]]]";
    desk.write("crushed.toml", format!("{CUBE}load = [{{ region = \"y-min\", force = {force} }}]\n"));
    desk.viscera(&["profile", "crushed.toml"]).ends_with(1).says("largest cost").complains("the step is undone");
}

/// Nodes that a mesher numbered in no order.
#[test]
fn a_profile_says_that_the_nodes_of_a_mesh_are_in_no_order() {
    let desk = Desk::new();
    let made = CUBE.lines().find(|line| line.starts_with("mesh")).expect("a mesh");
    for (name, mesh) in ["plain", "tangled"].into_iter().zip(plain_and_tangled()) {
        write_tet_msh(desk.path(&format!("{name}.msh")), &mesh).expect("a folder of its own");
        desk.write(&format!("{name}.toml"), CUBE.replace(made, &format!("mesh = {{ file = \"{name}.msh\" }}")));
    }
    let ask = "`viscera mesh convert --reorder` on its file makes this faster";
    desk.viscera(&["profile", "tangled.toml", "--no-trials"]).ends_with(0).says("in the mean, where").says(ask);
    let outcome = desk.viscera(&["profile", "plain.toml", "--no-trials"]).ends_with(0);
    assert!(!outcome.out.contains("--reorder"), "{}", outcome.out);
}

/// Rounds of a resection, with grasp and cut, for some seconds.
#[test]
fn a_soak_tells_rounds_steps_and_memory_and_ends_well_where_that_does_not_grow() {
    let desk = Desk::new();
    let coarse = ["--set", "body.liver.mesh.edge=30 mm", "--time", "1 s"];
    desk.viscera(&[&["bench", "soak", "liver-resection", "--for", "3 s"], &coarse[..]].concat())
        .ends_with(0)
        .says("liver-resection in rounds of 100 steps for 3 s")
        .says("MB in the last: ")
        .says("every round ended with the bits of the first one");
    desk.viscera(&["bench", "soak", "--help"]).ends_with(0).says("[default: \"1 h\"]");
    desk.viscera(&["bench", "capacity", "--help"]).ends_with(0).says("--quick");
}

/// Frames of a session behind the real server, taken by a client over a socket. Whether the channel keeps time is the machine's affair.
#[test]
fn a_haptic_channel_is_measured_while_a_page_is_served() {
    let desk = Desk::new();
    let coarse = ["--set", "body.liver.mesh.edge=30 mm", "--for", "2 s"];
    desk.viscera(&[&["bench", "haptics", "--page"][..], &coarse].concat())
        .says("60 surfaces a second go to a page")
        .says("served to 1 client: ")
        .says(" samples of ")
        .says("limited in");
}
