use super::{Face, Point, TetTopology, VolumeMesh};

/// A part of a mesh, named by what a user sees instead of by numbers. Tests are on the rest shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// Every node.
    All,
    /// Nodes of the outward surface.
    Surface,
    /// A named region of the mesh, such as a physical group of Gmsh.
    Named(String),
    /// Nodes by number, from 0.
    Nodes(Vec<u32>),
    /// The one node closest to a place [m].
    Nearest(Point),
    /// Nodes in an axis-aligned box, borders included [m].
    Box {
        /// Smallest coordinates.
        low: Point,
        /// Largest coordinates.
        high: Point,
    },
    /// Nodes in a ball, border included [m].
    Sphere {
        /// Centre.
        centre: Point,
        /// Radius, > 0.
        radius: f64,
    },
    /// Nodes in a slab around a plane [m].
    Plane {
        /// A point of the plane.
        point: Point,
        /// Its normal, of any length but zero.
        normal: Point,
        /// Thickness of the slab, half on each side; 0 takes a millionth of the size of the mesh.
        thickness: f64,
    },
    /// Nodes on the side of a plane that its normal points to, border included.
    HalfSpace {
        /// A point of the plane.
        point: Point,
        /// Its normal, of any length but zero.
        normal: Point,
    },
    /// What is in any of these.
    Union(Vec<Region>),
    /// What is in all of these.
    Intersection(Vec<Region>),
}

/// A triangle of the surface that a load acts on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadTriangle {
    /// Corners, counter-clockwise seen from outside.
    pub nodes: [u32; 3],
    /// The cell behind it.
    pub cell: u32,
    /// The share of its area that counts: where triangles overlap, less than 1.
    pub weight: f64,
}

/// A region that selects nothing, or cannot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RegionError {
    /// Nothing lies in the region.
    #[error(
        "the region {region} selects nothing; the nearest node is {nearest} at ({}, {}, {}) m, and the mesh reaches from ({}, {}, {}) to ({}, {}, {}) m",
        at[0], at[1], at[2], low[0], low[1], low[2], high[0], high[1], high[2]
    )]
    Empty {
        /// The region, in words.
        region: String,
        /// The node that is closest to it.
        nearest: u32,
        /// Where that node lies [m].
        at: [f64; 3],
        /// Smallest coordinates of the mesh [m].
        low: [f64; 3],
        /// Largest coordinates of the mesh [m].
        high: [f64; 3],
    },
    /// The mesh has no region of that name.
    #[error("the mesh has no region named `{name}`; {known}")]
    UnknownName {
        /// The name.
        name: String,
        /// The names that it has, in words.
        known: String,
    },
    /// A node number that the mesh does not have.
    #[error("the region names node {node}, but the mesh has only {nodes} nodes (0 to {})", nodes - 1)]
    MissingNode {
        /// The number.
        node: u32,
        /// How many nodes there are.
        nodes: usize,
    },
    /// A size or direction that makes no sense.
    #[error("the region {region} is impossible: {why}")]
    Impossible {
        /// The region, in words.
        region: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// No boundary face has all its nodes in the region.
    #[error(
        "the region {region} holds nodes but no whole face of the surface; make it thicker, or name a group of faces"
    )]
    NoFaces {
        /// The region, in words.
        region: String,
    },
}

impl Region {
    /// A slab around a plane.
    pub fn plane(point: [f64; 3], normal: [f64; 3], thickness: f64) -> Self {
        Self::Plane { point: point.into(), normal: normal.into(), thickness }
    }

    /// A ball.
    pub fn sphere(centre: [f64; 3], radius: f64) -> Self {
        Self::Sphere { centre: centre.into(), radius }
    }

    /// An axis-aligned box.
    pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Self {
        Self::Box { low: low.into(), high: high.into() }
    }

    /// The node closest to a place.
    pub fn nearest(place: [f64; 3]) -> Self {
        Self::Nearest(place.into())
    }

    /// Nodes in the region, ascending.
    ///
    /// # Errors
    /// [`RegionError`] where nothing is selected, saying what is near.
    pub fn nodes(&self, mesh: &VolumeMesh) -> Result<Vec<u32>, RegionError> {
        let mut nodes = self.select(mesh)?;
        nodes.sort_unstable();
        nodes.dedup();
        if nodes.is_empty() { Err(self.empty(mesh)) } else { Ok(nodes) }
    }

    /// Cells whose corners all lie in the region, or that the named region lists, ascending.
    ///
    /// # Errors
    /// As [`Region::nodes`].
    pub fn cells(&self, mesh: &VolumeMesh) -> Result<Vec<u32>, RegionError> {
        let named = match self {
            Self::Named(name) => named_cells(mesh, name),
            _ => Vec::new(),
        };
        if !named.is_empty() {
            return Ok(named);
        }
        let inside = self.membership(mesh)?;
        let whole = |cell: &u32| mesh.cell(*cell as usize).iter().all(|&node| inside[node as usize]);
        let cells: Vec<u32> = (0..mesh.cell_count() as u32).filter(whole).collect();
        if cells.is_empty() { Err(self.empty(mesh)) } else { Ok(cells) }
    }

