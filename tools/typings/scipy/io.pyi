from collections.abc import Mapping
from typing import IO, Any, Literal

def savemat(
    file_name: IO[bytes] | str, mdict: Mapping[str, Any], *, oned_as: Literal["row", "column"] = "row"
) -> None: ...
