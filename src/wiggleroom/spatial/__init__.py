"""Rigid parts with six freedoms: from files of format wiggleroom/2 to answers."""
