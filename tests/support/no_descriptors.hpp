#pragma once
// While it lives, no file can be opened: too many are open (EMFILE).

#include <sys/resource.h>

namespace grainlaw::testing {

class NoDescriptors {
 public:
  NoDescriptors() {
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
