#include "predict/solvers/sundials_context.hpp"

#include <sundials/sundials_context.h>

namespace grainlaw::predict {

void free_context(SUNContext context) { SUNContext_Free(&context); }

OwnedContext new_context() {
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  return OwnedContext{created(context, "a context")};
}

}  // namespace grainlaw::predict
