// Written by keywords.mjs from the table of keywords. Do not edit.
// A line that begins with one of these words goes on with the line before.
static const char *const CONTINUES[] = {"as", "at", "by", "confidence", "except", "for", "from", "hole", "id", "in", "of", "preset", "radius", "subject", "then", "to", "under", "where", "with", "within", 0};
static const char *const UNITS[] = {"m", "cm", "mm", "km", "s", "ms", "min", "h", "kg", "g", "N", "kN", "deg", "rad", "Hz", "steps", "step", 0};
