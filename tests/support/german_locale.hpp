#pragma once
// A program whose numbers are written 1.234,5, as under LC_ALL=de_DE (hard case F12).

#include <fmt/format.h>

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <locale>
#include <string>

namespace grainlaw::testing {

struct GermanNumbers : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// German numbers in C++ streams, and in the C library where the locale can be made.
class GermanLocale {
 public:
  explicit GermanLocale(const std::filesystem::path& folder)
      : earlier_(std::locale::global(std::locale(std::locale::classic(), new GermanNumbers))) {
    const std::string make =
        fmt::format("localedef -i de_DE -f UTF-8 '{}/de_DE.UTF-8' >/dev/null 2>&1", folder.string());
    if (std::system(make.c_str()) == 0) setenv("LOCPATH", folder.c_str(), 1);
    in_c_ = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
  }
  ~GermanLocale() {
    std::setlocale(LC_ALL, "C");
    unsetenv("LOCPATH");
    std::locale::global(earlier_);
  }
  GermanLocale(const GermanLocale&) = delete;
  GermanLocale& operator=(const GermanLocale&) = delete;

  bool in_c() const { return in_c_; }

 private:
  std::locale earlier_;
  bool in_c_ = false;
};

}  // namespace grainlaw::testing
