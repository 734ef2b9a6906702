#pragma once
// While it lives, no file can be opened: too many are open (EMFILE).

#include <sys/resource.h>

#include "model/vocabulary/error.hpp"

namespace grainlaw::testing {

class NoDescriptors {
 public:
  NoDescriptors() {
    try {  // UBSan looks through a pipe what an exception is, at the first of a type; clang's asks for what() apart
      throw Error("");
    } catch (const Error& error) {
      static_cast<void>(error.what());
    }
    getrlimit(RLIMIT_NOFILE, &earlier_);
    const rlimit none{0, earlier_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &earlier_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit earlier_{};
};

}  // namespace grainlaw::testing
