//! Part of [Viscera](viscera).
