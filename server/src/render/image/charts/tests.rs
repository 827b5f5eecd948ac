//! Sheets, seams and solids.
