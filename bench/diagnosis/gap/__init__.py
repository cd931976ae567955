"""The gap: what inertia, viscous and Coulomb friction leave of the torque, where a recording can tell."""
