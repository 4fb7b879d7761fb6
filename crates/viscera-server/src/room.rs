//! Who is connected: the one that came first controls, the others watch.

use tokio::sync::watch;
use viscera_session::message::Role;

/// Connections by number, in the order in which they came.
#[derive(Clone, Debug)]
pub(crate) struct Room {
    guests: watch::Sender<Guests>,
}

/// Those that are connected.
#[derive(Clone, Debug, Default)]
pub(crate) struct Guests {
    next: u64,
    present: Vec<u64>,
}

/// A place in the room, left when it is dropped.
pub(crate) struct Seat {
    number: u64,
    room: Room,
    pub(crate) changes: watch::Receiver<Guests>,
}

impl Room {
    pub(crate) fn new() -> Self {
        Self { guests: watch::Sender::new(Guests::default()) }
    }

    /// Takes the last place.
    pub(crate) fn enter(&self) -> Seat {
        let mut number = 0;
        self.guests.send_modify(|guests| {
            number = guests.next;
            guests.next += 1;
            guests.present.push(number);
        });
        Seat { number, room: self.clone(), changes: self.guests.subscribe() }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.guests.borrow().present.is_empty()
    }
}

impl Seat {
    /// What the one that sits here may do, and how many there are.
    pub(crate) fn role(&self) -> (Role, usize) {
        let guests = self.room.guests.borrow();
        let role = if guests.present.first() == Some(&self.number) { Role::Controller } else { Role::Watcher };
        (role, guests.present.len())
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.room.guests.send_modify(|guests| guests.present.retain(|&guest| guest != self.number));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_has_watched_longest_takes_over() {
        let room = Room::new();
        let [first, second, third] = std::array::from_fn(|_| room.enter());
        assert_eq!(first.role(), (Role::Controller, 3));
        assert_eq!(second.role(), (Role::Watcher, 3));
        drop(first);
        assert_eq!((second.role(), third.role()), ((Role::Controller, 2), (Role::Watcher, 2)));
        drop((second, third));
        assert!(room.is_empty());
    }
}
