"""Proofs in space: bounds that no motion exceeds, and bodies that are held."""
