"""Cutting sheets that were put together: JSON, tables, pictures."""
