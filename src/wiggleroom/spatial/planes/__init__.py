"""The program over bodies and separating planes, and its interior-point method."""
