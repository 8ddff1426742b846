/* A random value, which is the whole message for protogen and for the expert. */
#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    (void)which;
    *(uint8_t *)BENCH_MESSAGE = (uint8_t)bench_random();
}
#endif
