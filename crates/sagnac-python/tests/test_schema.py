"""Objects of rows and limits against the schema of results."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path

import pytest

from sagnac import Limit, Measurand

SCHEMA = json.loads((Path(__file__).parents[3] / "schemas" / "result.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("kind", "record", "of_members"),
    [(Measurand, "MeasurandRecord", {"level": "interval"}), (Limit, "LimitRecord", {})],
)
def test_attributes_are_members_of_the_record(
    kind: type[Measurand | Limit], record: str, of_members: dict[str, str]
) -> None:
    members = SCHEMA["$defs"][record]["properties"]
    for field in fields(kind):
        member = members.get(of_members.get(field.name, field.name))
        assert member is not None, f"{record} has no {field.name}"
        alternatives = [each.get("type") for each in member.get("anyOf", [])]
        may_be_null = "null" in alternatives or "null" in member.get("type", [])
        assert ("None" in str(field.type)) == may_be_null, f"{field.name}: {field.type}"
