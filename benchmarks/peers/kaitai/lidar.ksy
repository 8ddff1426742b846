meta: {id: lidar, endian: le}
seq:
  - {id: status, type: u1}
  - {id: codes, type: u2, repeat: expr, repeat-expr: 360}
