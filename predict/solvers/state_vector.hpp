#pragma once
// SUNDIALS' serial vector with the operations of its steppers in loops that the compiler vectorises: for a dozen numbers
// the library's own cost as much as the law. No header of SUNDIALS in here.

#include <cstddef>

struct _generic_N_Vector;
struct _SUNContext;

namespace grainlaw::predict {

/// A vector of `size` zeros; its clones have the same operations. The caller destroys it. Throws Error without memory.
_generic_N_Vector* new_state_vector(std::size_t size, _SUNContext* context);

}  // namespace grainlaw::predict
