// experiments/support/printable.h — printable text: input quoted in messages, as one line of UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace orthant {

/// One line of UTF-8: control characters become blanks, bytes that are no UTF-8 are written as \xNN.
std::string printable(std::string_view text);

}  // namespace orthant
