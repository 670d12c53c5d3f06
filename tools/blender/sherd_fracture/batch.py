# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Breaks several objects one after another, in steps between which Blender reacts."""
import os
import time

import bpy

from .failure import Failure
from .glue import prune
from .job import Job
from .scene import file_name, select


class Batch:
    """The objects of one press of the button.  One that fails does not stop the others."""

    def __init__(self, keys, choices, positions):
        self.keys, self.choices, self.positions = keys, choices, positions
        self.context = self.job = None
        self.at, self.done, self.notes, self.failures = 0, [], [], []  # done: (object, names of its fragments)
        self.work = self.steps()

    def folder(self):
        """Where the files of an object are kept: below the user's folder, where there are several objects."""
        folder = self.choices.folder
        if not folder or self.choices.preview:  # those of the final are kept
            return ""
        if folder.startswith("//") and not bpy.data.filepath:
            raise Failure("the folder to keep files in is relative to the .blend file; save that first, or choose another")
        if len(self.keys) == 1:
            return folder
        names = [file_name(name) for name, _ in self.keys]
        return os.path.join(folder, names[self.at] + (f"_{self.at + 1}" if names.count(names[self.at]) > 1 else ""))

    def steps(self):
        """A generator: True where there is nothing to do but to wait."""
        for self.at, key in enumerate(self.keys):
            name = key[0]
            yield False  # so that the status bar names the object before its mesh is written
            try:
                with Job(self.context, key, self.choices, self.positions.get(key), self.folder()) as self.job:
                    while self.job.running():
                        yield True
                    for _ in self.job.fetch(self.context):
                        yield False
                    self.done.append((name, [fragment.name for fragment in self.job.fragments]))
                    self.notes += self.job.notes
            except Failure as failure:
                self.failures.append(str(failure))
            except OSError as error:
                self.failures.append(f"the fragments of {name} cannot be read: {error}")
            except ReferenceError:
                self.failures.append(f"{name} is not broken: the scene was changed meanwhile, as by undo")
            self.job = None
        prune(self.context)
        self.select(self.context)

    def select(self, context):
        """Selects the fragments, if there are any."""
        if self.done:
            select(context, [fragment for _, fragments in self.done for fragment in fragments])

    def step(self, context, seconds):
        """Works for some time.  Returns whether anything is left."""
        self.context, until = context, time.monotonic() + seconds
        for waits in self.work:
            if waits or time.monotonic() >= until:
                return True
        return False

    def wait(self, context):
        """Works to the end."""
        try:
            while self.step(context, 1):
                time.sleep(0.02)
        except KeyboardInterrupt:
            name = self.keys[self.at][0]
            self.stop(context)
            self.failures.append(f"breaking {name} was interrupted")

    def stop(self, context):
        """Stops, and removes what is not complete.  Objects that are done stay."""
        self.context = context
        self.work.close()
        self.job = None
        self.select(context)

    def share(self):
        """How much of all is done, 0 to 1."""
        return (self.at + (self.job.share() if self.job else 0)) / len(self.keys)

    def text(self):
        """For the status bar."""
        name = self.keys[self.at][0]
        count = f" ({self.at + 1} of {len(self.keys)})" if len(self.keys) > 1 else ""
        doing = self.job.doing() if self.job else "start"
        return f"Sherd breaks {name}{count}: {doing}, {100 * self.share():.0f} %; Esc stops it"

    def summary(self):
        count = sum(len(fragments) for _, fragments in self.done)
        of = self.done[0][0] if len(self.done) == 1 else f"{len(self.done)} objects"
        left = f"; {len(self.failures)} of {len(self.keys)} objects failed" if self.failures else ""
        return f"{count} fragments of {of}{left}"
