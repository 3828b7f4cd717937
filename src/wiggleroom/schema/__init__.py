"""What results and messages hold, described once; JSON schemas, the page's types and the tables of the docs are generated from it."""
