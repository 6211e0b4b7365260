// core/support/toml_nesting.h — nesting limit of TOML text.
#pragma once

#include <string>
#include <string_view>

namespace orthant {

/// toml++ walks nested tables by recursion, as deep as the text says; so depth is bounded before it sees the text.
/// Throws std::invalid_argument with `name` and the line where brackets or dotted keys are deeper than any file of
/// ours.
void refuse_deep(std::string_view text, const std::string& name);

}  // namespace orthant
