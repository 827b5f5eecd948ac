//! Ways over charts against places found among all triangles.
