# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines by which sherd reports how far it is, as JSON on standard error."""
import json


class Progress:
    """The last line of progress of a file that grows."""

    def __init__(self):
        self.stage, self.overall, self.offset, self.rest = "", 0.0, 0, b""

    def read(self, path):
        """Reads what was added to the file since."""
        try:
            with open(path, "rb") as file:
                file.seek(self.offset)
                new = file.read()
        except OSError:
            return
        self.offset += len(new)
        *lines, self.rest = (self.rest + new).split(b"\n")
        for line in lines:
            found = parsed(line)
            if found:
                self.stage, self.overall = found[0], max(self.overall, found[1])


def parsed(line):
    """Stage and share of the whole run of a line of progress; None of any other line."""
    if not line.startswith(b"{"):
        return None
    try:
        found = json.loads(line)
        return str(found["stage"]), min(max(float(found["overall"]), 0.0), 1.0)
    except (ValueError, KeyError, TypeError):
        return None
