// Figures of real fragments and of models, from the literature: docs/realism.md has the same.
#include <sherd/evaluate.h>

namespace sherd {
namespace {

constexpr const char* kDomokos = "Domokos, Jerolmack, Kun, Török, PNAS 117:18178 (2020)";
constexpr const char* kMeijering = "Meijering 1953; Lazar et al., arXiv:1401.1736";
constexpr const char* kWittel = "Wittel et al., PRL 93:035504 (2004)";
constexpr const char* kPots = "counted on the scans of Structure-from-Sherds++, arXiv:2502.13986";
constexpr const char* kPlates = "physics.aps.org/story/v14/st5";
constexpr const char* kPonson = "Ponson, Bonamy, Bouchaud, PRL 96:035506 (2006)";

constexpr PublishedFigure kFigures[] = {
    {"interior_faces", 6.0, 6.0, "natural fragments in 3-D, mean", kDomokos},
    {"interior_faces", 6.63, 6.63, "556 pieces of dolomite, mean", kDomokos},
    {"interior_faces", 15.54, 15.54, "cells of a Poisson-Voronoi diagram, mean", kMeijering},
    {"interior_vertices", 8.0, 8.0, "natural fragments in 3-D, mean", kDomokos},
    {"interior_vertices", 8.93, 8.93, "556 pieces of dolomite, mean", kDomokos},
    {"interior_vertices", 27.07, 27.07, "cells of a Poisson-Voronoi diagram, mean", kMeijering},
    {"corners", 4.0, 4.0, "dried mud, cooled rock, plates: rectangles", kDomokos},
    {"corners", 6.0, 6.0, "cells of a Voronoi diagram in the plane, mean", kDomokos},
    {"contacts", 4.06, 4.06, "142 sherds of 10 pots, mean", kPots},
    {"contacts", 2.9, 4.9, "pots of 7 to 31 sherds, means", kPots},
    {"break_share", 0.09, 0.10, "sherds of pots, median", kPots},
    {"tau", 1.35, 1.35, "egg shells, impact", kWittel},
    {"tau", 1.54, 1.54, "egg shells, explosion", kWittel},
    {"tau", 1.5, 2.0, "plates", kPlates},
    {"tau", 2.5, 2.5, "solids, in terms of counts by size", kPlates},
    {"exponential_p", 0.05, 1.0, "toughened glass: areas are exponential",
     "Dawara and Viswanathan, arXiv:2602.20443"},
    {"hurst", 0.8, 0.8, "brittle cracks", "Bouchaud, J. Phys. Condens. Matter 9:4319 (1997)"},
    {"hurst", 0.4, 0.4, "sintered glass beads, sandstone", "Ponson et al., cond-mat/0608658"},
    {"hurst_front", 0.75, 0.75, "along the front: glass, mortar, wood", kPonson},
    {"hurst_propagation", 0.6, 0.6, "along propagation: glass, mortar, wood", kPonson}};

}  // namespace

std::span<const PublishedFigure> publishedFigures() { return kFigures; }

}  // namespace sherd
