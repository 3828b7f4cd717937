class ProofNode: pass
