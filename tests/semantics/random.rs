//! Random formulas and metrics over lanes that start at different times and are filled again.
