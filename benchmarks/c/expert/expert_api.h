/* EXPERT_API is `static inline` where an application includes the source of an expert. */
#ifndef EXPERT_API
#define EXPERT_API
#endif

/* What runs once in a frame stands apart: inside of `push` its registers would be saved for each byte. */
#ifndef EXPERT_APART
#define EXPERT_APART __attribute__((noinline))
#endif
