meta: {id: read_motor, endian: be}
seq:
  - {id: unknown, type: u4}
  - {id: timestamp, type: u4}
  - {id: axis, type: u1, enum: axis}
  - {id: position, type: s4}
  - {id: velocity, type: s4}
  - {id: acceleration, type: s4}
  - {id: torque, type: s4}
enums:
  axis: {0: linear, 1: angular}
