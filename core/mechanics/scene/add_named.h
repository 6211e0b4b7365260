// core/mechanics/scene/add_named.h — names of a scene's elements: an element without a name gets its kind and number.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace orthant {

/// Appends the element, which may be a variant. Without a name it becomes body1, body2, …, by `kind`.
template <class T> void add_named(std::vector<T>& list, T element, const char* kind) {
  const auto fill = [&](auto& x) {
    if (x.name.empty()) x.name = kind + std::to_string(list.size() + 1);
  };
  if constexpr (requires { element.index(); })
    std::visit(fill, element);
  else
    fill(element);
  list.push_back(std::move(element));
}

}  // namespace orthant
