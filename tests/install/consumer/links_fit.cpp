// Calls the calibration without data: it must refuse, which shows that library and exceptions came along.
#include <cstdio>

#include "fit/calibrate.hpp"
#include "model/vocabulary/error.hpp"

int main() {
  try {
    grainlaw::fit::calibrate({}, {}, {});
  } catch (const grainlaw::InvalidInput& refusal) {
    std::printf("refused: %s\n", refusal.what());
    return 0;
  }
  return 1;
}
