# Writes OUTPUT, a header with the files FOLDER/PATTERN (several, separated by commas) as texts by name:
# grainlaw::NAMESPACE::kFiles. Runs at build time.
string(REPLACE "," ";" patterns "${PATTERN}")
list(TRANSFORM patterns PREPEND "${FOLDER}/")
file(GLOB files RELATIVE ${FOLDER} ${patterns})
set(entries "")
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} text)
  string(APPEND entries "    {\"${file}\", R\"text(${text})text\"},\n")
endforeach()
list(LENGTH files count)
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT [[
#pragma once
// Generated at build time by cmake/embed_texts.cmake.
#include <array>
#include <string_view>
#include <utility>

namespace grainlaw::@NAMESPACE@ {

inline constexpr std::array<std::pair<std::string_view, const char*>, @count@> kFiles{{
@entries@}};

}  // namespace grainlaw::@NAMESPACE@
]])
