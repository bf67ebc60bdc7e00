"""Reports of checks."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path

from .page import framed


class Result:
    """The result of one query under one setting. Every field of the JSON is an attribute, or a key: `result["witnesses"]`."""

    def __init__(self, fields: dict):
        self._fields = fields

    @property
    def name(self) -> str | None:
        """The name of the property asked about, if it is one."""
        return self._fields["name"]

    @property
    def query(self) -> str:
        """The query as written."""
        return self._fields["query"]

    @property
    def verdict(self) -> str | None:
        """`satisfied`, `violated` or `undecided`; None of queries that decide nothing."""
        return self._fields["verdict"]

    @property
    def estimate(self) -> float | None:
        """The estimate, in `unit`."""
        return self._fields["estimate"]

    @property
    def low(self) -> float | None:
        """Lower end of the interval, in `unit`."""
        return self._fields["low"]

    @property
    def high(self) -> float | None:
        """Upper end of the interval, in `unit`."""
        return self._fields["high"]

    @property
    def certificate(self) -> str | None:
        """The certified statement with its error; None where nothing is certified."""
        return self._fields["certifies"] or None

    @property
    def options(self) -> list[dict]:
        """Of a ranking its options, the chosen one first."""
        return self._fields.get("options", [])

    def __getitem__(self, key: str):
        return self._fields[key]

    def __getattr__(self, key: str):
        if key.startswith("_"):
            raise AttributeError(key)
        try:
            return self._fields[key]
        except KeyError:
            raise AttributeError(f"a result has no `{key}`; it has {', '.join(self._fields)}") from None

    def __dir__(self):
        return [*super().__dir__(), *self._fields]

    def to_dict(self) -> dict:
        """All fields, as in the JSON."""
        return self._fields

    def __repr__(self) -> str:
        low, high = ("unknown" if end is None else f"{end:.4g}" for end in (self.low, self.high))
        shown = self.verdict or ("nothing" if self.estimate is None else f"{self.estimate:.4g}")
        unit = f" {self._fields['unit']}" if self._fields["unit"] else ""
        return f"<smc.Result {self.query!r}: {shown}, {low} .. {high}{unit}>"


class Report:
    """The results of a check, in the order of the queries; a swept query has one for each point."""

    def __init__(self, inner):
        self._inner = inner

    @cached_property
    def json(self) -> str:
        """The JSON of `smc check --format json`."""
        return self._inner.json()

    @cached_property
    def _fields(self) -> dict:
        return json.loads(self.json)

    def to_dict(self) -> dict:
        """The JSON as a dictionary."""
        return self._fields

    @cached_property
    def results(self) -> list[Result]:
        """The results."""
        return [Result(fields) for fields in self._fields["results"]]

    @property
    def satisfied(self) -> bool:
        """Whether every check is satisfied and every other query got what it asks."""
        return self._inner.is_satisfied()

    @property
    def interrupted(self) -> bool:
        """Whether sampling was interrupted: the intervals are those of the trials so far."""
        return self._fields["interrupted"]

    @property
    def warnings(self) -> str:
        """Warnings about the texts, as the program prints them."""
        return self._inner.warnings()

    def to_pandas(self):
        """A DataFrame of pandas: a row for each result, and a column for each parameter of a sweep."""
        import pandas

        return pandas.DataFrame(self._rows())

    def to_polars(self):
        """A DataFrame of polars, with the same rows."""
        import polars

        return polars.DataFrame(self._rows())

    def _rows(self) -> list[dict]:
        fields = ("name", "query", "kind", "verdict", "estimate", "low", "high", "unit", "trials", "unresolved", "stopped_by")
        rows = []
        for result in self.results:
            settings = {key: value["value"] if isinstance(value, dict) else value for key, value in result["settings"].items()}
            rows.append({**settings, **{field: result.to_dict().get(field) for field in fields}})
        return rows

    def page(self) -> str:
        """The page of `smc check --report`: tables, figures, and a player of the trials behind the results, which run again."""
        return self._inner.page()

    def save(self, path: str | os.PathLike) -> None:
        """Writes the page (`.html`), the JSON (`.json`) or the text."""
        ending = Path(path).suffix.lower()
        text = {".html": self.page, ".json": lambda: self.json}.get(ending, lambda: str(self))()
        Path(path).write_text(text, encoding="utf-8")

    def __len__(self) -> int:
        return len(self.results)

    def __iter__(self):
        return iter(self.results)

    def __getitem__(self, key: int | str) -> Result:
        """The result of a number, or the first one about a property of this name."""
        if isinstance(key, str):
            for result in self.results:
                if result.name == key:
                    return result
            raise KeyError(key)
        return self.results[key]

    def __str__(self) -> str:
        return self._inner.text().rstrip()

    def __repr__(self) -> str:
        return f"<smc.Report: {len(self)} results>"

    def _repr_html_(self) -> str:
        return framed(self.page(), 'report.save("report.html")')
