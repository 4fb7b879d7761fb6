//! Memory is asked for before the first step.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use viscera::dynamics::implicit::{Implicit, Scheme};
use viscera::model::{TensorMass, TotalLagrangian};

use super::support::*;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

/// Counts what the running thread asks for.
struct Counting;

#[expect(unsafe_code, reason = "an allocator cannot be written without; both calls go straight to the system's")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// A step allocates nothing, whatever the scheme, the matrix and the model, nor does the first one.
#[test]
fn steps_allocate_nothing() {
    let schemes = [
        Implicit::default(),
        assembled(Implicit::default()),
        Implicit::accurate(Scheme::BackwardEuler),
        Implicit::accurate(Scheme::AVERAGE_ACCELERATION),
        assembled(Implicit::accurate(Scheme::Bdf2)),
        Implicit::accurate(Scheme::EnergyMomentum),
    ];
    for settings in schemes {
        let mut bodies = vec![bar_of(TotalLagrangian::new(tissue()))];
        if settings.scheme != Scheme::EnergyMomentum {
            bodies.push(bar_of(TensorMass::new(tissue())).keep_volume(5e3));
        }
        for body in bodies {
            let (mut world, _) = implicit_world(GRAVITY, 1e-2, settings, body.fix(root()).stiffness_damping(1e-3));
            let before = ALLOCATIONS.get();
            for _ in 0..3 {
                world.step().unwrap();
            }
            assert_eq!(ALLOCATIONS.get() - before, 0, "{settings:?}");
        }
    }
}
