"""How often intervals hold the truth: nulls over all motions, rich and poor, and axes whose model lacks an effect."""
