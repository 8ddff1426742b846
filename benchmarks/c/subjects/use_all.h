/* Three subjects in one program, whose headers are RN1, ATRV and MATTY, each with its own link. */
#define decoder rn1_decoder
#define take rn1_take
#define taken rn1_taken
#define load rn1_load
#define store rn1_store
#define subject_init rn1_init
#define subject_push rn1_push
#define subject_feed rn1_feed
#define subject_encode rn1_encode
#include RN1
#include "use_all_undef.h"

#define decoder atrv_decoder
#define take atrv_take
#define taken atrv_taken
#define load atrv_load
#define store atrv_store
#define subject_init atrv_init
#define subject_push atrv_push
#define subject_feed atrv_feed
#define subject_encode atrv_encode
#include ATRV
#include "use_all_undef.h"

#define decoder matty_decoder
#define take matty_take
#define taken matty_taken
#define load matty_load
#define store matty_store
#define subject_init matty_init
#define subject_push matty_push
#define subject_feed matty_feed
#define subject_encode matty_encode
#include MATTY
#include "use_all_undef.h"

static inline void subject_init(void) {
    rn1_init();
    atrv_init();
    matty_init();
}

static inline void subject_push(uint8_t byte) {
    rn1_push(byte);
    atrv_push(byte);
    matty_push(byte);
}

static inline size_t subject_encode(uint8_t which, uint8_t *frame, size_t capacity) {
    if (which < 2u) {
        return rn1_encode(which, frame, capacity);
    }
    return which < 4u ? atrv_encode((uint8_t)(which - 2u), frame, capacity)
                      : matty_encode(0, frame, capacity);
}
