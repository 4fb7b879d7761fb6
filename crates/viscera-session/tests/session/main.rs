//! A session as a page has it: bytes in, bytes out.

mod hostile;
mod messages;
mod parameters;
mod pictures;
mod play;
mod recordings;
mod support;
mod trocars;
