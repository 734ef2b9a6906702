# Writes OUTPUT, a header with VERSION, git revision of SOURCE_DIR, COMPILER, BUILD_TYPE and FLAGS.
# Runs at build time; the file is touched only when its content changes.
set(REVISION "unknown")
find_program(GIT git)
if(GIT AND EXISTS "${SOURCE_DIR}/.git")
  execute_process(
    COMMAND "${GIT}" -C "${SOURCE_DIR}" describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE
    ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(REVISION "${described}")
  endif()
endif()

foreach(name IN ITEMS VERSION REVISION COMPILER BUILD_TYPE FLAGS)
  string(REPLACE "\\" "\\\\" ${name} "${${name}}")
  string(REPLACE "\"" "\\\"" ${name} "${${name}}")
endforeach()
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT [[
#pragma once
// Generated at build time by model/files/build_info.cmake.
#include <string_view>

namespace grainlaw::build_info {

inline constexpr std::string_view version = "@VERSION@";
inline constexpr std::string_view git_revision = "@REVISION@";  // "-dirty": uncommitted changes
inline constexpr std::string_view compiler = "@COMPILER@";
inline constexpr std::string_view build_type = "@BUILD_TYPE@";
inline constexpr std::string_view compile_flags = "@FLAGS@";

}  // namespace grainlaw::build_info
]])
