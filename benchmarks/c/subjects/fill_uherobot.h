/* Random values, into the structs of protogen or of the expert: their fields have the same names. */
#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    struct FILLED(status) *const status = BENCH_MESSAGE;
    (void)which;
    status->voltage = (int16_t)bench_random();
    status->current = (int16_t)bench_random();
    status->temperature = (int16_t)bench_random();
}
#endif
#undef FILLED
