#include "app/cli.hpp"

int main(int argc, char** argv) { return grainlaw::app::run(argc, argv); }
