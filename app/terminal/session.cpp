#include "app/terminal/session.hpp"

#include "model/files/output.hpp"

namespace grainlaw::app {

void print_result(const std::string& text) { write_as_named("-", text); }

}  // namespace grainlaw::app
