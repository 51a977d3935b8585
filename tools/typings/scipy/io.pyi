from collections.abc import Mapping
from typing import IO, Any, Literal

def savemat(
    file_name: IO[bytes] | str, mdict: Mapping[str, Any], *, oned_as: Literal["row", "column"] = "row"
) -> None: ...
def loadmat(
    file_name: IO[bytes], *, struct_as_record: bool = True, squeeze_me: bool = False, mat_dtype: bool = False
) -> dict[str, Any]: ...
