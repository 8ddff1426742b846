"""Captures made into tables: JSON lines, CSV, Parquet, Arrow, MCAP.

    inputs -> chunks of bytes with times -> batches of rows -> one writer

`inputs.py` and its neighbours find out what a capture is and read it; `tables.py` says which
columns each message has; `batches.py` decodes; `writers.py` names the formats; `run.py` puts
finished files in their places.
"""
