#pragma once
// Text from outside made fit for one line of a message: control characters become \xNN, length is bounded.

#include <string>
#include <string_view>

namespace grainlaw {

/// At most `limit` bytes (and "..." when cut); control characters, U+0080 to U+009F and what turns the direction of text are escaped.
std::string one_line(std::string_view text, std::size_t limit = 600);

}  // namespace grainlaw
