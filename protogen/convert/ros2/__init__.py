"""Tables as ROS 2 messages: their definitions, and their bytes (CDR)."""
