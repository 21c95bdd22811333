//! Derives by which a field of a job document and a scalar of a result are declared once, as a field of a struct.

mod input;
mod result;
