"""Writers of files, one format each."""
