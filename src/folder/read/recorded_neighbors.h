// Neighbors that the meshes of a folder without a manifest record.
#pragma once

#include <sherd/evaluate.h>

namespace sherd {

/// Keeps the neighbors of meshes if they agree with each other, else removes them.  Their ids are
/// the numbers at the ends of the files' names, which fragments then get as ids, or else places in
/// the list, from 1, where some of the fragments touch by them.  They agree if every mesh has
/// neighbors, not all 0, none is its own, and the areas of both sides of the contacts within the
/// set differ by at most a fifth in all; so they do not in a folder of several fractures, or where
/// files were renamed.
void keepAgreeingNeighbors(FragmentSet& set);

}  // namespace sherd
