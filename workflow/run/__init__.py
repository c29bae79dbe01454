"""Runs stages: plan, lock, record, log, files and progress. This package is independent of the stages, which are its
arguments.
"""
