# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What Sherd found and repaired in a mesh, as sentences for the user."""


def counted(number, one, many=None):
    return f"{number} {one if number == 1 else many or one + 's'}"


def sentences(name, manifest):
    """A sentence for each kind of defect that was repaired, and for what came out otherwise than asked."""
    report, found = manifest.get("report") or {}, []
    get = lambda key: report.get(key) or 0
    if report.get("fill") == "shell":
        found.append(f"{name} encloses nothing and became a shell {report.get('shell_thickness', 0):.3g} thick")
    elif get("boundary_edges"):
        found.append(f"{name} has {counted(get('boundary_edges'), 'open edge')}; its holes were filled")
    if get("non_manifold_edges"):
        found.append(f"{name} has {counted(get('non_manifold_edges'), 'edge')} of more than two faces; "
                     "the inside was found by winding numbers")
    turned = get("flipped_triangles") or get("misoriented_edges")
    if turned:
        found.append(f"faces of {name} were turned around, to agree with their neighbors")
    dropped = get("degenerate_triangles") + get("zero_area_triangles") + get("duplicate_triangles") - get("sheet_triangles")
    if dropped:
        found.append(f"{counted(dropped, 'face')} of {name} without area or repeated were left out")
    if get("sheet_thickness"):
        found.append(f"{counted(get('sheet_triangles'), 'face')} of {name} on both sides of sheets, as of leaves, became shells {get('sheet_thickness'):.3g} thick")
    elif get("sheet_triangles") and report.get("fill") != "shell":
        found.append(f"{counted(get('sheet_triangles'), 'face')} of {name} on both sides of sheets are so few that they were left out")
    if get("bridges"):
        found.append(f"walls of {name} thinner than a voxel were thickened ({counted(get('bridges'), 'voxel')})")
    if get("near_bodies"):
        found.append(f"{get('near_bodies')} parts of {name} closer than a voxel to others were kept apart")
    if manifest.get("pieces_asked"):
        found.append(f"{name} has {counted(manifest['components'], 'separate part')}, and so more pieces than the "
                     f"{manifest['pieces_asked']} asked for")
    return found
