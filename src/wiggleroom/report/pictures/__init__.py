"""Still pictures as SVG text, and what they are made of."""
