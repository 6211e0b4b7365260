// experiments/python/pickle.h — plain values go to other processes: pickle, copy, Dask.
#pragma once

#include <pybind11/pybind11.h>

#include <type_traits>

namespace orthant::python {

/// A struct by its members, in the order given.
template <class T, auto... Member> auto by_members() {
  namespace py = pybind11;
  return py::pickle([](const T& x) { return py::make_tuple((x.*Member)...); },
                    [](const py::tuple& state) {
                      if (state.size() != sizeof...(Member)) throw py::value_error("pickle: is of another version");
                      T x;
                      std::size_t i = 0;
                      ((x.*Member = state[i++].cast<std::remove_reference_t<decltype(x.*Member)>>()), ...);
                      return x;
                    });
}

}  // namespace orthant::python
