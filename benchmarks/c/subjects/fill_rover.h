/* Random values, into the structs of protogen or of the expert: their fields have the same names. */
#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    (void)which;
    struct FILLED(state) *const state = BENCH_MESSAGE;
    state->mode = (uint8_t)(bench_random() % 3u);
    state->battery = (uint16_t)bench_random();
    state->heading = (int16_t)bench_random();
}
#endif
#undef FILLED
