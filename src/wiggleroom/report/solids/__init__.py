"""Answers in space: tables, pictures, films, models."""
