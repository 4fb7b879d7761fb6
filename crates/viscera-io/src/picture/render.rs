//! From scene to pixels: visibility, light, occlusion, words.

use viscera::math::Vec3;

use super::camera::View;
use super::colour::{Light, encode, mix};
use super::facet::{Facet, facets};
use super::ground::Ground;
use super::occlusion::{Surface, openness};
use super::raster::{Band, NOTHING, SAMPLES};
use super::scene::Picture;
use super::shade::Studio;
use super::{Finish, Image, PictureError, annotation};

/// Rows of pixels drawn at a time: the samples of a band stay in the cache.
const ROWS: usize = 16;

/// Draws `picture` as seen by `view`.
pub(super) fn render(picture: &Picture, view: &View) -> Result<Image, PictureError> {
    let (width, height) = (picture.width, picture.height);
    let mut seen = Vec::new();
    for body in &picture.surfaces(view.size) {
        facets(body, view, &mut seen);
    }
    let studio = Studio::new(view);
    let ground = picture.ground.then(|| Ground::new(view, &seen, studio.key.cast()));
    let painter = Painter { view, facets: &seen, studio, ground, width, height };
    let (light, surfaces) = painter.paint();
    let open = openness(view, width, height, &surfaces);
    let dimmed = light.iter().zip(&open).map(|(&light, &open)| light * (0.25 + 0.75 * open));
    let pixels = dimmed.flat_map(|light| light.to_array().map(encode)).collect();
    let mut image = Image { width, height, pixels };
    annotation::annotate(&mut image, picture, view);
    Ok(image)
}

/// What the samples of one pixel see alike: a solid facet, and a ghost before it.
#[derive(Clone, Copy)]
struct Share {
    solid: u32,
    ghost: u32,
    count: u32,
    place: [u32; 2],
}

struct Painter<'a> {
    view: &'a View,
    facets: &'a [Facet],
    studio: Studio,
    ground: Option<Ground>,
    width: usize,
    height: usize,
}

impl Painter<'_> {
    /// Light per pixel, and the surface under it.
    fn paint(&self) -> (Vec<Light>, Vec<Option<Surface>>) {
        let mut light = Vec::with_capacity(self.width * self.height);
        let mut surfaces = Vec::with_capacity(self.width * self.height);
        let mut solid = Band::new(self.width, ROWS);
        let mut ghost = self.facets.iter().any(|facet| facet.ghost).then(|| Band::new(self.width, ROWS));
        for top in (0..self.height).step_by(ROWS) {
            solid.start(top);
            if let Some(ghost) = &mut ghost {
                ghost.start(top);
            }
            for (index, facet) in self.facets.iter().enumerate() {
                match (&mut ghost, facet.ghost) {
                    (Some(ghost), true) => ghost.draw(index as u32, facet),
                    _ => solid.draw(index as u32, facet),
                }
            }
            for row in 0..ROWS.min(self.height - top) {
                for column in 0..self.width {
                    let (colour, surface) = self.pixel(&solid, ghost.as_ref(), column, row, top);
                    light.push(colour);
                    surfaces.push(surface);
                }
            }
        }
        (light, surfaces)
    }

    /// One pixel: samples that see the same are shaded once, at their centre.
    fn pixel(
        &self,
        solid: &Band,
        ghost: Option<&Band>,
        column: usize,
        row: usize,
        top: usize,
    ) -> (Light, Option<Surface>) {
        const ALL: usize = SAMPLES * SAMPLES;
        let mut shares = [Share { solid: NOTHING, ghost: NOTHING, count: 0, place: [0, 0] }; ALL];
        let mut kinds = 0;
        for j in 0..SAMPLES {
            for i in 0..SAMPLES {
                let (body, depth) = solid.sample(column, row, i, j);
                let before = ghost.map(|band| band.sample(column, row, i, j)).filter(|&(_, near)| near > depth);
                let veil = before.map_or(NOTHING, |(facet, _)| facet);
                let known = shares[..kinds].iter().position(|share| share.solid == body && share.ghost == veil);
                let slot = known.unwrap_or_else(|| {
                    kinds += 1;
                    kinds - 1
                });
                let Share { count, place, .. } = shares[slot];
                let place = [place[0] + 2 * i as u32 + 1, place[1] + 2 * j as u32 + 1];
                shares[slot] = Share { solid: body, ghost: veil, count: count + 1, place };
            }
        }
        let corner = [column as f64, (top + row) as f64];
        let mut light = Vec3::ZERO;
        let mut surface = None;
        let mut largest = 0;
        for share in &shares[..kinds] {
            let centre = share.place.map(|sum| f64::from(sum) / f64::from(2 * share.count * SAMPLES as u32));
            let place = [corner[0] + centre[0], corner[1] + centre[1]];
            let (mut colour, under) = self.solid(share.solid, place);
            if share.ghost != NOTHING {
                colour = self.veil(&self.facets[share.ghost as usize], place, colour, share.solid != NOTHING);
            }
            light += colour * (share.count as f32 / ALL as f32);
            if share.count > largest {
                (largest, surface) = (share.count, under);
            }
        }
        (light, surface)
    }

    /// The light of a solid facet, or of what lies behind all of them.
    fn solid(&self, index: u32, place: [f64; 2]) -> (Light, Option<Surface>) {
        let Some(facet) = self.facets.get(index as usize) else { return self.behind(place) };
        let hit = facet.at(place);
        let viewer = self.view.towards_viewer(hit.position).cast();
        let normal = hit.normal.cast();
        let mut colour = self.studio.shade(facet.finish, hit.colour, normal, viewer);
        if facet.wireframe {
            colour = colour * (1.0 - 0.62 * line(hit.edge));
        }
        (colour, Some(Surface { position: hit.position.cast(), normal }))
    }

    /// Pale backdrop and ground.
    fn behind(&self, place: [f64; 2]) -> (Light, Option<Surface>) {
        let height = (place[1] / self.height as f64) as f32;
        let backdrop = mix(Vec3::new(0.80, 0.82, 0.85), Vec3::new(0.90, 0.90, 0.89), height);
        let Some(ground) = &self.ground else { return (backdrop, None) };
        let surface = ground
            .meet(self.view, place)
            .map(|position| Surface { position: position.cast(), normal: ground.normal().cast() });
        (ground.colour(self.view, place, backdrop), surface)
    }

    /// `behind` seen through a ghost: denser where the ghost is seen edge-on, so that its outline reads. Before a body only
    /// the outline is drawn, so that the body keeps its colour.
    fn veil(&self, facet: &Facet, place: [f64; 2], behind: Light, before_body: bool) -> Light {
        let hit = facet.at(place);
        let viewer = self.view.towards_viewer(hit.position).cast::<f32>();
        let normal = hit.normal.cast::<f32>();
        let grazing = 1.0 - normal.dot(viewer).clamp(0.0, 1.0);
        let film = if before_body { 0.0 } else { 0.20 };
        let mut density = film + 0.5 * grazing * grazing * grazing;
        if facet.wireframe {
            density += (1.0 - density) * 0.3 * line(hit.edge);
        }
        mix(behind, self.studio.shade(Finish::Matte, hit.colour, normal, viewer), density)
    }
}

/// Cover of a line along an edge, `distance` pixels away from it.
fn line(distance: f64) -> f32 {
    (1.05 - distance).clamp(0.0, 1.0) as f32
}
