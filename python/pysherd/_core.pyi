# The extension module is internal: its functions are called by the package alone.
from typing import Any

def __getattr__(name: str) -> Any: ...
