"""Questions asked while somebody drags and slides."""
