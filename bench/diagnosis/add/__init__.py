"""Add what was named to the MuJoCo model, and keep what motion that was held out bears out."""
