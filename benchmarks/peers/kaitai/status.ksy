meta: {id: status, endian: le}
seq:
  - {id: status, type: u1}
  - {id: mode, type: u1, enum: mode}
  - {id: voltage, type: u2}
  - {id: current, type: u2}
  - {id: speed, type: s2}
  - {id: angle, type: s2}
  - {id: encoder0, type: u2}
  - {id: encoder1, type: u2}
  - {id: encoder2, type: u2}
  - {id: encoder3, type: u2}
enums:
  mode: {0: idle, 1: remote, 2: autonomous}
