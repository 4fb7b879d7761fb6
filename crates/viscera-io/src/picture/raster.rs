//! Visibility: which facet each sample sees, by a depth buffer over a band of rows.

use super::facet::Facet;

/// Samples per pixel and axis.
pub(super) const SAMPLES: usize = 4;
/// No facet.
pub(super) const NOTHING: u32 = u32::MAX;

/// Nearest facet per sample in rows `top..top + rows` of pixels.
pub(super) struct Band {
    width: usize,
    rows: usize,
    top: usize,
    nearness: Vec<f64>,
    facet: Vec<u32>,
}

impl Band {
    /// A band of `rows` pixel rows; place it with [`Band::start`].
    pub(super) fn new(width: usize, rows: usize) -> Self {
        let samples = width * rows * SAMPLES * SAMPLES;
        Self { width, rows, top: 0, nearness: vec![f64::NEG_INFINITY; samples], facet: vec![NOTHING; samples] }
    }

    /// Empties it and moves it to row `top`.
    pub(super) fn start(&mut self, top: usize) {
        self.top = top;
        self.nearness.fill(f64::NEG_INFINITY);
        self.facet.fill(NOTHING);
    }

    /// Offers a facet to every sample that it covers.
    pub(super) fn draw(&mut self, index: u32, facet: &Facet) {
        let scale = SAMPLES as f64;
        let place = facet.image.map(|p| p.place);
        let range = |axis: usize, start: f64, limit: usize| {
            let low = place[0][axis].min(place[1][axis]).min(place[2][axis]);
            let high = place[0][axis].max(place[1][axis]).max(place[2][axis]);
            let first = ((low - start) * scale - 0.5).ceil().clamp(0.0, limit as f64) as usize;
            let last = ((high - start) * scale - 0.5).floor().clamp(-1.0, limit as f64 - 1.0) + 1.0;
            first..last as usize
        };
        let columns = range(0, 0.0, self.width * SAMPLES);
        let rows = range(1, self.top as f64, self.rows * SAMPLES);
        if columns.is_empty() {
            return;
        }
        // The three coordinates are affine along a row: the covered samples are one interval, found without testing each.
        for row in rows {
            let y = self.top as f64 + (row as f64 + 0.5) / scale;
            let start = facet.barycentric([0.5 / scale, y]);
            let step: [f64; 3] = std::array::from_fn(|i| {
                let (a, b) = (place[(i + 1) % 3], place[(i + 2) % 3]);
                -(b[1] - a[1]) / facet.area / scale
            });
            let (mut low, mut high) = (columns.start as f64, columns.end as f64 - 1.0);
            for i in 0..3 {
                let zero = -start[i] / step[i];
                if step[i] > 0.0 {
                    low = low.max(zero.ceil());
                } else if step[i] < 0.0 {
                    high = high.min(zero.floor());
                } else if start[i] < 0.0 {
                    high = -1.0;
                }
            }
            if low > high {
                continue;
            }
            let blend = |v: [f64; 3]| (0..3).map(|i| v[i] * facet.image[i].nearness).sum::<f64>();
            let (nearness, slope) = (blend(start), blend(step));
            let base = row * self.width * SAMPLES;
            for column in low as usize..=high as usize {
                let here = nearness + slope * column as f64;
                let sample = base + column;
                if here > self.nearness[sample] {
                    self.nearness[sample] = here;
                    self.facet[sample] = index;
                }
            }
        }
    }

    /// Facet and nearness of sample (i, j) of pixel (column, row), row counted from the band's top.
    #[inline]
    pub(super) fn sample(&self, column: usize, row: usize, i: usize, j: usize) -> (u32, f64) {
        let sample = (row * SAMPLES + j) * self.width * SAMPLES + column * SAMPLES + i;
        (self.facet[sample], self.nearness[sample])
    }
}
