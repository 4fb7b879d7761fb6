//! Pictures show what is there: sizes, depth, colours, and no surprise on bad input.

use viscera::math::Vec3;
use viscera::mesh::TetMesh;
use viscera_io::picture::{Body, Camera, Colour, Field, Image, Picture, PictureError, Tool};

type Point = Vec3<f64>;

fn cube_camera() -> Camera {
    Camera::framing(Vec3::splat(-1.0), Vec3::splat(1.0)).towards([0.0, 0.0, -1.0]).orthographic()
}

fn bare(picture: Picture) -> Picture {
    picture.without_ground().without_annotation()
}

fn square(z: f64, half: f64) -> (Vec<Point>, Vec<[u32; 3]>) {
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
    (corners.map(|[x, y]| Vec3::new(x, y, z)).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

fn reddish(pixel: [u8; 3]) -> bool {
    i32::from(pixel[0]) > i32::from(pixel[2]) + 40
}

fn count(image: &Image, which: impl Fn([u8; 3]) -> bool) -> usize {
    image.pixels.chunks_exact(3).filter(|p| which([p[0], p[1], p[2]])).count()
}

fn sphere(radius: f64) -> (Vec<Point>, Vec<[u32; 3]>) {
    let (rings, around) = (48_u32, 96_u32);
    let mut nodes = Vec::new();
    let mut triangles = Vec::new();
    for ring in 0..=rings {
        let (out, height) = (std::f64::consts::PI * f64::from(ring) / f64::from(rings)).sin_cos();
        for k in 0..around {
            let (sine, cosine) = (std::f64::consts::TAU * f64::from(k) / f64::from(around)).sin_cos();
            nodes.push(Vec3::new(out * cosine, out * sine, height) * radius);
            if ring < rings {
                let node = |ring: u32, k: u32| ring * around + k % around;
                let [a, b, c, d] = [node(ring, k), node(ring + 1, k), node(ring + 1, k + 1), node(ring, k + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    (nodes, triangles)
}

/// In parallel projection a sphere covers π r², compared with a square of side 2r in the same view. Per cent: the rim's
/// pixels are half covered, and the rim is 2/r of the area for circle and square alike; 96 chords take 0.07 %.
#[test]
fn sphere_covers_pi_r_squared() {
    let cover = |(nodes, triangles): (Vec<Point>, Vec<[u32; 3]>)| {
        let body = Body::new(&nodes, &triangles).colour(Colour::new(200, 20, 20));
        count(&bare(Picture::new(400, 400)).camera(cube_camera()).body(body).render().unwrap(), reddish) as f64
    };
    let ratio = cover(sphere(0.8)) / cover(square(0.0, 0.8));
    assert!((ratio / std::f64::consts::FRAC_PI_4 - 1.0).abs() < 0.01, "{ratio}");
}

/// The nearer square hides the farther one, whichever is drawn first, in both projections.
#[test]
fn nearer_triangle_hides_farther_one() {
    let paint = |z: f64, half: f64, colour: Colour| {
        let (nodes, triangles) = square(z, half);
        Body::new(&nodes, &triangles).colour(colour)
    };
    let near = paint(0.9, 0.4, Colour::new(210, 20, 20));
    let far = paint(-0.9, 0.9, Colour::new(20, 20, 210));
    for camera in [cube_camera(), cube_camera().perspective(40.0)] {
        let draw = |a: &Body, b: &Body| {
            bare(Picture::new(120, 120)).camera(camera).body(a.clone()).body(b.clone()).render().unwrap()
        };
        let image = draw(&near, &far);
        assert_eq!(image, draw(&far, &near));
        assert!(reddish(image.pixel(60, 60).unwrap()));
        assert!(
            count(&image, |p| i32::from(p[2]) > i32::from(p[0]) + 40) > 500,
            "the farther square frames the nearer"
        );
    }
}

/// Same input, same bytes, down to the file.
#[test]
fn same_scene_gives_the_same_file() {
    let surface = TetMesh::box_grid([2, 2, 4], [0.1, 0.1, 0.2]).surface();
    let heights: Vec<f64> = surface.nodes.iter().map(|p| p.y).collect();
    let draw = || {
        let body = Body::new(&surface.nodes, &surface.triangles).field(Field::new("height", "m", &heights)).wireframe();
        let picture = Picture::new(160, 90).body(body.fixed(&[0, 1])).force([0.0, 0.1, 0.0], [0.0, 1.0, 0.0], 0.05);
        let mut bytes = Vec::new();
        picture.title("t").footer("f").render().unwrap().write_png(&mut bytes).unwrap();
        bytes
    };
    assert_eq!(draw(), draw());
}

/// A camera from given bounds does not move with the body.
#[test]
fn series_keeps_its_frame() {
    let (nodes, triangles) = square(0.0, 0.2);
    let draw = |shift: f64| {
        let moved: Vec<Point> = nodes.iter().map(|&p| p + Vec3::new(shift, 0.0, 0.0)).collect();
        let body = Body::new(&moved, &triangles).colour(Colour::new(200, 20, 20));
        bare(Picture::new(200, 200)).camera(cube_camera()).body(body).render().unwrap()
    };
    let middle = |image: &Image| {
        let columns: Vec<usize> = (0..200).filter(|&c| reddish(image.pixel(c, 102).unwrap())).collect();
        columns.iter().sum::<usize>() as f64 / columns.len() as f64
    };
    // The framed cube of 2 m is 0.74 · 200 px wide: half a metre is 37 px.
    let moved = middle(&draw(0.5)) - middle(&draw(0.0));
    assert!((moved - 37.0).abs() <= 1.0, "{moved}");
}

/// Nothing that a broken simulation can produce stops the drawing of the rest.
#[test]
fn diverged_and_inverted_bodies_are_drawn_as_far_as_they_go() {
    let surface = TetMesh::box_grid([2, 2, 2], [1.0, 1.0, 1.0]).surface();
    let inverted: Vec<[u32; 3]> = surface.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let mut broken = surface.nodes.clone();
    broken[0] = Vec3::splat(f64::NAN);
    broken[1] = Vec3::new(f64::INFINITY, 0.0, 0.0);
    broken[2] = Vec3::new(1e300, -1e300, 1e200);
    broken[3] = broken[4];
    let values = vec![f64::NAN; broken.len()];
    let camera = Camera::framing(Vec3::ZERO, Vec3::splat(1.0));
    let whole = |nodes: &[Point], triangles: &[[u32; 3]]| {
        let body = Body::new(nodes, triangles).wireframe().colour(Colour::new(200, 20, 20));
        bare(Picture::new(80, 60)).camera(camera).body(body).render().unwrap()
    };
    let right = whole(&surface.nodes, &surface.triangles);
    let turned = whole(&surface.nodes, &inverted);
    assert_eq!(count(&right, reddish), count(&turned, reddish));
    assert!(count(&whole(&broken, &surface.triangles), reddish) * 4 > count(&right, reddish));

    let body = Body::new(&broken, &surface.triangles).field(Field::new("p", "Pa", &values)).fixed(&[0, 999]).ghost();
    let picture = Picture::new(80, 60).camera(camera).body(body).force([0.0; 3], [f64::NAN; 3], 1.0);
    let picture = picture.tool(Tool::capsule([f64::NAN; 3], [0.0; 3], 0.1)).tool(Tool::sphere([0.0; 3], 0.0));
    assert_eq!(picture.title("žluť\n→").render().unwrap().pixels.len(), 80 * 60 * 3);
}

/// Useless input is refused by name.
#[test]
fn useless_input_is_refused() {
    let body = |nodes: &[Point], triangles: &[[u32; 3]]| Picture::new(8, 8).body(Body::new(nodes, triangles));
    let (nodes, triangles) = square(0.0, 1.0);
    let refused = |picture: Picture| picture.render().unwrap_err();
    assert!(matches!(refused(Picture::new(8, 8)), PictureError::NothingToFrame));
    assert!(matches!(refused(body(&[Vec3::splat(f64::NAN); 3], &[[0, 1, 2]])), PictureError::NothingToFrame));
    assert!(matches!(
        refused(body(&nodes, &[[0, 1, 7]])),
        PictureError::Node { body: 0, triangle: 0, node: 7, nodes: 4 }
    ));
    assert!(matches!(refused(Picture::new(0, 8)), PictureError::Size { .. }));
    let short = Picture::new(8, 8).body(Body::new(&nodes, &triangles).field(Field::new("p", "Pa", &[1.0])));
    assert!(matches!(refused(short), PictureError::Count { expected: 4, found: 1, .. }));
    for camera in [
        Camera::framing(Vec3::ZERO, Vec3::ZERO),
        Camera::framing(Vec3::ZERO, Vec3::splat(f64::NAN)),
        cube_camera().towards([0.0; 3]),
        cube_camera().towards([0.0, -1.0, 0.0]),
        cube_camera().perspective(180.0),
    ] {
        assert!(matches!(refused(Picture::new(8, 8).camera(camera)), PictureError::Camera { .. }));
    }
}

/// The file carries what was drawn, and no half file stays behind.
#[test]
fn saved_png_reads_back_as_drawn() {
    let (nodes, triangles) = square(0.0, 1.0);
    let image = Picture::new(64, 48).body(Body::new(&nodes, &triangles).tissue()).render().unwrap();
    let folder = std::env::temp_dir().join(format!("viscera-picture-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("square.png");
    image.save_png(&path).unwrap();
    let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, image.pixels);
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(matches!(image.save_png(&path), Err(PictureError::Write { .. })));
}
