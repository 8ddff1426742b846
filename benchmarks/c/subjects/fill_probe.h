/* Random values, into the structs of protogen or of the expert: their fields have the same names. */
#if defined(BENCH_FILL)
static void subject_fill(uint8_t which) {
    if (which == 0) {
        struct FILLED(attitude) *const attitude = BENCH_MESSAGE;
        attitude->time = bench_random();
        attitude->roll = (int16_t)((int32_t)(bench_random() % 36001u) - 18000);
        attitude->pitch = (int16_t)((int32_t)(bench_random() % 18001u) - 9000);
        attitude->yaw = (int16_t)((int32_t)(bench_random() % 36001u) - 18000);
    } else {
        struct FILLED(power) *const power = BENCH_MESSAGE;
        power->voltage = (uint16_t)bench_random();
        power->current = (int16_t)bench_random();
        power->charge = (uint8_t)(bench_random() % 101u);
    }
}
#endif
#undef FILLED
