#!/usr/bin/env python3
"""Damages pickles at random, and states whose checksum is made right again: each is an InputError or the same object, and nothing crashes.

usage: pickles.py [DAMAGES [SEED]]    (with a Python that has pysherd; 2000 and 0 by default)

Exceptions of pickle itself are counted apart: they come where a damage lies outside of our states, in the operations of pickle, a few tens of
bytes a pickle, or moves these: it cuts the end off, or leaves bytes out.
"""
import collections
import os
import pathlib
import pickle
import resource
import sys
import tempfile
import warnings

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "python"))
import damages  # noqa: E402

MOST_MEMORY = 6 << 30
GOOD = {"refused", "same", "python", "used", "refused later"}


def run_apart(work):
    """Runs work in a forked process, so that a crash is an outcome; returns what it printed, and its status."""
    read, write = os.pipe()
    pid = os.fork()
    if pid == 0:
        status = 1
        try:
            # A damaged operation may have pickle make a table of any size, which is a MemoryError then.
            resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
            with os.fdopen(write, "w") as out:
                work(lambda *line: print(*line, sep="\t", file=out, flush=True))
            status = 0
        finally:
            os._exit(status)
    os.close(write)
    with os.fdopen(read) as lines:
        printed = [line.rstrip("\n").split("\t") for line in lines]
    return printed, os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


def sweep(name, numbers, one):
    """Counts the outcomes of one(number); a number after which the process ended is a crash, and the others go on."""
    found = collections.Counter()
    todo = list(numbers)
    while todo:
        def work(say):
            for number in todo:
                say("begin", number)
                say("end", number, " ".join(one(number).split()))

        printed, status = run_apart(work)
        ended = [int(line[1]) for line in printed if line[0] == "end"]
        for line in printed:
            if line[0] == "end":
                found[line[2] if line[2] in GOOD else "FAULT"] += 1
                if line[2] not in GOOD:
                    print(f"{name}, {line[1]}: {line[2]}")
        todo = todo[len(ended):]
        if todo:
            print(f"{name}, {todo[0]}: the process ended with {status}")
            found["FAULT"] += 1
            todo = todo[1:]
    return found


def main():
    count, seed = (int(a) for a in (sys.argv[1:] + ["2000", "0"][len(sys.argv) - 1 :]))
    warnings.simplefilter("ignore")
    total, states = collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        subjects = damages.subjects(folder)
        for i, (name, value) in enumerate(subjects.items()):
            data = pickle.dumps(value)
            places = damages.states_in(data)
            expected = pickle.loads(data)

            def one(number):
                return damages.outcome(*damages.one(data, f"{seed} {name} {number}", places), expected)

            own = sweep(name, range(count * i // len(subjects), count * (i + 1) // len(subjects)), one)
            total += own
            print(f"{name}, {len(data)} bytes: {dict(own)}")
        solids = [name for name in ("textured", "arrays", "volume", "level set", "exact")]
        for i, name in enumerate(solids):
            value = subjects[name]
            state = (value if hasattr(value, "voxels") else value.solid)._core.state

            def one(number):
                return damages.forgery(state, damages.generator(f"{seed} forged {name} {number}"), folder / "out")

            own = sweep("forged " + name, range(count * i // len(solids) // 4, count * (i + 1) // len(solids) // 4), one)
            states += own
            print(f"forged {name}: {dict(own)}")
    print(f"{sum(total.values())} damages: {dict(total)}; {sum(states.values())} with a right checksum: {dict(states)}")
    sys.exit(bool(total["FAULT"] or states["FAULT"]))


if __name__ == "__main__":
    main()
