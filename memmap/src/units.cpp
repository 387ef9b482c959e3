// SPDX-License-Identifier: Apache-2.0
#include <rths/memmap/units.hpp>

#include <locale.h>
#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <udunits2.h>

#include <rths/core/error.hpp>
#include <rths/memmap/codec.hpp>

namespace rths::memmap {
namespace {

// SI units of the quantities of a hybrid test.
constexpr const char* kSiUnits[] = {"m",     "m/s",    "m/s2",  "N",   "N.m", "Pa", "s",    "s2",
                                    "kg",    "N/m",    "N.s/m", "K",   "W",   "V",  "A",    "rad",
                                    "rad/s", "rad/s2", "Hz",    "1",   "m2",  "m3", "m3/s", "kg/m3",
                                    "m/s3",  "N/s",    "Pa/s",  "V/s", "A/s", "T"};

// UDUNITS treats radians as pure numbers; only the spelling distinguishes an angle from a count.
bool is_angle(const std::string& unit) {
  constexpr const char* kAngles[] = {"rad",    "deg",   "arc",   "°",   "rev", "rot", "turn",
                                     "circle", "cycle", "grade", "rpm", "rps", "cps"};
  return std::any_of(std::begin(kAngles), std::end(kAngles),
                     [&](const char* angle) { return unit.find(angle) != std::string::npos; });
}

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
  void operator()(cv_converter* converter) const { cv_free(converter); }
  void operator()(ut_system* system) const { ut_free_system(system); }
};
using UnitHandle = std::unique_ptr<ut_unit, FreeUnit>;

ut_system* unit_system() {
  // Reading the UDUNITS database takes milliseconds, so it is read once per process.
  static const std::unique_ptr<ut_system, FreeUnit> system = [] {
    ut_set_error_message_handler(ut_ignore);
    return std::unique_ptr<ut_system, FreeUnit>{ut_read_xml(nullptr)};
  }();
  if (!system)
    throw Error{"the UDUNITS database cannot be read: check the installation of libudunits2"};
  return system.get();
}

// The parser of UDUNITS has one state for all threads. A fork waits for it, because its child would
// inherit the lock, but not the thread that holds it. Registered before any thread can start: a
// child of a fork during the registration would wait for ever.
constinit std::mutex parser;
[[maybe_unused]] const int kWaitsAtFork =
    pthread_atfork([] { parser.lock(); }, [] { parser.unlock(); }, [] { parser.unlock(); });

// UDUNITS reads numbers, of its database too, as the locale of this thread writes them.
class PlainNumbers {
 public:
  PlainNumbers() : before_{uselocale(plain())} {}
  PlainNumbers(const PlainNumbers&) = delete;
  PlainNumbers& operator=(const PlainNumbers&) = delete;
  ~PlainNumbers() { uselocale(before_); }

 private:
  static locale_t plain() {
    static const locale_t locale = newlocale(LC_ALL_MASK, "C", nullptr);
    return locale;
  }
  locale_t before_;
};

UnitHandle parse(const char* text) { return UnitHandle{ut_parse(unit_system(), text, UT_UTF8)}; }

Unit convert_to_si(const std::string& text) {
  const UnitHandle unit = parse(text.c_str());
  if (!unit) throw Error{fmt::format("unit '{}' does not parse", text)};
  for (const char* si : kSiUnits) {
    const UnitHandle target = parse(si);
    if (!ut_are_convertible(unit.get(), target.get())) continue;
    if (is_angle(si) && !is_angle(text)) continue;
    const std::unique_ptr<cv_converter, FreeUnit> to_si{ut_get_converter(unit.get(), target.get())};
    const double offset = cv_convert_double(to_si.get(), 0.0);
    if (!std::isfinite(offset)) continue;  // UDUNITS also converts to reciprocals: ms to Hz
    return {si, cv_convert_double(to_si.get(), 1.0) - offset, offset};
  }
  throw Error{fmt::format("the quantity of unit '{}' is not supported", text)};
}

}  // namespace

Unit parse_unit(const std::string& text) {
  if (text == "g")
    throw Error{"unit 'g' is ambiguous, expected 'gravity' (acceleration) or 'gram' (mass)"};
  const std::lock_guard lock{parser};
  // A map has many signals of few units, and a run reads its map several times.
  static std::map<std::string, Unit> known;
  const auto found = known.find(text);
  if (found != known.end()) return found->second;
  const PlainNumbers plain;
  return known.emplace(text, convert_to_si(text)).first->second;
}

Codec::Codec(const Signal& signal) : type_{signal.type} {
  const Unit unit = parse_unit(signal.unit);
  scale_ = unit.scale;
  offset_ = unit.offset;
}

}  // namespace rths::memmap
