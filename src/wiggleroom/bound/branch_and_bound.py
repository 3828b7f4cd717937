class BranchAndBound: pass
