"""The engine of a run: plan, lock, record, log, files and progress; it knows no stage and is handed them."""