    /// Triangles of the outward surface whose corners all lie in the region: what carries a pressure.
    ///
    /// A face of a hexahedron comes twice, halved along each diagonal, with half the weight: halved along one alone, its
    /// corners would carry a third and a sixth of a load instead of a quarter each, and a pressed column would bend.
    ///
    /// A named group of faces selects just its faces, with their neighbours left out even where all corners belong.
    ///
    /// # Errors
    /// As [`Region::nodes`], and [`RegionError::NoFaces`].
    pub fn surface_triangles(&self, mesh: &VolumeMesh) -> Result<Vec<LoadTriangle>, RegionError> {
        let inside = self.membership(mesh)?;
        let listed = match self {
            Self::Named(name) => named_faces(mesh, name),
            _ => Vec::new(),
        };
        let chosen = |face: &[u32]| {
            let mut key = face.to_vec();
            key.sort_unstable();
            if listed.is_empty() {
                face.iter().all(|&n| inside[n as usize])
            } else {
                listed.binary_search(&key).is_ok()
            }
        };
        let triangles: Vec<_> = match mesh {
            VolumeMesh::Tet(mesh) => TetTopology::new(mesh)
                .faces
                .iter()
                .filter(|face| face.cells.1.is_none() && chosen(&face.nodes))
                .map(|face| LoadTriangle { nodes: face.nodes, cell: face.cells.0, weight: 1.0 })
                .collect(),
            VolumeMesh::Hex(mesh) => mesh
                .faces()
                .into_iter()
                .filter(|face| face.cells.1.is_none() && chosen(&face.nodes))
                .flat_map(|Face { nodes: [a, b, c, d], cells: (cell, _) }| {
                    [[a, b, c], [a, c, d], [a, b, d], [b, c, d]].map(|nodes| LoadTriangle { nodes, cell, weight: 0.5 })
                })
                .collect(),
        };
        if triangles.is_empty() { Err(RegionError::NoFaces { region: self.describe() }) } else { Ok(triangles) }
    }

    fn membership(&self, mesh: &VolumeMesh) -> Result<Vec<bool>, RegionError> {
        let mut inside = vec![false; mesh.nodes().len()];
        for node in self.nodes(mesh)? {
            inside[node as usize] = true;
        }
        Ok(inside)
    }

    fn select(&self, mesh: &VolumeMesh) -> Result<Vec<u32>, RegionError> {
        let nodes = mesh.nodes();
        let having = |test: &dyn Fn(Point) -> bool| {
            (0..nodes.len() as u32).filter(|&node| test(nodes[node as usize])).collect::<Vec<u32>>()
        };
        Ok(match self {
            Self::All => (0..nodes.len() as u32).collect(),
            Self::Surface => match mesh {
                VolumeMesh::Tet(mesh) => TetTopology::new(mesh).surface().flatten().collect(),
                VolumeMesh::Hex(mesh) => mesh.surface_quads().into_iter().flatten().collect(),
            },
            Self::Named(name) => named_nodes(mesh, name)?,
            Self::Nodes(list) => match list.iter().find(|&&node| node as usize >= nodes.len()) {
                Some(&node) => return Err(RegionError::MissingNode { node, nodes: nodes.len() }),
                None => list.clone(),
            },
            Self::Nearest(place) => nearest(nodes, *place).into_iter().collect(),
            Self::Box { low, high } => having(&|p| (0..3).all(|i| low[i] <= p[i] && p[i] <= high[i])),
            Self::Sphere { centre, radius } => {
                if radius.is_nan() || *radius <= 0.0 {
                    return Err(self.impossible("its radius must be positive"));
                }
                having(&|p| (p - *centre).squared_norm() <= radius * radius)
            }
            Self::Plane { point, normal, thickness } => {
                let normal = normal.normalized().ok_or_else(|| self.impossible("its normal has no direction"))?;
                if thickness.is_nan() || *thickness < 0.0 {
                    return Err(self.impossible("its thickness must not be negative"));
                }
                let half = (0.5 * thickness).max(1e-6 * mesh.size());
                having(&|p| (p - *point).dot(normal).abs() <= half)
            }
            Self::HalfSpace { point, normal } => {
                let normal = normal.normalized().ok_or_else(|| self.impossible("its normal has no direction"))?;
                let rounding = 1e-12 * mesh.size();
                having(&|p| (p - *point).dot(normal) >= -rounding)
            }
            Self::Union(parts) => {
                let mut all = Vec::new();
                for part in parts {
                    all.extend(part.select(mesh)?);
                }
                all
            }
            Self::Intersection(parts) => {
                let mut counts = vec![0; nodes.len()];
                for part in parts {
                    let mut selected = part.select(mesh)?;
                    selected.sort_unstable();
                    selected.dedup();
                    for node in selected {
                        counts[node as usize] += 1;
                    }
                }
                (0..nodes.len() as u32).filter(|&node| counts[node as usize] == parts.len()).collect()
            }
        })
    }

