"""How solids, fractures and fragments are pickled: functions that make them again, and what those are given."""

from __future__ import annotations

import copyreg
import json
from typing import Any

from . import _core, _jobs, _options, _state
from ._break import load
from ._errors import InputError
from ._fracture import Fracture
from ._fragment import Fragment
from ._made import DEVICE
from ._solid import Solid, break_solid, pieces_and_seed


def solid_again(*state: Any) -> Solid:
    """Returns a solid that was pickled."""
    (content,) = _state.only("solid", state, bytes)
    obj, given = _core.object_of_state(content)
    with _state.restoring("solid"):
        return Solid(_jobs.finish(_core.voxelize(obj, given, DEVICE)))


def broken_again(*state: Any) -> Fracture:
    """Returns a fracture that was pickled."""
    solid, sealed = _state.only("fracture", state, Solid, bytes)
    content = _core.content_of("fracture", sealed)
    with _state.restoring("fracture"):
        options, identity = json.loads(content)
        if identity != solid._identity:
            raise InputError("this pickle of a fracture is damaged: it has the solid of another fracture")
        given = [(name, text) for name, text in options]
        _core.check_options(given)
        return next(break_solid(solid._core, given, [pieces_and_seed(given)], DEVICE, None))


def parts_again(*state: Any) -> Fracture:
    """Returns a fracture that was pickled, of fragments that were broken again."""
    before, sealed = _state.only("fracture", state, Fracture, bytes)
    content = _core.content_of("fracture", sealed)
    with _state.restoring("fracture"):
        ids, options = json.loads(content)
        given = [(name, text) for name, text in options]
        _core.check_options(given)
        if not ids:
            raise InputError("this pickle of a fracture is damaged: it names no fragment that was broken again")
        return before._broken(list(ids), given, DEVICE, None)


def loaded_again(*state: Any) -> Fracture:
    """Returns a loaded fracture that was pickled: reads its folder."""
    (sealed,) = _state.only("fracture", state, bytes)
    content = _core.content_of("fracture", sealed)
    with _state.restoring("fracture"):
        return load(json.loads(content))


def fragment_again(*state: Any) -> Fragment:
    """Returns a fragment that was pickled."""
    fracture, sealed = _state.only("fragment", state, Fracture, bytes)
    content = _core.content_of("fragment", sealed)
    with _state.restoring("fragment"):
        return Fragment(fracture, range(len(fracture)).index(int(content)))


def _solid_state(solid: Solid) -> tuple[Any, ...]:
    return solid_again, (solid._core.state,)


def _fracture_state(fracture: Fracture) -> tuple[Any, ...]:
    if fracture._before is not None:
        assert isinstance(fracture._core, _core.GrownPieces)
        before, ids = fracture._before
        return parts_again, (before, _state.sealed("fracture", json.dumps([ids, fracture._core.given]).encode()))
    if isinstance(fracture._core, _core.LoadedPieces):
        return loaded_again, (_state.sealed("fracture", json.dumps(fracture._core.file).encode()),)
    solid = fracture.solid
    assert solid is not None and isinstance(fracture._core, _core.GrownPieces)
    return broken_again, (solid, _state.sealed("fracture", json.dumps([fracture._core.given, solid._identity]).encode()))


def _fragment_state(fragment: Fragment) -> tuple[Any, ...]:
    return fragment_again, (fragment._fracture, _state.sealed("fragment", str(fragment._index).encode()))


copyreg.pickle(Solid, _solid_state)  # type: ignore[arg-type]
copyreg.pickle(Fracture, _fracture_state)  # type: ignore[arg-type]
copyreg.pickle(Fragment, _fragment_state)  # type: ignore[arg-type]
