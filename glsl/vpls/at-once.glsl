// Texels whose importance an invocation works out at once: a view sample is read once for them.
const uint AT_ONCE = 16u;
