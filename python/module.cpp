// The extension module behind `import grainlaw`; grainlaw/_core.pyi says what is in it.

#include "python/errors.hpp"
#include "python/objects.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace grainlaw::python;
  module.doc() = "From frictionless grains to an incremental constitutive law and back.";
  module.attr("__version__") = GRAINLAW_VERSION;
  add_errors(module);
  add_series(module);
  add_law(module);
  add_commands(module);
}
