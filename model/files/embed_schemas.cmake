# Writes OUTPUT, a header with every FOLDER/*.schema.json as text. Runs at build time.
file(GLOB files ${FOLDER}/*.schema.json)
set(entries "")
foreach(file IN LISTS files)
  get_filename_component(name ${file} NAME)
  file(READ ${file} text)
  string(APPEND entries "    {\"${name}\", R\"schema(${text})schema\"},\n")
endforeach()
list(LENGTH files count)
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT [[
#pragma once
// Generated at build time by model/files/embed_schemas.cmake from docs/schemas.
#include <array>
#include <string_view>
#include <utility>

namespace grainlaw::schemas {

inline constexpr std::array<std::pair<std::string_view, const char*>, @count@> kFiles{{
@entries@}};

}  // namespace grainlaw::schemas
]])
