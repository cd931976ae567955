"""Programs that other simulators' environments run: no bench is there, nor MuJoCo 4. Each prints velocities as JSON."""
