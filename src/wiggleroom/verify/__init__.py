"""Checking a certificate: nothing here is shared with what found it."""
