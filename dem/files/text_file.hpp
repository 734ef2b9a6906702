#pragma once
// Text that somebody else wrote, line by line: bounded, and whatever is wrong is said with file, line and column.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "model/files/number_text.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {

inline constexpr std::size_t kMaxTextLine = 1'000'000;  ///< longer lines are refused [byte]

class TextFile {
 public:
  /// Throws InvalidInput when there is no such file; `remedy` ends the message: "give ...".
  TextFile(std::filesystem::path file, std::string_view remedy);

  /// Goes to the next line, without its end; false behind the last one. Throws InvalidInput for NUL bytes, too long lines, Error
  /// when the system fails to read it.
  bool next();

  const std::string& line() const { return line_; }  ///< the present one
  std::size_t number() const { return number_; }     ///< its number, from 1
  const std::filesystem::path& file() const { return file_; }

  /// What is wrong with the present line, or with another one, as one line of text; `column` may be empty.
  InvalidInput refusal(std::string_view column, const std::string& why) const { return refusal(number_, column, why); }
  InvalidInput refusal(std::size_t line, std::string_view column, const std::string& why) const;

 private:
  std::filesystem::path file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> in_;
  std::string line_;
  std::size_t number_ = 0;
};

/// Text of a file as it may be shown in a message, in quotes.
std::string in_quotes(std::string_view text);

/// The words between blanks (and commas, if these count); views into `line`.
void split_words(std::string_view line, std::vector<std::string_view>& words, bool commas = false);

}  // namespace grainlaw::dem
