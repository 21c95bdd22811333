//! The derives of job documents.
