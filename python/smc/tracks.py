"""Recordings from DataFrames."""

import io


def csv_of(frame) -> bytes:
    """A DataFrame of pandas or polars as the table of a recording."""
    if not hasattr(frame, "to_csv") and hasattr(frame, "write_csv"):
        return frame.write_csv().encode()
    if not hasattr(frame, "to_csv"):
        raise TypeError("expected a DataFrame of pandas or polars")
    for column in ("id", "x", "y"):
        if column not in frame.columns:
            raise ValueError(f"the DataFrame has no column `{column}`; its columns are {', '.join(map(str, frame.columns))}")
    if not {"t", "time", "frame"} & set(frame.columns):
        raise ValueError("the DataFrame has neither a column `t` (or `time`) in s nor a column `frame`")
    frame = frame.rename(columns={"t": "time"})
    for column in frame.columns:
        values = frame[column]
        wrong = values.isna()
        if values.dtype.kind == "f":
            wrong |= values.abs() == float("inf")
        if wrong.any() and column in ("id", "time", "frame", "x", "y"):
            row = int(wrong.to_numpy().argmax())
            raise ValueError(f"row {row}: `{column}` is {values.iloc[row]}")
    out = io.StringIO()
    frame.to_csv(out, index=False)
    return out.getvalue().encode()
