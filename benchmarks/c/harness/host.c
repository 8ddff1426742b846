/*
 * host frames WHICH COUNT       prints frames of random messages, in hex
 * host time WHICH COUNT BYTES   prints ns per frame of push, feed and encode over so many bytes
 * host stream                   reads a stream, prints after how many bytes each message came
 * host messages SIZE            reads a stream, feeds it in pieces of that size, 0: pushes each byte;
 *                               prints each message as the frame that is sent of it, in hex
 */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "bench.h"
#include SUBJECT

static size_t seen;
static size_t place;
static enum { NOTHING, PLACES, MESSAGES } prints;

static void print_frame(const uint8_t *frame, size_t size) {
    size_t index;
    for (index = 0; index < size; index++) {
        printf("%02x", frame[index]);
    }
    printf("\n");
}

static void bench_seen(uint8_t which) {
    seen++;
    if (prints == PLACES) {
        printf("%zu %d\n", place, which);
    } else if (prints == MESSAGES) {
        static uint8_t frame[4096];
        print_frame(frame, subject_encode(which, frame, sizeof frame));
    }
}

static uint8_t stream[1 << 20];
static size_t total;

static size_t make(uint8_t which, size_t count) {
    size_t index;
    total = 0;
    for (index = 0; index < count; index++) {
        subject_fill(which);
        total += subject_encode(which, &stream[total], sizeof stream - total);
    }
    return count;
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return (double)time.tv_sec * 1e9 + (double)time.tv_nsec;
}

static double push_all(size_t rounds) {
    const double start = now();
    size_t round;
    size_t index;
    for (round = 0; round < rounds; round++) {
        for (index = 0; index < total; index++) {
            subject_push(stream[index]);
        }
    }
    return now() - start;
}

static double feed_all(size_t rounds) {
    const double start = now();
    size_t round;
    for (round = 0; round < rounds; round++) {
        subject_feed(stream, total);
    }
    return now() - start;
}

static double encode_all(uint8_t which, size_t count) {
    static uint8_t frame[4096];
    volatile size_t sizes = 0;
    const double start = now();
    size_t index;
    for (index = 0; index < count; index++) {
        sizes += subject_encode(which, frame, sizeof frame);
    }
    return now() - start;
}

static int time_all(uint8_t which, size_t count, size_t bytes) {
    const size_t rounds = bytes / total + 1;
    const double frames = (double)(rounds * count);
    double push;
    double feed;
    push_all(1);
    feed_all(1);
    seen = 0;
    push = push_all(rounds);
    feed = feed_all(rounds);
    if (seen != 2 * rounds * count) {
        fprintf(stderr, "%zu messages of %zu\n", seen, 2 * rounds * count);
        return 1;
    }
    printf("%f %f %f %f\n", (double)total / (double)count, push / frames, feed / frames,
           encode_all(which, rounds * count) / frames);
    return 0;
}

static void print_messages(size_t piece) {
    const size_t size = fread(stream, 1, sizeof stream, stdin);
    size_t at = 0;
    prints = MESSAGES;
    while (at < size) {
        if (piece == 0) {
            subject_push(stream[at++]);
        } else {
            const size_t part = size - at < piece ? size - at : piece;
            subject_feed(&stream[at], part);
            at += part;
        }
    }
}

int main(int count, char **arguments) {
    subject_init();
    if (count == 2) {
        int byte;
        prints = PLACES;
        while ((byte = getchar()) != EOF) {
            place++;
            subject_push((uint8_t)byte);
        }
        return 0;
    }
    if (count == 3) {
        print_messages((size_t)atol(arguments[2]));
        return 0;
    }
    if (count == 4) {
        const uint8_t which = (uint8_t)atoi(arguments[2]);
        int index;
        for (index = 0; index < atoi(arguments[3]); index++) {
            make(which, 1);
            print_frame(stream, total);
        }
        return 0;
    }
    make((uint8_t)atoi(arguments[2]), (size_t)atoi(arguments[3]));
    return time_all((uint8_t)atoi(arguments[2]), (size_t)atoi(arguments[3]),
                    (size_t)atol(arguments[4]));
}
