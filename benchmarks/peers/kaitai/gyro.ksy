meta: {id: gyro, endian: le}
seq:
  - {id: status, type: u1}
  - {id: x, type: u2}
  - {id: y, type: u2}
  - {id: z, type: u2}
instances:
  int_x: {value: '(((x & 0x7f) | ((x >> 1) & 0x3f80)) ^ 0x2000) - 0x2000'}
  int_y: {value: '(((y & 0x7f) | ((y >> 1) & 0x3f80)) ^ 0x2000) - 0x2000'}
  int_z: {value: '(((z & 0x7f) | ((z >> 1) & 0x3f80)) ^ 0x2000) - 0x2000'}
