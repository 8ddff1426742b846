"""Captures made into tables: JSON lines, CSV, Parquet, Arrow, MCAP with JSON or messages of ROS 2.

`inputs/` reads captures, `columns/` decodes them to tables, `writers/` writes these, and `runs/`
puts all together.
"""
