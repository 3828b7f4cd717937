"""Parts drawn without gaps: locked, or free to begin to move."""
