// SPDX-License-Identifier: Apache-2.0
//
// Compares names, values, prototypes and layouts with the reference tables, in C and in C++.
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <set>
#include <string>
#include <type_traits>

#include <gtest/gtest.h>

#define _WINNT 1
#include <scgtapi.h>
#include <scrplus.h>

extern "C" {
struct name_check {
  const char* name;
  unsigned long found, expected;
};
unsigned plus_names_in_c(name_check* checks, unsigned capacity);
unsigned gt_names_in_c(name_check* checks, unsigned capacity);
unsigned old_gt_names_in_c(name_check* checks, unsigned capacity);
}

namespace {

constexpr unsigned kCapacity = 600;

// Checks all names of a table and returns the number of different names.
std::size_t count_right(unsigned (*table)(name_check*, unsigned)) {
  std::array<name_check, kCapacity> checks{};
  const unsigned count = table(checks.data(), kCapacity);
  EXPECT_LE(count, kCapacity);
  std::set<std::string> names;
  for (unsigned i = 0; i < count && i < kCapacity; ++i) {
    EXPECT_EQ(checks[i].found, checks[i].expected) << checks[i].name;
    names.insert(checks[i].name);
  }
  return names.size();
}

TEST(VendorNames, AreThoseOfThePlusTablesInC) {
  const std::size_t names = count_right(plus_names_in_c);

  std::printf("SCRAMNet+: %zu names checked in C\n", names);
  EXPECT_GT(names, 300U);
}

TEST(VendorNames, AreThoseOfTheGtTablesInCWithAndWithoutConst) {
  const std::size_t names = count_right(gt_names_in_c);

  std::printf("SCRAMNet GT: %zu names checked in C, twice\n", names);
  EXPECT_EQ(count_right(old_gt_names_in_c), names);
  EXPECT_GT(names, 80U);
}

// In C++ the compiler checks almost everything.
#define CONSTED const
#define CONSTANT(name, value)                                 \
  static_assert(static_cast<unsigned long>(name) == (value)); \
  ++names;
#define TEXT(name, value)      \
  EXPECT_STREQ((name), value); \
  ++names;
#define FUNCTION(result, name, arguments)                              \
  static_assert(std::is_same_v<decltype(&name), result(*) arguments>); \
  ++names;
#define NAME(name)                                                           \
  static_assert(std::is_function_v<std::remove_pointer_t<decltype(&name)>>); \
  ++names;
#define GLOBAL(type, name)                                                  \
  static_assert(std::is_same_v<decltype(&name), std::add_pointer_t<type>>); \
  ++names;
#define SIZE(type, bytes)                 \
  static_assert(sizeof(type) == (bytes)); \
  ++names;
#define POINTER(type, width)                                      \
  static_assert(sizeof(std::remove_pointer_t<type>) == (width));  \
  static_assert(std::is_volatile_v<std::remove_pointer_t<type>>); \
  ++names;
#define FIELD(type, field, at, bytes)                                                            \
  static_assert(offsetof(type, field) == (at) && sizeof(std::declval<type>().field) == (bytes)); \
  ++names;

TEST(VendorNames, AreThoseOfThePlusTablesInCpp) {
  std::size_t names = 0;
#include "plus_names.inc"
  std::printf("SCRAMNet+: %zu names checked in C++\n", names);
  EXPECT_GT(names, 300U);
}

TEST(VendorNames, AreThoseOfTheGtTablesInCpp) {
  std::size_t names = 0;
#include "gt_names.inc"
  std::printf("SCRAMNet GT: %zu names checked in C++\n", names);
  EXPECT_GT(names, 80U);
}

}  // namespace
