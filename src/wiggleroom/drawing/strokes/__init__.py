"""What a drawing draws: strokes, curves, colours, layers."""
