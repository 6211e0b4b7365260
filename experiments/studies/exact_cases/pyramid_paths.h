// experiments/studies/exact_cases/pyramid_paths.h — paths that friction pyramids bend: a table against the disc's.
#pragma once

#include <string>

namespace orthant {

/// Markdown, a line for the disc and for pyramids of 4, 8 and 16 facets: a block sent across a slope
/// (core/scenes/cross_slope.h), turned by 0° … 45° against the facets, by moreau-jean; how far from the disc's place it
/// stops, at the most, and by what angle its way there is off; next to each the pyramid's exact value.
std::string pyramid_paths();

}  // namespace orthant
