// experiments/support/help_text.h — help texts wrapped to the width of the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace orthant {

/// Lines longer than `columns` are broken at spaces and go on under the text that they continue: the description where
/// two spaces or more separate it from an option's name, else two columns in. 0 columns: as it is.
std::string wrapped(std::string_view text, std::size_t columns);

/// Of the terminal that standard output is; else what the variable COLUMNS says; 0: neither.
std::size_t terminal_width();

}  // namespace orthant
