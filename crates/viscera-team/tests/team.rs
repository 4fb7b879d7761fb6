//! Every part of every round is done once, whoever comes.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use viscera_team::Team;

const PARTS: usize = 37;

/// Does each of [`PARTS`] parts once and gives the sum of their numbers.
fn sum_of_parts(team: &Team) -> usize {
    let (next, sum) = (AtomicUsize::new(0), AtomicUsize::new(0));
    team.together(&|_| {
        loop {
            let part = next.fetch_add(1, Ordering::Relaxed);
            if part >= PARTS {
                break;
            }
            sum.fetch_add(part, Ordering::Relaxed);
        }
    });
    sum.into_inner()
}

const SUM: usize = PARTS * (PARTS - 1) / 2;

#[test]
fn every_part_of_a_hundred_thousand_rounds_is_done_once_on_one_two_and_five_threads() {
    for threads in [1, 2, 5] {
        let team = Team::new(threads).unwrap();
        assert_eq!(team.thread_count(), threads);
        let rounds = if threads == 5 { 2_000 } else { 100_000 };
        team.stand_ready(|| (0..rounds).for_each(|_| assert_eq!(sum_of_parts(&team), SUM)));
    }
}

#[test]
fn threads_that_slept_come_when_they_are_needed() {
    let team = Team::new(2).unwrap();
    for _ in 0..20 {
        std::thread::sleep(Duration::from_millis(2));
        // The caller waits for the other one, who is asleep when the round begins.
        let others = AtomicUsize::new(0);
        team.together(&|number| {
            if number == 0 {
                while others.load(Ordering::Acquire) == 0 {
                    std::thread::yield_now();
                }
            } else {
                others.fetch_add(1, Ordering::Release);
            }
        });
        assert_eq!(others.into_inner(), 1);
    }
}

#[test]
fn inside_of_a_round_the_caller_is_alone() {
    let team = Team::new(3).unwrap();
    let inner = AtomicUsize::new(0);
    team.together(&|number| {
        if number == 0 {
            team.together(&|number| {
                inner.fetch_add(number + 1, Ordering::Relaxed);
            });
        }
    });
    assert_eq!(inner.into_inner(), 1);
}

#[test]
fn callers_of_one_team_do_not_wait_for_each_other() {
    let team = Team::new(2).unwrap();
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| (0..5_000).for_each(|_| assert_eq!(sum_of_parts(&team), SUM)));
        }
    });
}

#[test]
fn a_panic_goes_on_in_the_caller_and_the_team_stays_good() {
    let team = Team::new(2).unwrap();
    for panicking in 0..2 {
        let met = AtomicUsize::new(0);
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            team.stand_ready(|| {
                team.together(&|number| {
                    // Both are in, or the one that is to panic might not come.
                    met.fetch_add(1, Ordering::AcqRel);
                    while met.load(Ordering::Acquire) < 2 {
                        std::thread::yield_now();
                    }
                    assert_ne!(number, panicking, "the panic of this test");
                });
            });
        }));
        assert!(outcome.is_err());
        assert_eq!(sum_of_parts(&team), SUM);
    }
}
