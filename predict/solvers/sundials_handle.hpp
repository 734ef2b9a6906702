#pragma once
// Ownership of what the C library SUNDIALS creates, without a header of it.

#include <fmt/format.h>

#include <memory>
#include <type_traits>

#include "model/vocabulary/error.hpp"

namespace grainlaw::predict {

/// Calls `Free`, which takes the pointer.
template <auto Free>
struct Release {
  template <class Pointer>
  void operator()(Pointer pointer) const {
    Free(pointer);
  }
};

/// Owner of a SUNDIALS pointer type (SUNContext, N_Vector, void*).
template <class Pointer, auto Free>
using Owned = std::unique_ptr<std::remove_pointer_t<Pointer>, Release<Free>>;

/// Throws Error when the library had no memory for `what`.
template <class Pointer>
Pointer created(Pointer pointer, const char* what) {
  if (!pointer) throw Error(fmt::format("SUNDIALS: {} could not be created; is memory exhausted?", what));
  return pointer;
}

}  // namespace grainlaw::predict
