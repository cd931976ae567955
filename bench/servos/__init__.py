"""Position-controlled servos: gains, dead time and limits from goal and measured position."""
