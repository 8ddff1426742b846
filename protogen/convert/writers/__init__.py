"""Tables as files: JSON lines, CSV, Parquet, Arrow and MCAP."""
