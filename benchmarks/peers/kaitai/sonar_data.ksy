meta: {id: sonar_data, endian: be}
seq:
  - {id: unknown, type: u4}
  - {id: timestamp, type: u4}
  - {id: readings, type: reading, repeat: eos}
types:
  reading:
    seq:
      - {id: cluster, type: u1}
      - {id: distance, type: u2}
