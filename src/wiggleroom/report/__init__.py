"""Answers for people and programs: pictures, tables, records; none of them changes what was found."""
