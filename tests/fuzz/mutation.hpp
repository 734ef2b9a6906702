#pragma once
// Changes of a file that leave it such a file most of the time, so that what stands behind the syntax is reached.

#include <functional>
#include <random>
#include <string>

#include "tests/fuzz/readers.hpp"

namespace grainlaw::fuzz {

using Chance = std::minstd_rand;

/// Changes some bytes of a text, whatever it means.
using ByteMutation = std::function<void(std::string& text)>;

/// Three in four times a change of values and structure, else of bytes alone.
std::string mutated(const std::string& text, Shape shape, Chance& chance, const ByteMutation& bytes);

/// Of a program without a fuzzer's library: flips, inserts, removes, repeats.
void mutate_bytes(std::string& text, Chance& chance);

}  // namespace grainlaw::fuzz
