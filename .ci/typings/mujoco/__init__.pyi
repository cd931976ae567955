# MuJoCo's compiled modules carry no types; pyright takes their names as given.
from typing import Any

def __getattr__(name: str) -> Any: ...
