//! `cargo bench -p viscera-benches --bench precomputed`: how often in a second a pre-computed organ of about 1 400 nodes answers, with 1, 5 and 20
//! nodes imposed: the small system alone, and with it the places of all nodes; and a whole step of a world with a rod in it.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, Throughput};
use viscera::body::Body;
use viscera::curve::Curve;
use viscera::executor::Executor;
use viscera::instrument::{Probe, Shaft};
use viscera::material::{LinearElastic, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::Precomputed;
use viscera::model::precomputed::{ContactSystem, Responses};
use viscera::solver::Envelope;
use viscera::world::{World, WorldConfig};

/// Length and edge of the organ [m].
const ORGAN: (f64, f64) = (0.3, 0.0165);

fn organ() -> Result<Body, Box<dyn std::error::Error>> {
    let tissue = Tissue::uniform(LinearElastic::from_young_poisson(5e3, 0.4)?);
    let mesh = TetMesh::liver(ORGAN.0, ORGAN.1)?;
    Ok(Body::new(mesh, 1060.0).model(Precomputed::new(tissue)).fix(Region::Named("back".into())))
}

/// A rod that dents the left lobe.
fn rod() -> Result<Probe, Box<dyn std::error::Error>> {
    let path = Curve::piecewise_linear(vec![(0.0, Vec3::new(0.06, 0.15, 0.01)), (0.1, Vec3::new(0.06, 0.048, 0.01))])?;
    Ok(Probe { path, shaft: Shaft { radius: 0.008, length: 0.2 }, ..Probe::default() })
}

fn answers(criterion: &mut Criterion, responses: &Responses) {
    let handles = responses.handles();
    let mut group = criterion.benchmark_group("precomputed");
    group.throughput(Throughput::Elements(1));
    for count in [1, 5, 20] {
        let nodes: Vec<u32> = handles.iter().copied().step_by(handles.len() / count).take(count).collect();
        let ways: Vec<_> = nodes.iter().map(|_| Vec3::new(1e-3, 2e-3, -1e-3)).collect();
        let mut places = vec![Vec3::ZERO; responses.node_count()];
        let mut system = ContactSystem::with_room(count);
        let name = format!("{} nodes, {} handles", responses.node_count(), handles.len());
        group.bench_function(BenchmarkId::new(format!("new contacts and places, {name}"), count), |bencher| {
            bencher.iter(|| {
                // Other nodes first, so that the system is factored anew.
                system.impose(responses, &[]).and_then(|()| system.impose(responses, black_box(&nodes)))?;
                places.fill(Vec3::ZERO);
                system.displace(responses, black_box(&ways), &mut places);
                Ok::<_, viscera::model::precomputed::ContactError>(places[0])
            });
        });
    }
    group.finish();
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut criterion = Criterion::default().configure_from_args();
    let responses = Arc::new(organ()?.precompute(&mut Envelope::default(), &Executor::serial(), &|_, _| ())?);
    answers(&mut criterion, &responses);
    let tissue = Tissue::uniform(LinearElastic::from_young_poisson(5e3, 0.4)?);
    let mut world = World::<f64>::new(WorldConfig { gravity: [0.0; 3], step: 1e-3, ..WorldConfig::default() })?;
    world.add(organ()?.model(Precomputed::new(tissue).responses(responses)))?;
    let tool = world.add_instrument(rod()?)?;
    for _ in 0..120 {
        world.step()?;
    }
    let contacts = world.observe_instrument(tool).contacts;
    let mut group = criterion.benchmark_group("precomputed");
    group.throughput(Throughput::Elements(1));
    group.bench_function(BenchmarkId::new("step with a rod that touches points", contacts), |bencher| {
        bencher.iter(|| world.step().map(|report| report.time));
    });
    group.finish();
    criterion.final_summary();
    Ok(())
}
