#include <new>

#include "app/cli.hpp"

/// valijson takes memory by this one and writes there without a look; what is thrown here ends in end_at_once() (app/cli.cpp).
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return ::operator new(size); }

int main(int argc, char** argv) { return grainlaw::app::run(argc, argv); }
