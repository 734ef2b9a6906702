#pragma once
// The context that every object of SUNDIALS belongs to; one per integrator, so that threads share none.

#include "predict/solvers/sundials_handle.hpp"

struct _SUNContext;  // the library's: what SUNContext points to

namespace grainlaw::predict {

void free_context(_SUNContext* context);
using OwnedContext = Owned<_SUNContext*, free_context>;

/// Throws Error when the library had no memory for it.
OwnedContext new_context();

}  // namespace grainlaw::predict