    fn impossible(&self, why: &'static str) -> RegionError {
        RegionError::Impossible { region: self.describe(), why }
    }

    fn empty(&self, mesh: &VolumeMesh) -> RegionError {
        let nodes = mesh.nodes();
        let (low, high) = mesh.bounds();
        let nearest = nearest(nodes, self.place(mesh)).unwrap_or(0);
        RegionError::Empty {
            region: self.describe(),
            nearest,
            at: nodes.get(nearest as usize).copied().unwrap_or(Point::ZERO).to_array(),
            low: low.to_array(),
            high: high.to_array(),
        }
    }

    /// A place in the middle of the region, to measure distances from.
    fn place(&self, mesh: &VolumeMesh) -> Point {
        match self {
            Self::Nearest(place) | Self::Plane { point: place, .. } | Self::HalfSpace { point: place, .. } => *place,
            Self::Sphere { centre, .. } => *centre,
            Self::Box { low, high } => (*low + *high) * 0.5,
            Self::Union(parts) | Self::Intersection(parts) if !parts.is_empty() => parts[0].place(mesh),
            _ => {
                let (low, high) = mesh.bounds();
                (low + high) * 0.5
            }
        }
    }

    /// The region in words.
    pub fn describe(&self) -> String {
        let at = |p: &Point| format!("({}, {}, {})", p.x, p.y, p.z);
        match self {
            Self::All => "`all`".into(),
            Self::Surface => "`surface`".into(),
            Self::Named(name) => format!("`{name}`"),
            Self::Nodes(list) => format!("of {} nodes", list.len()),
            Self::Nearest(place) => format!("nearest to {} m", at(place)),
            Self::Box { low, high } => format!("box from {} to {} m", at(low), at(high)),
            Self::Sphere { centre, radius } => format!("sphere of radius {radius} m around {} m", at(centre)),
            Self::Plane { point, normal, .. } => format!("plane through {} m with normal {}", at(point), at(normal)),
            Self::HalfSpace { point, normal } => {
                format!("half-space from {} m along {}", at(point), at(normal))
            }
            Self::Union(parts) => parts.iter().map(Self::describe).collect::<Vec<_>>().join(" or "),
            Self::Intersection(parts) => parts.iter().map(Self::describe).collect::<Vec<_>>().join(" and "),
        }
    }
}

fn nearest(nodes: &[Point], place: Point) -> Option<u32> {
    let distance = |node: u32| (nodes[node as usize] - place).squared_norm();
    (0..nodes.len() as u32).min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
}

fn named_nodes(mesh: &VolumeMesh, name: &str) -> Result<Vec<u32>, RegionError> {
    let (nodes, names): (Option<&Vec<u32>>, Vec<&String>) = match mesh {
        VolumeMesh::Tet(mesh) => (mesh.regions.get(name).map(|r| &r.nodes), mesh.regions.keys().collect()),
        VolumeMesh::Hex(mesh) => (mesh.regions.get(name).map(|r| &r.nodes), mesh.regions.keys().collect()),
    };
    nodes.cloned().ok_or_else(|| {
        let list = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let known = if list.is_empty() { "it has no named regions at all".into() } else { format!("it has {list}") };
        RegionError::UnknownName { name: name.into(), known }
    })
}

fn named_cells(mesh: &VolumeMesh, name: &str) -> Vec<u32> {
    match mesh {
        VolumeMesh::Tet(mesh) => mesh.regions.get(name).map(|region| region.cells.clone()),
        VolumeMesh::Hex(mesh) => mesh.regions.get(name).map(|region| region.cells.clone()),
    }
    .unwrap_or_default()
}

/// Faces of a named region, each with ascending nodes, in ascending order.
fn named_faces(mesh: &VolumeMesh, name: &str) -> Vec<Vec<u32>> {
    let mut faces: Vec<Vec<u32>> = match mesh {
        VolumeMesh::Tet(mesh) => {
            mesh.regions.get(name).map(|region| region.faces.iter().map(|face| face.to_vec()).collect())
        }
        VolumeMesh::Hex(mesh) => {
            mesh.regions.get(name).map(|region| region.faces.iter().map(|face| face.to_vec()).collect())
        }
    }
    .unwrap_or_default();
    for face in &mut faces {
        face.sort_unstable();
    }
    faces.sort_unstable();
    faces
}
