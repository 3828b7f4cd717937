"""Questions about gaps, a file each: what is asked, how it is answered, and how the answer is told."""
