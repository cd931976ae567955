"""servobench: a physics-backed test bench for a servo axis."""

__version__ = "0.1.0"
