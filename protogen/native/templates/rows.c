
/* --- rows ---------------------------------------------------------------------------------------- */

/* Print the next row. */
static uint8_t *put_row(struct job *job, const struct rows *rows, uint8_t *out, const uint8_t *end);

/* Print rows of all tables by their offsets, as many as there is room for. Returns the bytes. */
PROTOGEN_EXPORT size_t protogen_print(struct job *job, struct rows *tables, size_t count, uint8_t *room,
                                      size_t size) {
    const uint8_t *const end = size < SLACK ? room : room + (size - SLACK);
    uint8_t *out = room;
    job->room = room;
    for (;;) {
        struct rows *first = NULL;
        uint64_t least = UINT64_MAX, limit = UINT64_MAX;
        size_t number;
        for (number = 0; number < count; number++) {
            struct rows *const table = &tables[number];
            if (table->next < table->count) {
                const uint64_t offset = offset_of(table);
                if (first == NULL || offset < least) {
                    limit = least;
                    least = offset;
                    first = table;
                } else if (offset < limit) {
                    limit = offset;
                }
            }
        }
        if (first == NULL) {
            return (size_t)(out - room);
        }
        do {
            uint8_t *const behind = put_row(job, first, out, end);
            if (behind == NULL) {
                return (size_t)(out - room);
            }
            out = behind;
            first->next++;
        } while (first->next < first->count && offset_of(first) < limit);
    }
}
