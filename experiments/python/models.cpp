// Models in URDF and MJCF as scene files.
#include "experiments/python/module.h"

#include <orthant/core/mechanics/models/import.h>

#include <pybind11/stl.h>

namespace orthant::python {

void add_models(pybind11::module_& m) {
  m.def("_import_model", [](const std::string& text, const std::string& file, const std::vector<std::string>& sets) {
    const ImportedModel model = import_model(text, file, sets);
    return pybind11::make_tuple(model.toml, model.notes);
  });
}

}  // namespace orthant::python
