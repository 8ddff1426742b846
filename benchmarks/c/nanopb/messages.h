/* messages.proto for nanopb: a struct and a table for each message. Unused tables are dropped. */
#ifndef MESSAGES_H
#define MESSAGES_H

#include <pb_decode.h>
#include <pb_encode.h>

struct Gyro {
    uint8_t status;
    int16_t x;
    int16_t y;
    int16_t z;
};

struct Lidar {
    uint8_t status;
    pb_size_t distances_count;
    uint16_t distances[360];
};

struct ReadMotor {
    uint32_t unknown;
    uint32_t timestamp;
    uint8_t axis;
    int32_t position;
    int32_t velocity;
    int32_t acceleration;
    int32_t torque;
};

struct Reading {
    uint8_t cluster;
    uint16_t distance;
};

struct SonarData {
    uint32_t unknown;
    uint32_t timestamp;
    pb_size_t readings_count;
    struct Reading readings[17];
};

struct Status {
    uint8_t status;
    uint8_t mode;
    uint16_t voltage;
    uint16_t current;
    int16_t speed;
    int16_t angle;
    pb_size_t encoders_count;
    uint16_t encoders[4];
};

static const pb_field_t gyro_fields[] = {
    PB_FIELD(1, UINT32, REQUIRED, STATIC, FIRST, struct Gyro, status, status, 0),
    PB_FIELD(2, SINT32, REQUIRED, STATIC, OTHER, struct Gyro, x, status, 0),
    PB_FIELD(3, SINT32, REQUIRED, STATIC, OTHER, struct Gyro, y, x, 0),
    PB_FIELD(4, SINT32, REQUIRED, STATIC, OTHER, struct Gyro, z, y, 0),
    PB_LAST_FIELD,
};

static const pb_field_t lidar_fields[] = {
    PB_FIELD(1, UINT32, REQUIRED, STATIC, FIRST, struct Lidar, status, status, 0),
    PB_FIELD(2, UINT32, REPEATED, STATIC, OTHER, struct Lidar, distances, status, 0),
    PB_LAST_FIELD,
};

static const pb_field_t read_motor_fields[] = {
    PB_FIELD(1, FIXED32, REQUIRED, STATIC, FIRST, struct ReadMotor, unknown, unknown, 0),
    PB_FIELD(2, FIXED32, REQUIRED, STATIC, OTHER, struct ReadMotor, timestamp, unknown, 0),
    PB_FIELD(3, UINT32, REQUIRED, STATIC, OTHER, struct ReadMotor, axis, timestamp, 0),
    PB_FIELD(4, SFIXED32, REQUIRED, STATIC, OTHER, struct ReadMotor, position, axis, 0),
    PB_FIELD(5, SFIXED32, REQUIRED, STATIC, OTHER, struct ReadMotor, velocity, position, 0),
    PB_FIELD(6, SFIXED32, REQUIRED, STATIC, OTHER, struct ReadMotor, acceleration, velocity, 0),
    PB_FIELD(7, SFIXED32, REQUIRED, STATIC, OTHER, struct ReadMotor, torque, acceleration, 0),
    PB_LAST_FIELD,
};

static const pb_field_t reading_fields[] = {
    PB_FIELD(1, UINT32, REQUIRED, STATIC, FIRST, struct Reading, cluster, cluster, 0),
    PB_FIELD(2, UINT32, REQUIRED, STATIC, OTHER, struct Reading, distance, cluster, 0),
    PB_LAST_FIELD,
};

static const pb_field_t sonar_data_fields[] = {
    PB_FIELD(1, FIXED32, REQUIRED, STATIC, FIRST, struct SonarData, unknown, unknown, 0),
    PB_FIELD(2, FIXED32, REQUIRED, STATIC, OTHER, struct SonarData, timestamp, unknown, 0),
    PB_FIELD(3, MESSAGE, REPEATED, STATIC, OTHER, struct SonarData, readings, timestamp,
             reading_fields),
    PB_LAST_FIELD,
};

static const pb_field_t status_fields[] = {
    PB_FIELD(1, UINT32, REQUIRED, STATIC, FIRST, struct Status, status, status, 0),
    PB_FIELD(2, UINT32, REQUIRED, STATIC, OTHER, struct Status, mode, status, 0),
    PB_FIELD(3, UINT32, REQUIRED, STATIC, OTHER, struct Status, voltage, mode, 0),
    PB_FIELD(4, UINT32, REQUIRED, STATIC, OTHER, struct Status, current, voltage, 0),
    PB_FIELD(5, SINT32, REQUIRED, STATIC, OTHER, struct Status, speed, current, 0),
    PB_FIELD(6, SINT32, REQUIRED, STATIC, OTHER, struct Status, angle, speed, 0),
    PB_FIELD(7, UINT32, REPEATED, STATIC, OTHER, struct Status, encoders, angle, 0),
    PB_LAST_FIELD,
};

#endif
