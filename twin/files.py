"""The files of a diagnosis, by name; light to import, because a verb looks whether they can be written first of all."""

from __future__ import annotations

#: Everything that a diagnosis writes; `rounds.json` is the circle's.
FILES = ("diagnosis.json", "model.toml", "next.toml", "report.html", "diagnosis.rrd", "rounds.json")
