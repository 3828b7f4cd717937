"""Questions asked while parts are dragged and gaps are changed."""
