//! The derives of results.
