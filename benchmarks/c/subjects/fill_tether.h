/* Random values, into the structs of protogen or of the expert: their fields have the same names. */
#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        struct FILLED(report) *const report = BENCH_MESSAGE;
        report->length = bench_random();
        report->speed = (int16_t)((int32_t)(bench_random() % 6001u) - 3000);
        report->tension = (uint16_t)bench_random();
    } else {
        struct FILLED(alarm) *const alarm = BENCH_MESSAGE;
        alarm->reason = (uint8_t)bench_random();
        alarm->count = (uint16_t)bench_random();
    }
}
#endif
#undef FILLED
