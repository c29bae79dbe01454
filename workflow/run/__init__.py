"""The engine of a run: plan, lock, record, log, files and progress; it is independent of the stages, which are its
arguments.
"""
