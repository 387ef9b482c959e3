// SPDX-License-Identifier: Apache-2.0
//
// Loaded before a program (LD_PRELOAD), it gives the program a locale with a decimal comma, as a
// host of the libraries may have.
#include <unistd.h>

#include <clocale>
#include <cstdio>
#include <locale>
#include <stdexcept>

namespace {

constexpr const char* kLocale = "de_DE.UTF-8";
constexpr int kSkipped = 77;  // of ctest

const bool kHasComma = [] {
  try {
    std::locale::global(std::locale{kLocale});  // also that of C
    std::setlocale(LC_MESSAGES, "C");           // tests expect the system's messages in English
    return true;
  } catch (const std::runtime_error&) {
    std::puts("SKIPPED: there is no locale de_DE.UTF-8");
    std::fflush(stdout);
    _exit(kSkipped);
  }
}();

}  // namespace
