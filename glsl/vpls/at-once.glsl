// Texels whose importance an invocation works out at once: a view sample is handed round once for them. With four, a software driver takes
// longer to hand samples round than to sum their terms.
const uint AT_ONCE = 16u;
